"""Training from Python is training on the command line."""

import pytest

from overcooked_bench.baselines.training import train
from overcooked_bench.errors import WrongUse
from tests.baselines.tiny import SETTINGS


def test_train_trains_as_the_command_does(tmp_path, whole_run):
    _, by_command = whole_run
    outcome, summary = train("self-play", folder=tmp_path / "run", **SETTINGS)
    assert outcome.files.weights.read_bytes() == by_command.files.weights.read_bytes()
    assert (summary.method, summary.configuration, summary.steps) == ("self-play", "fast", SETTINGS["steps"])
    again, _ = train("self-play", folder=tmp_path / "run", resume=True, **SETTINGS)
    assert again.returns.tolist() == outcome.returns.tolist()


def test_a_setting_that_is_unknown_is_named(tmp_path):
    with pytest.raises(WrongUse, match="stepps"):
        train("self-play", folder=tmp_path / "run", layout="cramped_room", stepps=3)

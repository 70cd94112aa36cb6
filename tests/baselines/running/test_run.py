import json
from pathlib import Path

import pytest
import torch

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.running import run as run_module
from overcooked_bench.baselines.running.parts import checkpoints
from overcooked_bench.baselines.running.place import CheckpointError, Place, write_record
from overcooked_bench.baselines.running.run import RESTARTS, RESULT
from overcooked_bench.baselines.running.seeds import part_of, restarted
from overcooked_bench.baselines.self_play import train
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.baselines.running.test_checkpoint import press_ctrl_c
from tests.baselines.tiny import SEED, STEPS, UPDATE, tiny

HOPELESS = {"check_share": 0.5, "check_soups": 30.0, "restarts": 2}


@pytest.fixture(scope="module")
def given_up(tmp_path_factory):
    """A run that the divergence check gives up until no restart is left."""
    folder = tmp_path_factory.mktemp("given-up")
    return folder, train(tiny(**HOPELESS), Place(folder, SEED))


def test_a_run_that_does_not_deliver_begins_anew_with_a_derived_seed(given_up):
    folder, outcome = given_up
    assert outcome.restarts == 2
    assert outcome.steps == STEPS  # the last attempt goes on whatever the check says
    attempts = json.loads((folder / RESTARTS).read_text())
    assert [attempt["seed"] for attempt in attempts] == [SEED, restarted(SEED, 1)]
    assert all(STEPS / 2 <= attempt["joint_steps"] < STEPS / 2 + UPDATE for attempt in attempts)
    assert all(0 <= attempt["soups"] < 30 for attempt in attempts)
    assert len({SEED, restarted(SEED, 1), restarted(SEED, 2), part_of(SEED, "1")}) == 4
    assert json.loads((folder / "config.json").read_text())["training_seed"] == SEED


def test_the_last_attempt_is_a_run_of_its_seed(given_up, tmp_path):
    plain = train(tiny(), Place(tmp_path, restarted(SEED, 2)))
    assert plain.files.weights.read_bytes() == given_up[1].files.weights.read_bytes()


def test_an_interrupted_run_counts_its_restarts_and_comes_to_the_same_end(given_up, tmp_path, monkeypatch):
    outcome, goes = None, 0
    while outcome is None:
        with monkeypatch.context() as patch:
            press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 20)
            outcome = train(tiny(**HOPELESS), Place(tmp_path, SEED, resume=goes > 0))
        goes += 1
    assert goes > 2
    assert outcome.restarts == 2
    assert outcome.files.weights.read_bytes() == given_up[1].files.weights.read_bytes()


def test_a_run_that_delivers_enough_is_left_alone(tmp_path):
    outcome = train(tiny(check_share=0.5, check_soups=0.0), Place(tmp_path, SEED))
    assert outcome.restarts == 0
    assert not (tmp_path / RESTARTS).exists()


def test_policies_saved_on_the_way(tmp_path, whole_run):
    shares = (0.0, 0.4, 0.9)
    outcome = train(tiny(snapshots=shares), Place(tmp_path, SEED))
    assert tuple(outcome.snapshots) == shares
    hashes = [load_policy(files.weights).sha256 for files, _ in outcome.snapshots.values()]
    assert len({*hashes, load_policy(outcome.files.weights).sha256}) == 3  # no rollout begins after the last share
    assert outcome.files.weights.read_bytes() == whole_run[1].files.weights.read_bytes()
    assert checkpoints(outcome, tiny()).half() in shares[1:]


def test_a_finished_run_is_not_trained_again(tmp_path, monkeypatch):
    outcome = train(tiny(), Place(tmp_path, SEED))
    monkeypatch.setattr("overcooked_bench.baselines.learning.learner.Learner.learn", lambda *_: pytest.fail("trained"))
    again = train(tiny(), Place(tmp_path, SEED, resume=True))
    assert again.files == outcome.files
    assert again.returns.tolist() == outcome.returns.tolist()
    assert (again.steps, again.restarts) == (outcome.steps, 0)


def soups_by_episode(monkeypatch, soups):
    """Lets every kitchen report these soups, one number an episode, and nothing afterwards."""
    left, finish = list(soups), OvercookedVecEnv._finish

    def told(env, dones):
        points = 20.0 * (left.pop(0) if left else 0)
        return [{**info, "episode_soup_reward": points} for info in finish(env, dones)]

    monkeypatch.setattr(OvercookedVecEnv, "_finish", told)


@pytest.mark.parametrize("stopped_in", [3, 4])
def test_the_check_of_a_run_that_goes_on_is_that_of_an_uninterrupted_one(stopped_in, tmp_path, monkeypatch):
    episode = UPDATE // 4
    config = tiny(steps=6 * UPDATE, horizon=episode, check_share=0.5, check_soups=3.0)
    soups_by_episode(monkeypatch, [5, 5, 0])  # 3.3 on average at the check, and less ever after
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", (stopped_in - 1) * episode + 5)
        assert train(config, Place(tmp_path, SEED)) is None
    assert train(config, Place(tmp_path, SEED, resume=True)).restarts == 0


class Killed(Exception):
    """What a test raises where a process would be killed."""


@pytest.mark.parametrize("at", [0, 2, 3, 4, 5, 6, 7])
def test_a_run_killed_while_it_begins_anew_comes_to_the_same_end(at, given_up, tmp_path, monkeypatch):
    config = tiny(**HOPELESS, snapshots=(0.1,))
    left, unlink = at, Path.unlink

    def count():
        nonlocal left
        if left == 0:
            raise Killed
        left -= 1

    def counted_unlink(path, missing_ok=False):
        if path.parent in (tmp_path, tmp_path / "snapshots"):
            count()
        unlink(path, missing_ok)

    def counted_write(file, content):
        if file.name == RESTARTS:
            count()
        write_record(file, content)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "unlink", counted_unlink)
        patch.setattr(run_module, "write_record", counted_write)
        with pytest.raises(Killed):
            train(config, Place(tmp_path, SEED, every=UPDATE))
    outcome = train(config, Place(tmp_path, SEED, resume=True))
    assert outcome.restarts == 2
    assert outcome.files.weights.read_bytes() == given_up[1].files.weights.read_bytes()
    untouched = train(tiny(snapshots=(0.1,)), Place(tmp_path / "plain", restarted(SEED, 2)))
    assert (
        load_policy(outcome.snapshots[0.1].files.weights).sha256
        == load_policy(untouched.snapshots[0.1].files.weights).sha256
    )


def test_another_configuration_is_refused_before_the_first_checkpoint_too(tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 3, 4)
        with pytest.raises(KeyboardInterrupt):
            train(tiny(), Place(tmp_path, SEED))
    assert not (tmp_path / "checkpoint.pt").exists()
    with pytest.raises(CheckpointError, match="epochs was 2, is 3"):
        train(tiny(epochs=3), Place(tmp_path, SEED, resume=True))
    assert json.loads((tmp_path / "config.json").read_text())["epochs"] == 2


def test_the_time_of_a_run_is_that_of_all_its_legs(tmp_path, monkeypatch):
    seconds = 0.0

    def clock():
        nonlocal seconds
        seconds += 1
        return seconds

    monkeypatch.setattr("overcooked_bench.baselines.running.monitor.time.monotonic", clock)
    legs = []
    for leg in range(2):
        with monkeypatch.context() as patch:
            press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 5)
            assert train(tiny(), Place(tmp_path, SEED, resume=leg > 0)) is None
        content = json.loads(torch.load(tmp_path / "checkpoint.pt", weights_only=True)["plain"])
        legs.append(content["memory"]["seconds"])
    outcome = train(tiny(), Place(tmp_path, SEED, resume=True))
    assert 0 < legs[0] < legs[1] < outcome.seconds == json.loads((tmp_path / RESULT).read_text())["seconds"]


def test_a_finished_run_leaves_as_many_threads_as_it_was_trained_on(tmp_path):
    """What is measured next has the same rounding as in a run that was not interrupted."""
    train(tiny(), Place(tmp_path, SEED))
    torch.set_num_threads(2)
    train(tiny(), Place(tmp_path, SEED, resume=True))
    assert torch.get_num_threads() == 1


@pytest.fixture
def finished(tmp_path):
    """The folder of a finished run with snapshots."""
    train(tiny(snapshots=(0.0, 0.4)), Place(tmp_path, SEED))
    return tmp_path


@pytest.mark.parametrize(
    ("file", "content", "message"),
    [
        (
            "config.json",
            "[1]",
            r"config\.json: Expected `object`, got `array`; restore the file, or choose another --output",
        ),
        ("config.json", "{", r"config\.json:1: not JSON"),
        ("policy.safetensors", "", r"policy.*had saved this policy"),
        ("policy.json", "{}", r"policy.*had saved this policy"),
        ("snapshots/at-0.4.safetensors", None, r"at-0\.4.*had saved this policy"),
        ("snapshots/at-0.json", None, r"at-0.*had saved this policy"),
    ],
)
def test_a_finished_run_that_was_damaged_is_noticed(file, content, message, finished):
    if content is None:
        (finished / file).unlink()
    else:
        (finished / file).write_text(content)
    with pytest.raises(CheckpointError, match=message):
        train(tiny(snapshots=(0.0, 0.4)), Place(finished, SEED, resume=True))


@pytest.mark.parametrize("content", ["3", "[3]", '[{"seed": 1}]', "[" * 2000 + "]" * 2000])
def test_damaged_restarts_are_one_message(content, tmp_path, monkeypatch):
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 20)
        assert train(tiny(), Place(tmp_path, SEED)) is None
    (tmp_path / RESTARTS).write_text(content)
    with pytest.raises(CheckpointError, match=r"restarts\.json.*choose another --output"):
        train(tiny(), Place(tmp_path, SEED, resume=True))


def test_a_run_that_goes_on_misses_a_snapshot_that_it_had_saved(tmp_path, monkeypatch):
    config = tiny(snapshots=(0.0,))
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 20)
        assert train(config, Place(tmp_path, SEED)) is None
    (tmp_path / "snapshots" / "at-0.safetensors").unlink()
    with pytest.raises(CheckpointError, match="had saved this policy"):
        train(config, Place(tmp_path, SEED, resume=True))


def test_a_snapshot_knows_the_steps_that_it_has_had(finished):
    again = train(tiny(snapshots=(0.0, 0.4)), Place(finished, SEED, resume=True))
    assert {share: one.steps for share, one in again.snapshots.items()} == {0.0: 0, 0.4: 2 * UPDATE}

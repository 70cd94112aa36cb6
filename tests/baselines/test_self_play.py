import json
import re

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from stable_baselines3.common.callbacks import BaseCallback

from overcooked_bench import load_agent, play_episodes
from overcooked_bench.baselines.running.place import Place
from overcooked_bench.baselines.running.seeds import USER, derive_seed
from overcooked_bench.baselines.self_play import Config, train
from overcooked_bench.cli import main as command
from tests.baselines.tiny import SEED, SETTINGS, STEPS, UPDATE, learned, same, self_play, tiny, tiny_learner

GRID = """
XXPXX
O   O
X   X
XDXSX
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run by the command line, and what it said."""
    folder = tmp_path_factory.mktemp("run") / "deep" / "folder"
    with pytest.MonkeyPatch.context() as patch:
        said = []
        patch.setattr("builtins.print", lambda *words, **_: said.append(" ".join(map(str, words))))
        assert command(self_play("--output", str(folder))) == 0
    return folder, said


def test_a_run_leaves_its_configuration_checkpoint_logs_and_policy(run):
    folder, _ = run
    assert sorted(path.name for path in folder.iterdir()) == [
        *("checkpoint.pt", "config.json", "logs", "policy.json", "policy.safetensors", "result.json", "summary.json")
    ]
    config = json.loads((folder / "config.json").read_text())
    seed = derive_seed(USER, "cramped_room", "self-play", 0)
    assert config["training_seed"] == seed
    assert config["method"] == "self-play"
    assert config["seed"] == 0
    assert config | json.loads(json.dumps(SETTINGS)) == config
    assert config.keys() == {*Config.__dataclass_fields__, "method", "training_seed"}
    assert any(path.name.startswith("events.out.tfevents") for path in (folder / "logs").iterdir())
    entries = [json.loads(line) for line in (folder / "logs" / "progress.json").read_text().splitlines()]
    assert [entry["train/joint_steps"] for entry in entries] == [*range(UPDATE, STEPS + 1, UPDATE), STEPS]
    assert "rollout/soup_reward" in entries[-2]
    assert entries[-1]["train/n_updates"] == 2 * STEPS // UPDATE


def test_a_run_says_how_it_went(run):
    folder, said = run
    assert re.fullmatch(rf"cramped_room: {STEPS} of {STEPS} steps  return +[\d.]+  soups .* steps/s  0 s left", said[0])
    assert said[-1].startswith(f"{folder}/policy.safetensors: return with itself ")
    assert f"after {STEPS} joint steps" in said[-1]


def test_the_command_line_trains_as_the_function_does(run, whole_run):
    assert same(learned(run[0] / "checkpoint.pt"), learned(whole_run[0] / "checkpoint.pt"))


@pytest.mark.parametrize("mode", ["sample", "greedy"])
def test_the_policy_is_an_agent(run, mode):
    path = run[0] / "policy.safetensors"
    agents = tuple(load_agent(path, "cramped_room", mode=mode) for _ in range(2))
    games = play_episodes("cramped_room", agents=agents, episodes=3, horizon=20)
    assert games.soup_reward.shape == (3,)
    assert json.loads((run[0] / "policy.json").read_text())["layout"] == "cramped_room"


def test_a_custom_kitchen_is_trained_in(tmp_path, capsys):
    grid = tmp_path / "mine.layout"
    grid.write_text(GRID.strip())
    output = tmp_path / "run"
    assert command([*self_play(), "--layout", str(grid), "--cooking", "manual", "--output", str(output)]) == 0
    architecture = json.loads((output / "policy.json").read_text())
    assert architecture["layout"] == GRID.strip()
    assert architecture["cooking"] == "manual"
    load_agent(output / "policy.safetensors", GRID.strip())
    assert "custom" not in capsys.readouterr().err


def test_a_folder_that_holds_a_run_is_not_overwritten(run, capsys):
    before = (run[0] / "checkpoint.pt").read_bytes()
    assert command(self_play("--output", str(run[0]))) == 2
    assert "go on with it by --resume" in capsys.readouterr().err
    assert (run[0] / "checkpoint.pt").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--layout", "cramped_rom"], "did you mean 'cramped_room'"),
        (["--resume"], "start without --resume"),
        (["--layout", "no\ngrid"], "row 1"),
        (["--layout", "XXPXX\nO   O\nX   X\nXDXSX", "--start", "standard"], "names no start cells"),
        (["--layout", "XXPXX\nT1 2O\nX   X\nXDXSX"], "use 'lossless26'"),
    ],
)
def test_a_mistake_is_answered_without_a_traceback(arguments, told, tmp_path, capsys):
    assert command([*self_play("--output", str(tmp_path / "out")), *arguments]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--steps", "100"], "at least two updates, 128 joint steps"),
        (["--minibatches", "3"], "divisor of the 128 steps"),
        (["--minibatches", "128"], "divisor of the 128 steps"),
        (["--minibatches", "0"], "minibatches=0; give a number from 1"),
        (["--num-kitchens", "-1"], "num_kitchens=-1; give a number from 1"),
        (["--hidden", "0"], "hidden=(0,); give the width"),
        (["--observation", "feature"], "no observation named 'feature'"),
        (["--kitchens", "4"], "--num-kitchens"),
    ],
)
def test_wrong_settings_are_answered_with_the_right_ones(arguments, told, capsys):
    assert command([*self_play(), *arguments]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.startswith("overcooked-bench: ")


def test_progress_is_a_bar_on_a_terminal_and_lines_elsewhere(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("TTY_COMPATIBLE", "1")
    monkeypatch.setenv("COLUMNS", "200")
    train(tiny(), Place(tmp_path, SEED))
    said = capsys.readouterr()
    assert said.out == ""
    assert "cramped_room" in said.err
    assert "steps/s" in said.err
    assert said.err.endswith("\x1b[?25h")  # the cursor is shown again


class Watch(BaseCallback):
    """Keeps what every step gave and what a rollout made of it."""

    def __init__(self):
        super().__init__()
        self.rewards, self.infos, self.kept = [], [], None

    def _on_step(self):
        self.rewards.append(self.locals["rewards"].copy())
        self.infos.append(self.locals["infos"])
        return True

    def _on_rollout_end(self):
        self.kept = self.model.rollout_buffer.rewards.copy()


def test_an_episode_cut_off_by_the_horizon_goes_on_in_the_value_of_its_last_state():
    model = tiny_learner(tiny(horizon=9), SEED)
    with torch.no_grad():
        model.policy.value_net.bias.fill_(5.0)
    watch = Watch()
    watch.model = model
    model._setup_learn(1, watch)
    model.env.set_shaping(1.0)
    watch.rewards.clear()
    model.collect_rollouts(model.env, watch, model.rollout_buffer, model.n_steps)
    added = watch.kept - np.stack(watch.rewards)
    ends = [step for step, infos in enumerate(watch.infos) if infos[0]]
    assert ends == [8]
    last = np.stack([info["terminal_observation"] for info in watch.infos[8]])
    with torch.no_grad():
        values = model.policy.predict_values(torch.from_numpy(last)).numpy()[:, 0]
    assert np.delete(added, 8, 0).any() == np.False_
    np.testing.assert_allclose(added[8], 0.99 * values, rtol=1e-5)
    assert (values > 3).all()


def test_the_schedules_end_with_the_run_though_the_last_rollout_ends_later(tmp_path):
    steps = 2 * UPDATE + 10
    outcome = train(tiny(steps=steps), Place(tmp_path, SEED))
    assert outcome.steps == 3 * UPDATE
    entries = [json.loads(line) for line in (tmp_path / "logs" / "progress.json").read_text().splitlines()]
    rates = [entry["train/learning_rate"] for entry in entries if "train/learning_rate" in entry]
    assert rates == pytest.approx([2e-3 * (1 - UPDATE / steps), 2e-3 * (1 - 2 * UPDATE / steps), 0.0])


def test_shaping_and_entropy_fall_linearly(tmp_path, monkeypatch):
    shaping, entropy = [], []
    monkeypatch.setattr(
        "overcooked_bench.envs.sb3.OvercookedVecEnv.set_shaping",
        lambda env, weight: shaping.append(weight),
    )
    monkeypatch.setattr(
        "overcooked_bench.baselines.learning.learner.Learner.train", lambda model: entropy.append(model.ent_coef)
    )
    train(tiny(shaping_share=0.5, entropy_start=0.5, entropy_end=0.25), Place(tmp_path, SEED))
    assert shaping == pytest.approx([1, 0.6, 0.2, 0, 0])
    assert entropy == pytest.approx([0.5, 0.45, 0.4, 0.35, 0.3])


PINNED = {"action.bias": 0.0163, "action.weight": 0.0783, "trunk.0.bias": 0.0339, "trunk.0.weight": 5.6488}
"""Norms of the weights of the tiny run, as they have been since the first release."""


def test_training_is_what_it_has_always_been(whole_run):
    """Machines and versions of torch round differently; what a run does differently shows in the third digit."""
    weights = load_file(whole_run[1].files.weights)
    assert {name: float(tensor.float().norm()) for name, tensor in weights.items()} == pytest.approx(PINNED, rel=5e-3)

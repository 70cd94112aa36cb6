import json
import os
import pickle
import signal
import subprocess
import sys

import pytest
import torch

from overcooked_bench.baselines.best_response import Config as BestResponse
from overcooked_bench.baselines.learning.algorithms import make_dqn
from overcooked_bench.baselines.learning.learner import Learner
from overcooked_bench.baselines.running.checkpoint import load_checkpoint, save_checkpoint
from overcooked_bench.baselines.running.place import CheckpointError, Place
from overcooked_bench.baselines.running.run import make_env
from overcooked_bench.baselines.self_play import train
from overcooked_bench.cli import main as command
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.baselines.tiny import SEED, SETTINGS, STEPS, UPDATE, learned, same, self_play, tiny, tiny_learner

SIGNAL_AT_STEP = """
import os, signal, sys
from overcooked_bench.cli import main
from overcooked_bench.envs.sb3 import OvercookedVecEnv

play, left = OvercookedVecEnv.step_wait, int(sys.argv[1])

def step_wait(env):
    global left
    left -= 1
    if not left:
        os.kill(os.getpid(), getattr(signal, sys.argv[2]))
    return play(env)

OvercookedVecEnv.step_wait = step_wait
sys.exit(main(sys.argv[3:]))
"""
IN_THE_THIRD_ROLLOUT = 2 * UPDATE // 4 + 8


def run_until(name, folder, *others):
    """Trains in a process of its own, which gets a signal in its third rollout."""
    arguments = self_play("--output", str(folder), *others)
    return subprocess.run(
        [sys.executable, "-c", SIGNAL_AT_STEP, str(IN_THE_THIRD_ROLLOUT), name, *arguments],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def press_ctrl_c(monkeypatch, owner, method, *calls):
    """Sends SIGINT before these calls of a method, counted from 1."""
    count, original = 0, getattr(owner, method)

    def counted(*arguments):
        nonlocal count
        count += 1
        if count in calls:
            signal.raise_signal(signal.SIGINT)
        return original(*arguments)

    monkeypatch.setattr(owner, method, counted)


def finished(folder, whole_run):
    """Whether a run has come to the same end as the one that was never interrupted."""
    whole, _ = whole_run
    files = [(place / "policy.safetensors").read_bytes() for place in (folder, whole)]
    return files[0] == files[1] and same(learned(folder / "checkpoint.pt"), learned(whole / "checkpoint.pt"))


def joint_steps_done(folder):
    return json.loads(torch.load(folder / "checkpoint.pt", weights_only=True)["plain"])["num_timesteps"] // 2


@pytest.mark.slow
def test_a_run_stopped_by_ctrl_c_goes_on_to_the_same_weights(tmp_path, whole_run):
    stopped = run_until("SIGINT", tmp_path)
    assert stopped.returncode == 130, stopped.stderr
    assert "--resume" in stopped.stderr
    assert "Traceback" not in stopped.stderr
    assert f"{3 * UPDATE} of {STEPS} steps" in stopped.stdout
    assert joint_steps_done(tmp_path) == 3 * UPDATE  # the rollout and its update came to an end
    assert not (tmp_path / "policy.safetensors").exists()
    assert command(self_play("--output", str(tmp_path), "--resume")) == 0
    assert finished(tmp_path, whole_run)


@pytest.mark.slow
def test_a_run_that_was_killed_goes_on_from_its_checkpoint_to_the_same_weights(tmp_path, whole_run):
    killed = run_until("SIGKILL", tmp_path, "--checkpoint-every", str(UPDATE))
    assert killed.returncode == -signal.SIGKILL
    assert joint_steps_done(tmp_path) == 2 * UPDATE
    assert train(tiny(), Place(tmp_path, SEED, resume=True))
    assert finished(tmp_path, whole_run)


def test_a_run_stopped_in_every_rollout_comes_to_the_same_weights(tmp_path, whole_run, monkeypatch):
    legs = STEPS // UPDATE
    for leg in range(1, legs + 1):
        with monkeypatch.context() as patch:
            press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 5)
            outcome = train(tiny(), Place(tmp_path, SEED, resume=leg > 1))
        assert joint_steps_done(tmp_path) == leg * UPDATE
        assert outcome is None  # after the last rollout too: what was asked holds
    outcome = train(tiny(), Place(tmp_path, SEED, resume=True))
    assert finished(tmp_path, whole_run)
    assert outcome.returns.tolist() == whole_run[1].returns.tolist()
    logs = [json.loads(line) for leg in range(legs) for line in log(tmp_path, leg * UPDATE).read_text().splitlines()]
    steps = [entry["train/joint_steps"] for entry in logs if "time/fps" in entry]
    assert steps == [leg * UPDATE for leg in range(1, legs + 1)]
    rates = {entry["train/n_updates"]: entry["train/learning_rate"] for entry in logs if "train/n_updates" in entry}
    whole = [json.loads(line) for line in log(whole_run[0], 0).read_text().splitlines()]
    assert rates == {e["train/n_updates"]: e["train/learning_rate"] for e in whole if "train/n_updates" in e}
    assert len(rates) == legs


def log(folder, begun):
    return folder / "logs" / (f"progress-from-{begun}.json" if begun else "progress.json")


def test_ctrl_c_during_an_update_saves_after_it(tmp_path, whole_run, monkeypatch):
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, Learner, "train", 2)
        assert train(tiny(), Place(tmp_path, SEED)) is None
    assert joint_steps_done(tmp_path) == 2 * UPDATE
    assert train(tiny(), Place(tmp_path, SEED, resume=True))
    assert finished(tmp_path, whole_run)


def test_a_second_ctrl_c_stops_at_once(tmp_path, monkeypatch, capsys):
    before = signal.getsignal(signal.SIGINT)
    press_ctrl_c(monkeypatch, OvercookedVecEnv, "step_wait", 18, 20)
    with pytest.raises(KeyboardInterrupt):
        train(tiny(), Place(tmp_path, SEED))
    assert signal.getsignal(signal.SIGINT) is before
    assert "Ctrl-C again stops at once" in capsys.readouterr().err
    assert not (tmp_path / "checkpoint.pt").exists()


def test_ctrl_c_belongs_to_python_again_after_a_run(whole_run):
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_the_same_seed_gives_the_same_weights_and_another_one_others(tmp_path, whole_run):
    train(tiny(), Place(tmp_path / "same", SEED, every=UPDATE))
    assert finished(tmp_path / "same", whole_run)
    train(tiny(), Place(tmp_path / "other", SEED + 1))
    assert not same(learned(tmp_path / "other" / "checkpoint.pt"), learned(whole_run[0] / "checkpoint.pt"))


def test_a_finished_run_resumes_to_itself(tmp_path, whole_run, monkeypatch):
    whole, outcome = whole_run
    for name in ("checkpoint.pt", "policy.safetensors"):
        (tmp_path / name).write_bytes((whole / name).read_bytes())
    again = train(tiny(), Place(tmp_path, SEED, resume=True))
    assert finished(tmp_path, whole_run)
    assert again.steps == outcome.steps == STEPS
    assert again.returns.tolist() == outcome.returns.tolist()


def test_what_is_loaded_is_what_was_saved(tmp_path, whole_run):
    theirs = torch.load(whole_run[0] / "checkpoint.pt", weights_only=True)
    config = json.loads(theirs["plain"])["config"]
    model = tiny_learner(tiny(), 1)
    memory = load_checkpoint(whole_run[0] / "checkpoint.pt", model, config)
    assert len(memory["returns"]) == 8  # two episodes of each kitchen
    save_checkpoint(tmp_path / "folder" / "again.pt", model, config, memory)
    ours = torch.load(tmp_path / "folder" / "again.pt", weights_only=True)
    assert os.listdir(tmp_path / "folder") == ["again.pt"]
    assert json.loads(ours["plain"]) == json.loads(theirs["plain"])
    assert same(ours["policy"], theirs["policy"])
    assert ours["torch_random"].equal(theirs["torch_random"])
    assert ours["arrays"].keys() == theirs["arrays"].keys()
    for name, stored in ours["arrays"].items():
        assert same({"": stored.pop("bytes")}, {"": theirs["arrays"][name].pop("bytes")})
        assert stored == theirs["arrays"][name]


def test_the_first_step_after_a_pause_explores_as_much_as_without_one(tmp_path):
    config = BestResponse(**SETTINGS, algorithm="dqn")
    before, after = (make_dqn(config, make_env(config, partners=["stay"]), SEED) for _ in range(2))
    before.learn(16)
    save_checkpoint(tmp_path / "checkpoint.pt", before, {})
    load_checkpoint(tmp_path / "checkpoint.pt", after, {})
    assert after.exploration_rate == before.exploration_rate > 0


def test_a_save_that_fails_leaves_the_last_checkpoint(tmp_path, whole_run, monkeypatch):
    good = (whole_run[0] / "checkpoint.pt").read_bytes()
    (tmp_path / "checkpoint.pt").write_bytes(good)
    config = json.loads((whole_run[0] / "config.json").read_text())
    model = tiny_learner(tiny(), 1)
    load_checkpoint(tmp_path / "checkpoint.pt", model, config)

    def full(content, file):
        file.write(b"half of")
        raise OSError("no space left on device")

    monkeypatch.setattr(torch, "save", full)
    with pytest.raises(OSError, match="no space left"):
        save_checkpoint(tmp_path / "checkpoint.pt", model, config)
    assert (tmp_path / "checkpoint.pt").read_bytes() == good


@pytest.mark.parametrize(
    ("others", "seed", "told"),
    [
        ({"epochs": 3}, SEED, r"epochs was 2, is 3\); choose another --output"),
        ({"layout": "coordination_ring"}, SEED, "layout was 'cramped_room', is 'coordination_ring'"),
        ({"steps": 2 * STEPS}, SEED, f"steps was {STEPS}, is {2 * STEPS}"),
        ({}, SEED + 1, "training_seed was"),
    ],
)
def test_the_checkpoint_of_another_run_is_refused(others, seed, told, tmp_path, whole_run):
    for name in ("checkpoint.pt", "config.json"):
        (tmp_path / name).write_bytes((whole_run[0] / name).read_bytes())
    with pytest.raises(CheckpointError, match=told):
        train(tiny(**others), Place(tmp_path, seed, resume=True))
    for name in ("checkpoint.pt", "config.json"):
        assert (tmp_path / name).read_bytes() == (whole_run[0] / name).read_bytes()


def test_a_missing_checkpoint_is_told(tmp_path):
    with pytest.raises(CheckpointError, match="start without --resume"):
        train(tiny(), Place(tmp_path / "nothing", SEED, resume=True))
    assert not (tmp_path / "nothing").exists()


class Payload:
    """Makes a folder when it is unpickled."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return os.mkdir, (str(self.folder),)


def edited(change):
    def write(path, good):
        content = torch.load(good, weights_only=True)
        change(content)
        torch.save(content, path)

    return write


DAMAGE = {
    "cut off": lambda path, good: path.write_bytes(good.read_bytes()[:-5000]),
    "empty": lambda path, good: path.write_bytes(b""),
    "text": lambda path, good: path.write_text("not a checkpoint at all"),
    "a folder": lambda path, good: path.mkdir(),
    "a tensor": lambda path, good: torch.save(torch.zeros(3), path),
    "without weights": edited(lambda content: content.pop("policy")),
    "other weights": edited(lambda content: content.update(policy={"a": torch.zeros(1)})),
    "without an array": edited(lambda content: content["arrays"].pop("env.kitchens.rows")),
    "a wrong shape": edited(lambda content: content["arrays"]["env.kitchens.rows"].update(shape=[1, 2])),
    "an array of objects": edited(lambda content: content["arrays"]["last_obs"].update(type="O")),
    "no json": edited(lambda content: content.update(plain="{")),
    "no mapping": edited(lambda content: content.update(plain="[]")),
}


@pytest.mark.parametrize("kind", DAMAGE)
def test_a_damaged_checkpoint_is_refused(kind, tmp_path, whole_run):
    DAMAGE[kind](tmp_path / "checkpoint.pt", whole_run[0] / "checkpoint.pt")
    with pytest.raises(CheckpointError, match=r"checkpoint\.pt: not a checkpoint of this run, or damaged"):
        train(tiny(), Place(tmp_path, SEED, resume=True))
    assert not (tmp_path / "config.json").exists()


def test_a_later_format_is_refused(tmp_path, whole_run):
    write = edited(lambda content: content.update(format=2))
    write(tmp_path / "checkpoint.pt", whole_run[0] / "checkpoint.pt")
    with pytest.raises(CheckpointError, match="format 2; this version reads 1"):
        train(tiny(), Place(tmp_path, SEED, resume=True))


@pytest.mark.parametrize("where", ["plain", "policy", "whole"])
def test_a_checkpoint_that_would_run_code_is_refused(where, tmp_path, whole_run):
    target, path = tmp_path / "made by the payload", tmp_path / "checkpoint.pt"
    if where == "whole":
        path.write_bytes(pickle.dumps(Payload(target), protocol=2))
    else:
        edited(lambda content: content.update({where: Payload(target)}))(path, whole_run[0] / "checkpoint.pt")
    with pytest.raises(CheckpointError, match=r"UnpicklingError"):
        train(tiny(), Place(tmp_path, SEED, resume=True))
    assert not target.exists()

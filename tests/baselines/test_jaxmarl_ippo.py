"""Agents of JaxMARL: conversion and records with a program that only pretends to train; the real one if it is there."""

import os
import stat
import sys

import numpy as np
import pytest

from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.elsewhere import program
from overcooked_bench.baselines.elsewhere.conversion import ConversionError, convert
from overcooked_bench.baselines.elsewhere.program import PYTHON, ProgramFailed
from overcooked_bench.baselines.jaxmarl_ippo import Config, train
from overcooked_bench.baselines.learning.settings import SettingsError
from overcooked_bench.baselines.running.place import CheckpointError, Place
from overcooked_bench.baselines.running.run import UnfitError
from tests.kitchen.observations.test_jaxmarl import RECORDED

PRETENDS = """#!{python}
import json, sys
import numpy as np

_, _, settings, folder = sys.argv
told = json.load(open(settings))
generator = np.random.default_rng(told["seed"])
shapes = [(26 * 20, 8), (8, 8), (8, 6)]
for end in ["", *(f"-{{share}}" for share in told["snapshots"])]:
    arrays = {{f"kernel_{{i}}": generator.normal(size=shape).astype("f4") for i, shape in enumerate(shapes)}}
    arrays |= {{f"bias_{{i}}": np.zeros(shape[1], "f4") for i, shape in enumerate(shapes)}}
    np.savez(f"{{folder}}/policy{{end}}.npz", **arrays)
snapshots = {{str(share): int(share * told["steps"]) for share in told["snapshots"]}}
json.dump({{"steps": told["steps"], "seconds": 1.5, "snapshots": snapshots}}, open(f"{{folder}}/result.json", "w"))
"""


def settings(**others):
    sizes = {"num_kitchens": 4, "rollout": 16, "minibatches": 2, "epochs": 1, "steps": 320, "hidden": (8, 8)}
    return Config(**({"layout": "cramped_room", "horizon": 40, "snapshots": (0.5,)} | sizes | others))


@pytest.fixture
def python(tmp_path, monkeypatch):
    """Makes the text of a script what runs the program."""

    def as_python(text):
        script = tmp_path / "python"
        script.write_text(text)
        script.chmod(script.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv(PYTHON, str(script))

    return as_python


def test_a_run_is_converted_measured_and_not_repeated(python, tmp_path):
    python(PRETENDS.format(python=sys.executable))
    place = Place(tmp_path / "run", 2**32 - 1)
    outcome = train(settings(), place)
    assert (outcome.steps, outcome.seconds, len(outcome.returns)) == (320, 1.5, 100)
    policy, half = load_policy(outcome.files.weights), load_policy(outcome.snapshots[0.5].files.weights)
    assert (policy.architecture.observation, policy.architecture.layout) == ("jaxmarl", "cramped_room")
    assert policy.sha256 != half.sha256
    assert outcome.snapshots[0.5].steps == 160
    python("#!/bin/sh\nexit 1\n")
    again = train(settings(), Place(place.folder, place.seed, resume=True))
    assert (again.files, again.steps, again.snapshots) == (outcome.files, outcome.steps, outcome.snapshots)
    with pytest.raises(CheckpointError, match="horizon was 40, is 41"):
        train(settings(horizon=41), Place(place.folder, place.seed, resume=True))


def test_a_converted_actor_chooses_from_our_view_as_from_jaxmarls(tmp_path):
    generator = np.random.default_rng(0)
    kernels = [generator.normal(0, 0.3, shape).astype(np.float16) for shape in ((650, 9), (9, 7), (7, 6))]
    biases = [generator.normal(0, 0.3, kernel.shape[1]).astype(np.float16) for kernel in kernels]
    arrays = {f"kernel_{i}": kernel for i, kernel in enumerate(kernels)}
    np.savez(tmp_path / "actor.npz", **arrays, **{f"bias_{i}": bias for i, bias in enumerate(biases)})
    config = settings(layout="coordination_ring", hidden=(9, 7), activation="relu")
    policy = load_policy(convert(tmp_path / "actor.npz", tmp_path / "policy", config.architecture).weights)
    with np.load(RECORDED) as recorded:
        seen = recorded["seen"][:, 0]
    values = seen.reshape(len(seen), -1).astype(np.float32)
    for kernel, bias in zip(kernels[:-1], biases[:-1], strict=True):
        values = np.maximum(0, values @ kernel + bias)
    logits = values @ kernels[-1] + biases[-1]
    expected = np.exp(logits) / np.exp(logits).sum(1, keepdims=True)
    found = PolicyStack([policy]).assign(np.zeros(len(seen), int)).probabilities(seen.transpose(0, 3, 1, 2))
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_weights_of_another_network_are_refused(tmp_path):
    for kernel in ({}, {"kernel_0": np.zeros((7, 8), np.float32)}):
        np.savez(tmp_path / "actor.npz", **kernel)
        with pytest.raises(ConversionError, match=r"actor\.npz: no weights of such a network"):
            convert(tmp_path / "actor.npz", tmp_path / "policy", settings().architecture)
    (tmp_path / "actor.npz").write_bytes(b"no archive")
    with pytest.raises(ConversionError, match=r"actor\.npz: no weights of such a network"):
        convert(tmp_path / "actor.npz", tmp_path / "policy", settings().architecture)


def test_a_program_that_fails_says_what_it_printed_and_what_to_install(python, tmp_path, monkeypatch):
    python("#!/bin/sh\necho no module named jaxmarl\nexit 3\n")
    with pytest.raises(ProgramFailed, match=r"(?s)ended with code 3; install uv, or let .*no module named jaxmarl"):
        train(settings(), Place(tmp_path / "run", 0))
    monkeypatch.setenv(PYTHON, str(tmp_path / "nowhere"))
    with pytest.raises(ProgramFailed, match=r"nowhere cannot be started \(No such file"):
        train(settings(), Place(tmp_path / "other", 0))
    monkeypatch.delenv(PYTHON)
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))
    with pytest.raises(ProgramFailed, match="no uv here"):
        train(settings(), Place(tmp_path / "third", 0))


def test_ctrl_c_ends_the_program_and_the_run_starts_again(python, tmp_path, monkeypatch):
    python("#!/bin/sh\nexec sleep 60\n")
    started = []
    wait = program.subprocess.Popen.wait

    def pressed(process, timeout=None):
        started.append(process)
        if len(started) == 1:
            raise KeyboardInterrupt
        return wait(process, timeout)

    with monkeypatch.context() as patch:
        patch.setattr(program.subprocess.Popen, "wait", pressed)
        assert train(settings(), Place(tmp_path / "run", 0)) is None
    assert started[0].returncode is not None
    python(PRETENDS.format(python=sys.executable))
    assert train(settings(), Place(tmp_path / "run", 0, resume=True)).steps == 320


@pytest.mark.parametrize(
    ("others", "message"),
    [
        ({"observation": "lossless"}, "observation='lossless'; jaxmarl-ippo trains with observation='jaxmarl' alone"),
        ({"cooking": "manual"}, "cooking='manual'"),
        ({"network": "cnn"}, "network='cnn'"),
        ({"check_share": 0.5}, "check_share=0.5"),
    ],
    ids=["observation", "cooking", "network", "check"],
)
def test_what_jaxmarl_has_not_is_refused(others, message):
    with pytest.raises(SettingsError, match=message):
        settings(**others)


def test_a_layout_that_jaxmarl_has_not_is_refused(tmp_path):
    with pytest.raises(UnfitError, match="layout='bottleneck'; JaxMARL's kitchen has cramped_room, "):
        train(settings(layout="bottleneck"), Place(tmp_path / "run", 0))


@pytest.mark.slow
@pytest.mark.skipif(not os.environ.get(PYTHON), reason=f"{PYTHON} names no Python that has JaxMARL")
def test_the_real_program_gives_the_same_weights_twice(tmp_path):
    outcomes = [train(settings(start="random"), Place(tmp_path / str(i), 2**32 - 1)) for i in range(2)]
    weights = [outcome.files.weights.read_bytes() for outcome in outcomes]
    assert weights[0] == weights[1]
    assert [outcome.steps for outcome in outcomes] == [320, 320]
    assert weights[0] != outcomes[0].snapshots[0.5].files.weights.read_bytes()

"""What a score with every partner of v1 takes, in seconds of one core, the networks alone beside it, and cross-play."""

import json
import sys
import time
from collections import defaultdict
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import Any

import pytest
import torch

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.policies.neural import Assignment, NeuralAgent, PolicyStack
from overcooked_bench.agents.policies.policy import Cnn, save_policy
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.seated import Seated, Views
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.evaluation.games.block import COPY, EGO, Block, play_block
from overcooked_bench.evaluation.games.cutting import cut
from overcooked_bench.evaluation.games.engines import ENGINES, open_engine, refuse
from overcooked_bench.evaluation.pools.crossplay import cross_play
from overcooked_bench.evaluation.protocol import load_protocol
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import CLASSIC, Layout
from overcooked_bench.kitchen.observations.registry import find_observation
from tests.agents.made import random_weights, record, write_policy
from tests.benchmarks.fresh import SCORE, run

pytestmark = pytest.mark.benchmark(timer=time.process_time)

ROUNDS = {"mlp": 3, "cnn": 1}
ANSWER = 250_000
AGENTS = {"mlp": "a fully connected agent", "cnn": "a convolutional agent of the thesis's size"}


def write_convolutional(folder: Path) -> str:
    """Writes a pool of one untrained agent per layout, which costs what a trained one does; returns its reference."""
    for seed, layout in enumerate(CLASSIC):
        shape = find_observation("lossless").shape(Layout.named(layout))
        architecture = Cnn(observation="lossless", observation_shape=shape, layout=layout, cooking="auto")
        save_policy(folder / layout / "cnn", architecture, random_weights(architecture, seed))
    write_manifest(folder, "convolutional", [record("cnn", layout) for layout in CLASSIC])
    return f"{folder}/{{layout}}/cnn"


def first_blocks(reference: str) -> tuple[list[Block], float]:
    """Returns the first block of each layout of a v1 score, and how many times as many episodes the score has."""
    protocol, agent = load_protocol("v1"), find(reference)
    pool = Pool.load("v1")
    start = Block(
        *(agent.reference, agent.sha256, protocol, "pepper", str(pool.folder), pool.hash, 0, CLASSIC[0], 0, (0,))
    )
    blocks = cut(start, protocol.play.layouts, training_seeds=1)
    first = blocks[: len(protocol.play.layouts)]
    assert {block.layout for block in first} == set(protocol.play.layouts)
    return first, sum(len(block.episodes) for block in blocks) / sum(len(block.episodes) for block in first)


class Watched:
    """Adds up the processor's seconds of each part of a block, and keeps what its networks compute.

    Attributes:
        seconds: By part.
        assignments: The networks of each block that was played.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._patch = monkeypatch
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self.assignments: list[list[Assignment]] = []
        self._time(Seated, "act", self._who)
        self._time(Views, "of", lambda _: "kitchens")
        self._time(Kitchens, "step", lambda _: "kitchens")
        assign = PolicyStack.assign

        def noted(stack: PolicyStack, index: Any) -> Assignment:
            self.assignments[-1].append(assign(stack, index))
            return self.assignments[-1][-1]

        monkeypatch.setattr(PolicyStack, "assign", noted)

    def _time(self, owner: type, method: str, name: Callable[[Any], str]) -> None:
        original = getattr(owner, method)

        def timed(of: Any, *arguments: Any) -> Any:
            start = time.process_time()
            try:
                return original(of, *arguments)
            finally:
                self.seconds[name(of)] += time.process_time() - start

        self._patch.setattr(owner, method, timed)

    @staticmethod
    def _who(seated: Seated) -> str:
        if seated.name in (EGO, COPY):
            return "agent"
        return "partners" if isinstance(seated.agent, NeuralAgent) else "scripts"

    def networks_alone(self, steps: int) -> float:
        """Runs all networks of each block for so many steps, on the inputs of the last one; returns the seconds."""
        start = time.process_time()
        with one_thread(), torch.inference_mode():
            for together in self.assignments:
                for _, one in product(range(steps), together):
                    if one._memory is None:
                        one._architecture.forward(one._weights, one._inputs)
                    else:
                        one._architecture.advance(one._weights, one._inputs, one._memory)
        return time.process_time() - start


@pytest.mark.parametrize("kind", AGENTS)
def test_a_score(benchmark: Any, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A round is one block of each layout; the networks alone follow each round, so that both meet one load."""
    blocks, whole = first_blocks("dev-v0/{layout}/sp-0" if kind == "mlp" else write_convolutional(tmp_path))
    horizon = blocks[0].protocol.play.horizon
    for block in blocks:
        play_block(block)  # to load and to warm up
    watched = Watched(monkeypatch)
    alone: list[float] = []
    rounds = ROUNDS[kind]
    episodes = 0

    def call() -> None:
        nonlocal episodes
        outcomes = []
        for block in blocks:
            watched.assignments.append([])
            outcomes.append(play_block(block))
        assert not any(outcome.fault for outcome in outcomes)
        episodes = sum(len(outcome.episodes) for outcome in outcomes)

    def setup() -> None:
        if watched.assignments:
            alone.append(watched.networks_alone(horizon))
            watched.assignments.clear()

    benchmark.group = "a score"
    benchmark.pedantic(call, setup=setup, rounds=rounds)
    setup()
    seconds = benchmark.stats.stats.mean
    benchmark.extra_info |= {
        "kind": "score",
        "agent": kind,
        "what": AGENTS[kind],
        "episodes": round(episodes * whole),
        "joint_steps": round(episodes * whole) * horizon,
        "seconds": seconds * whole,
        "ratio_to_networks": seconds * rounds / sum(alone),
        "parts": {part: took / rounds / seconds for part, took in watched.seconds.items()},
    }
    assert sum(watched.seconds.values()) < seconds * rounds


def test_cross_play(benchmark: Any, tmp_path: Path) -> None:
    for i in range(30):
        write_policy(tmp_path / "cramped_room" / f"sp-{i:02}", i, hidden=(64, 64))
    write_manifest(tmp_path, "thirty", [record(f"sp-{i:02}") for i in range(30)])
    pool = Pool.load(tmp_path)
    benchmark.group = "cross-play"
    found = benchmark.pedantic(lambda: cross_play(pool, "cramped_room", episodes=10), rounds=1)
    benchmark.extra_info |= {
        "kind": "cross-play",
        "what": "30 x 30 agents, 10 episodes per seat",
        "joint_steps": 30 * 30 * 10 * 400,
        "seconds": benchmark.stats.stats.mean,
    }
    assert len(found.means) == 30


def answer(block: Block) -> bytes:
    """Sends back as many bytes as a block's episodes have."""
    return bytes(ANSWER)


@pytest.mark.benchmark(timer=time.perf_counter)
@pytest.mark.parametrize("engine", ENGINES)
def test_the_overhead_of_a_block(benchmark: Any, engine: str) -> None:
    blocks = [*first_blocks("greedy")[0]] * 20
    with open_engine(engine, 2, apart=True) as opened:
        assert len(list(opened.map(answer, blocks[:8], refuse))) == 8  # all processes have started
        benchmark.group = "blocks in which nothing is played"
        benchmark.pedantic(lambda: list(opened.map(answer, blocks, refuse)), rounds=5)
    facts = {"kind": "overhead", "what": engine, "seconds": benchmark.stats.stats.median / len(blocks)}
    benchmark.extra_info |= facts


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_and_time_of_a_whole_score_in_a_fresh_process(benchmark: Any, tmp_path: Path) -> None:
    """With two workers; what the same takes with episodes of one step is its start-up."""
    told = []

    def call() -> None:
        for horizon, name in ((1, "start"), (400, "whole")):
            told.append(json.loads(run("-c", SCORE, str(horizon), str(tmp_path / name))))

    benchmark.group = "a score in a fresh process"
    benchmark.pedantic(call, rounds=1)
    start, whole = told
    benchmark.extra_info |= {
        "kind": "fresh score",
        "seconds": whole["seconds"],
        "start_up": start["seconds"],
        "busy": whole["busy"] - start["busy"],
        "mebibytes": whole["mebibytes"],
    }
    assert whole["episodes"] == start["episodes"] > 3000
    assert whole["mebibytes"] > 100

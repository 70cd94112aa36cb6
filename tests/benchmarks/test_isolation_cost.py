"""What isolation costs: a block of v1 with an MLP in a sandbox, as a ratio to the same block in this process."""

import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from overcooked_bench.agents.catalogue import find, find_unchanged
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.games.block import Block, play_block
from overcooked_bench.evaluation.games.cutting import cut
from overcooked_bench.evaluation.protocol import load_protocol
from tests.isolating import isolation_of

pytestmark = pytest.mark.benchmark

MOST = 1.3
ROUNDS = 3
LAYOUT = "cramped_room"
MLP = """
import torch

from overcooked_bench.agents import sample_actions


class Network(torch.nn.Sequential):
    observation = "lossless"

    def reset(self, layout, seats, seeds):
        self.seeds, self.now = seeds, -1

    @torch.no_grad()
    def act(self, observations):
        self.now += 1
        return sample_actions(self(torch.as_tensor(observations).float()).softmax(1).numpy(), self.seeds, self.now)


def make_agent(layout, training_seed):
    layers = torch.nn.Flatten(), torch.nn.Linear(440, 128), torch.nn.Tanh(), torch.nn.Linear(128, 128), torch.nn.Tanh()
    return Network(*layers, torch.nn.Linear(128, 6))
"""


def cpu_seconds() -> float:
    """CPU time of this process and of those that it has started, which have ended or still run."""
    parents, times = {}, {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            fields = stat.read_text().rpartition(")")[2].split()
            parents[int(stat.parent.name)] = int(fields[1])
            times[int(stat.parent.name)] = sum(map(int, fields[11:15]))
    ours = {os.getpid()}
    while more := {process for process, parent in parents.items() if parent in ours} - ours:
        ours |= more
    return sum(times[process] for process in ours) / os.sysconf("SC_CLK_TCK")


def measured(block: Block) -> tuple[float, float]:
    """Returns CPU seconds: of loading the submission, and of the fastest of some rounds of the block."""
    began = cpu_seconds()
    find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode, block.isolation)
    loaded, rounds = cpu_seconds(), []
    for _ in range(ROUNDS):
        before = cpu_seconds()
        assert play_block(block).fault is None
        rounds.append(cpu_seconds() - before)
    return loaded - began, min(rounds)


def test_an_isolated_score_takes_little_longer(benchmark: Any, tmp_path: Path) -> None:
    """All processes count. Besides, every worker starts one template, for all blocks that it plays."""
    isolation = isolation_of("strong")
    (tmp_path / "mlp.py").write_text(MLP)
    rules = load_protocol("v1")
    assert rules.play.pool is not None
    entrant, pool = find(tmp_path / "mlp.py"), Pool.load(rules.play.pool)
    first = Block(
        *(entrant.reference, entrant.sha256, rules, "salt", str(pool.folder), pool.hash),
        *(0, LAYOUT, 0, (0,)),
    )
    here = cut(first, [LAYOUT], 1)[0]
    play_block(here)  # compiles
    _, plain = measured(here)
    template, isolated = measured(replace(here, isolation=isolation))
    figures = {"here": plain, "isolated": isolated, "ratio": isolated / plain, "template": template}
    benchmark.extra_info |= {name: round(value, 3) for name, value in figures.items()}
    benchmark.pedantic(play_block, args=(here,), rounds=1)
    assert isolated / plain <= MOST

"""State that outlives a block, and rows that share a generator, are noticed by playing one block again."""

import re
from dataclasses import replace

import numpy as np
import pytest

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.turned import Turned
from overcooked_bench.evaluation.games.again import ORDER, OUTLIVES, play_again
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.play import play_episodes
from tests.evaluation.made import AGENT, DRAW, block

MODULE = "rng = np.random.default_rng(0)\ncount = [0]\n"
AGENTS = {
    "keeps the contract": (DRAW, "pass", None),
    "a generator at module level": ("return rng.integers(0, 6, n)", "pass", OUTLIVES),
    "a count at module level": ("count[0] += 1; return np.full(n, count[0] % 3)", "pass", OUTLIVES),
    "a generator without a seed": ("return np.random.default_rng().integers(0, 6, n)", "pass", OUTLIVES),
    "one generator for all rows": ("return self.rng.integers(0, 6, n)", "self.rng = np.random.default_rng(1)", ORDER),
    "numpy's generator, which is seeded": ("return np.random.randint(0, 6, n)", "pass", ORDER),
    "by the place in the batch": ("return np.arange(n) % 6", "pass", ORDER),
    "breaks the contract": ("return None", "pass", None),
}


@pytest.mark.parametrize(("act", "reset", "expected"), AGENTS.values(), ids=AGENTS.keys())
def test_what_one_block_played_again_shows(act, reset, expected, protocol, tmp_path):
    file = tmp_path / "agent.py"
    text = AGENT.format(act=act, reset=reset, make="pass", observation="lossless", training_seeds=1)
    file.write_text(text.replace("\n\n\nclass", f"\n{MODULE}\n\nclass", 1))
    assert play_again(block(protocol, file)) == expected


@pytest.mark.parametrize("name", ["greedy", "script:helper"])
def test_our_agents_play_a_turned_block_the_same(name, protocol):
    first = block(protocol, name)
    assert play_block(first).episodes == play_block(replace(first, turned=True)).episodes


def test_a_turned_agents_answers_are_checked_too():
    class Wrong:
        observation = "state"

        def reset(self, layout, seats, seeds):
            self.seats = seats

        def act(self, observations):
            return np.array([4, 4, 9])[: len(observations)]

    with pytest.raises(ValueError, match=re.escape("the action 9 in row 2")):
        play_episodes("cramped_room", agents=(Turned(Wrong()), find("stay").make("", 0)), episodes=3)

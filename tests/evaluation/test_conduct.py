"""What chefs do, counted from stored episodes, is what is counted in recorded games."""

import numpy as np
import pytest

from overcooked_bench.evaluation.conduct import CONDUCT, count_conduct
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.human.conduct import conduct
from overcooked_bench.human.games import record
from tests.evaluation.made import block, protocol_text
from tests.human.made import PEOPLE

HORIZON = 250


@pytest.mark.parametrize("layout", ["forced_coordination", "counter_circuit"])
def test_a_stored_episode_is_counted_as_a_recorded_game(layout):
    rules = read_protocol(protocol_text(layouts=[layout], horizon=HORIZON), "p.yaml")
    episodes = play_block(block(rules, agent="greedy", layout=layout)).episodes
    found = count_conduct(episodes, "auto", HORIZON)
    assert found.shape == (len(episodes), 2, len(CONDUCT))
    for episode, row in zip(episodes, found, strict=True):
        actions = episode.joint_actions(HORIZON).astype(np.int64)
        game = record(layout, actions, seats=PEOPLE, source="made up", start=episode.first_state)
        chefs = [conduct([game]).chefs[seat] for seat in (episode.seat, 1 - episode.seat)]
        expected = [
            [chef.events["pots"] * HORIZON / 400, chef.hands_over * HORIZON / 400, chef.blocked, chef.idle]
            for chef in chefs
        ]
        assert row == pytest.approx(np.array(expected))
    assert found[..., CONDUCT.index("pots")].any()
    handed = found[..., CONDUCT.index("hand_overs")]
    assert layout != "forced_coordination" or (handed.any(axis=0)).all(), "nothing works there without hand-overs"

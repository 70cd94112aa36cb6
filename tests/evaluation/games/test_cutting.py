"""How a score is cut into blocks."""

from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.evaluation.games.cutting import LEAST_ROWS, cut, group_starts
from overcooked_bench.evaluation.protocol import read_protocol
from tests.evaluation.made import block, protocol_text


@given(st.integers(1, 60), st.integers(1, 600))
def test_groups_are_all_start_states_once_in_batches_of_hundreds_of_rows(number, rows):
    groups = group_starts(number, rows)
    assert [index for group in groups for index in group] == list(range(number))
    assert max(map(len, groups)) - min(map(len, groups)) <= 1
    assert len(groups) == 1 or min(map(len, groups)) * rows >= LEAST_ROWS / 2
    assert all(len(group) == 1 or len(group) * rows < 4 * LEAST_ROWS for group in groups)


def test_every_layout_and_training_seed_gets_ahead_together():
    rules = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"], episodes=130), "p.yaml")
    blocks = cut(block(rules), rules.play.layouts, training_seeds=2)
    order = [(one.episodes[0], one.training_seed, one.layout) for one in blocks]
    assert order == [(first, run, layout) for first in (0, 65) for run in (0, 1) for layout in rules.play.layouts]
    keys = [key for one in blocks for key in one.keys]
    assert len(set(keys)) == len(keys) == 2 * 2 * 130

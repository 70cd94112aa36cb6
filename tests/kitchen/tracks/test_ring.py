"""The middle of a kitchen that chefs walk around."""

import numpy as np
import pytest

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tracks.ring import find_middle, laps

TWO_BLOCKS = """
XXPXXXX
O 1   X
X X X D
X 2   X
XXXSXXX
"""
BENT = """
XXPXXXXX
O 1    X
X XXXX X
X    X D
X XXXX X
X 2    X
XXXSXXXX
"""


@pytest.mark.parametrize(
    ("layout", "middle"),
    [
        ("coordination_ring", (2, 2)),
        ("counter_circuit", (3.5, 2)),
        ("cramped_room", None),
        ("asymmetric_advantages", None),
        ("forced_coordination", None),
        ("bottleneck", None),
        (TWO_BLOCKS, None),
    ],
)
def test_a_ring_goes_around_one_block(layout, middle):
    assert find_middle(Layout.load(layout)) == middle


def test_the_middle_is_on_the_block_that_it_is_the_middle_of():
    layout = Layout.load(BENT)
    x, y = find_middle(layout)
    assert layout.tile((int(x), int(y))) == "X"


def test_ways_that_are_more_than_a_stretch_apart_do_not_cancel_out():
    """A lap clockwise and, later, one back: both count if 100 steps lie between their beginnings."""
    turn = np.linspace(0, 2 * np.pi, 101)
    for angle, expected in ((np.append(turn, turn[-2::-1]), [1, 1]), (np.append(turn[::2], turn[-3::-2]), [0, 0])):
        both = np.stack([angle, angle], axis=1)
        assert laps(np.cos(both), np.sin(both), (0, 0)) == pytest.approx(np.array([expected, expected]))


def test_a_lap_around_any_block_is_one_lap():
    layout = Layout.load(BENT)
    way = [(x, 1) for x in range(1, 7)] + [(6, y) for y in range(2, 6)] + [(x, 5) for x in range(5, 0, -1)]
    way += [(1, y) for y in range(4, 0, -1)]
    x, y = np.array([[*zip(way, way[::-1], strict=True)]]).T.reshape(2, 2, -1).transpose(0, 2, 1)
    found = laps(x, y, find_middle(layout))
    assert found == pytest.approx(np.array([[1, 0], [0, 1]]))

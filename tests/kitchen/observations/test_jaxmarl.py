"""The observation of JaxMARL's agents: a recorded game of theirs, and what it has in common with our own encoding."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Layout
from overcooked_bench.kitchen.codes import COUNTER, NUM_ITEMS
from overcooked_bench.kitchen.image import CHANNELS
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.kitchen.strategies import SEEDS, joint_actions, law, layouts

RECORDED = Path(__file__).parents[2] / "data" / "jaxmarl" / "coord_ring.npz"
COUNTERS = CHANNELS.index("counters")


def test_a_game_recorded_in_jaxmarl_is_seen_and_paid_the_same_here():
    with np.load(RECORDED) as recorded:
        seen, actions, points, shaped = (recorded[name] for name in ("seen", "actions", "points", "shaped"))
    kitchens = Kitchens("coordination_ring", 1, horizon=400)
    kitchens.autoreset = False
    kitchens.set_state(0, KitchenState((Chef((2, 1), "south"), Chef((1, 2), "east")), {}))
    for step, joint in enumerate(actions):
        np.testing.assert_array_equal(kitchens.observe("jaxmarl")[0], seen[step].transpose(0, 3, 1, 2))
        result = kitchens.step(joint[None].astype(int))
        assert result.soup_reward.sum() == points[step]
        assert result.partial_reward[0].tolist() == shaped[step].tolist()
    np.testing.assert_array_equal(kitchens.observe("jaxmarl")[0], seen[400].transpose(0, 3, 1, 2))
    assert points.sum() == 140
    assert (seen[:, 0, :, :, COUNTERS].sum((1, 2)) < seen[0, 0, :, :, COUNTERS].sum()).any(), "a counter was laden"


@law
@given(st.data(), SEEDS)
def test_only_laden_counters_are_shown_otherwise_than_in_lossless26(data, seed):
    kitchens = Kitchens(data.draw(layouts(tomatoes=False)), 2, cooking="manual", object_probability=0.6)
    for joint in joint_actions(seed, 25, kitchens=2):
        kitchens.step(joint)
        expected = kitchens.observe("lossless26")
        laden = (kitchens.batch.cells > COUNTER) & (kitchens.batch.cells < COUNTER + NUM_ITEMS)
        expected[:, :, COUNTERS][
            np.broadcast_to(laden.reshape(2, 1, *expected.shape[-2:]), (2, 2, *expected.shape[-2:]))
        ] = 0
        np.testing.assert_array_equal(kitchens.observe("jaxmarl"), expected)


@law
@given(st.data(), SEEDS)
def test_views_follow_from_what_is_live(data, seed):
    layout = data.draw(layouts(tomatoes=False))
    kitchens = Kitchens(layout, 2, cooking="manual", object_probability=0.6)
    live = OBSERVATIONS["jaxmarl"].live(layout)
    for joint in joint_actions(seed, 25, kitchens=2):
        kitchens.step(joint)
        for view in kitchens.observe("jaxmarl").reshape(4, -1):
            np.testing.assert_array_equal(view[live.places][live.shown][live.shown >= 0], view[live.shown >= 0])


def test_tomatoes_are_refused():
    with pytest.raises(ValueError, match="'jaxmarl' has no tomatoes, and this layout has; use 'lossless26'"):
        Kitchens(Layout.from_text("XTPXX\nO  2O\nX1  X\nXDXSX"), 1).observe("jaxmarl")

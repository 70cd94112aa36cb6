"""Plays our kitchen beside overcooked-ai 1.1.0, live: random layouts, menus, states and actions, cooking by hand.

Needs the dependency group `oracle`; run with `pytest -m oracle`.
"""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Layout
from overcooked_bench.kitchen.layout import layout_names
from tests.kitchen.strategies import SEEDS, described_layouts, joint_actions, states

pytestmark = [pytest.mark.oracle, pytest.mark.slow]

HORIZON = 60
CLASSIC_MENU = {
    "orders": [["onion"] * 3],
    "bonus_orders": [],
    "order_bonus": 2,
    "soup_reward": 20,
    "cook_time": 20,
}

differential = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


@pytest.fixture(scope="module")
def oracle():
    """The module that knows the reference, imported here because most runs do without it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from tests.oracle import reference
    return reference


def play_both(oracle, layout, menu, state, actions, features=False) -> int:
    """Plays actions in both kitchens and compares all that is seen; gives the number of steps compared."""
    ours = Kitchens(layout, 1, cooking="manual", events=True, horizon=HORIZON)
    ours.autoreset = False
    ours.set_state(0, state)
    theirs = oracle.Reference(layout, menu, state)
    for step, joint in enumerate(actions):
        assert oracle.with_sorted_orders(ours.state(0)) == theirs.state
        np.testing.assert_array_equal(ours.observe("lossless26")[0], theirs.lossless26(HORIZON))
        if features:
            np.testing.assert_array_equal(ours.observe("features")[0], theirs.features())
        if ours.state(0).timestep == HORIZON:
            return step
        result = ours.step(joint)
        soup_reward, partial_reward, events = theirs.step(joint[0])
        assert result.soup_reward[0].tolist() == soup_reward
        assert result.partial_reward[0].tolist() == partial_reward
        np.testing.assert_array_equal(result.events[0], events)
    return len(actions)


@settings(differential, max_examples=150)
@given(st.data(), described_layouts(cooking="manual"), SEEDS)
def test_random_kitchens(oracle, data, described, seed):
    layout, menu = described
    state = data.draw(states(layout, horizon=21))
    play_both(oracle, layout, menu, state, joint_actions(seed, 40))


@settings(differential, max_examples=25)
@given(st.data(), described_layouts(cooking="manual"), SEEDS)
def test_features_of_random_kitchens(oracle, data, described, seed):
    layout, menu = described
    state = data.draw(states(layout, horizon=21))
    play_both(oracle, layout, menu, state, joint_actions(seed, 25), features=True)


@pytest.mark.parametrize("name", layout_names())
def test_shipped_kitchens_from_random_states(oracle, name):
    layout = Layout.load(name)

    @settings(differential, max_examples=8)
    @given(states(layout, horizon=21), SEEDS)
    def compare(state, seed):
        play_both(oracle, layout, CLASSIC_MENU, state, joint_actions(seed, 60))

    compare()

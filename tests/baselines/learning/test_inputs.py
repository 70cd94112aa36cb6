import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Layout
from overcooked_bench.kitchen.image import URGENCY
from overcooked_bench.kitchen.observations.grid import Grid
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts

GRIDS = [name for name, observation in OBSERVATIONS.items() if isinstance(observation, Grid)]
KITCHENS, HORIZON = 3, 55  # the last 40 steps are urgent


@law
@given(data=st.data(), cooking=COOKING, seed=SEEDS, probability=st.sampled_from([0.0, 0.5, 1.0]))
def test_all_other_inputs_stay_as_they_are_whatever_is_played(data, cooking, seed, probability):
    tomatoes = data.draw(st.booleans(), "tomatoes")
    layout = data.draw(layouts(cooking, tomatoes), "layout")
    observation = data.draw(st.sampled_from(["lossless26"] if layout.has_tomatoes else GRIDS))
    kitchens = Kitchens(layout, KITCHENS, cooking=cooking, horizon=HORIZON, object_probability=probability, history=3)
    live = OBSERVATIONS[observation].live(layout).places
    kitchens.reset(seed=seed)
    seen = [kitchens.observe(observation)]
    for actions in joint_actions(seed, HORIZON + 5, KITCHENS):
        kitchens.step(actions)
        seen.append(kitchens.observe(observation))
    flat = np.stack(seen).reshape(-1, np.prod(kitchens.observation_shape(observation)))  # (views, inputs)
    planes = np.array(OBSERVATIONS[observation].channels).repeat(layout.width * layout.height)
    changing = set(np.flatnonzero((flat != flat[0]).any(0)).tolist())
    urgent = set(np.flatnonzero(planes == URGENCY).tolist())
    assert changing - urgent <= set(live.tolist())
    assert bool(changing & urgent) == (URGENCY in OBSERVATIONS[observation].channels)
    area = layout.width * layout.height
    for plane in flat[:, sorted(urgent)].reshape(len(flat), len(urgent) // area, area).swapaxes(0, 1):
        assert (plane == plane[:, :1]).all()


@pytest.mark.parametrize("observation", GRIDS)
def test_each_input_once_in_order_and_one_of_each_urgency_plane(observation):
    layout = Layout.load("counter_circuit")
    live = OBSERVATIONS[observation].live(layout).places
    area = layout.width * layout.height
    channels = np.array(OBSERVATIONS[observation].channels)
    assert len(channels) * area == np.prod(OBSERVATIONS[observation].shape(layout))
    assert (np.diff(live) > 0).all()
    assert 0 <= live.min() <= live.max() < len(channels) * area
    assert [int((channels[live // area] == URGENCY).sum())] == [int((channels == URGENCY).sum())]


def test_what_is_live_in_a_cramped_room():
    """Six cells of floor, nine counters of which five can be faced, one pot."""
    layout = Layout.load("cramped_room")
    cells = np.bincount(OBSERVATIONS["lossless26"].live(layout).places // 20, minlength=26).tolist()
    chefs, tiles, things = [6] * 10, [0] * 6, 6 + 5
    in_pot, in_soup = [1, 1], [things + 1] * 2
    assert cells == [*chefs, *tiles, *in_pot, *in_soup, 1, things + 1, *[things] * 3, 1]

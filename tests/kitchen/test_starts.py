"""Start states: where chefs may stand, what lies about, and that each kitchen has its own random stream."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chi2

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.kitchen.layout import layout_names
from tests.kitchen.strategies import COOKING, SEEDS, law, layouts

MANY = 3000


def starts(layout, n=MANY, seed=0, **options) -> list[KitchenState]:
    kitchens = Kitchens(layout, n, **options)
    kitchens.reset(seed=seed)
    return [kitchens.state(i) for i in range(n)]


def cells(state: KitchenState) -> tuple[tuple[int, int], tuple[int, int]]:
    return state.chefs[0].position, state.chefs[1].position


@pytest.mark.parametrize("name", layout_names())
def test_the_standard_start_is_that_of_the_digits(name):
    layout = Layout.load(name)
    first, second = layout.start_cells
    expected = KitchenState((Chef(first), Chef(second)), {}, 0, layout.orders, layout.bonus_orders)
    assert starts(layout, 3, start="standard") == [expected] * 3


@pytest.mark.parametrize("name", ["forced_coordination", "asymmetric_advantages"])
@pytest.mark.parametrize("suffix", ["", "-mirrored"])
def test_chefs_of_a_divided_kitchen_never_share_a_side_and_take_both(name, suffix):
    layout = Layout.load(name + suffix)
    sides = Counter(tuple(layout.regions[cell] for cell in cells(state)) for state in starts(layout))
    assert set(sides) == {(0, 1), (1, 0)}
    assert abs(sides[0, 1] - MANY / 2) < 4 * np.sqrt(MANY / 4)


@pytest.mark.parametrize("name", layout_names())
def test_start_cells_are_uniform_over_the_allowed_ordered_pairs(name):
    layout = Layout.load(name)
    floor = layout.regions
    allowed = [(a, b) for a in floor for b in floor if a != b and layout.start_regions[floor[a], floor[b]]]
    n = 20 * len(allowed)
    found = Counter(map(cells, starts(layout, n, seed=20)))
    assert set(found) <= set(allowed)
    statistic = sum((found[pair] - 20) ** 2 / 20 for pair in allowed)
    assert chi2.sf(statistic, len(allowed) - 1) > 1e-4
    assert chi2.cdf(statistic, len(allowed) - 1) > 1e-4


@law
@given(st.data(), COOKING, SEEDS)
def test_every_random_start_is_legal_and_calm(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    for state in starts(layout, 10, seed=seed, cooking=cooking):
        a, b = cells(state)
        assert a != b
        assert layout.start_regions[layout.regions[a], layout.regions[b]]
        assert [chef.facing for chef in state.chefs] == ["north", "north"]
        assert [chef.holding for chef in state.chefs] == [None, None]
        assert (state.timestep, state.objects) == (0, {})


def is_part_of(content: tuple[int, int], order: tuple[int, int]) -> bool:
    return content[0] <= order[0] and content[1] <= order[1]


@law
@given(st.data(), COOKING, SEEDS)
def test_objects_are_what_the_orders_use(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    used = {name for order in layout.orders for name, n in zip(("onion", "tomato"), order, strict=True) if n}
    kitchens = Kitchens(layout, 1, cooking=cooking)
    for state in starts(layout, 20, seed=seed, cooking=cooking, object_probability=0.7):
        kitchens.set_state(0, state)
        assert kitchens.state(0) == state
        for place, soup in state.objects.items():
            assert layout.tile(place) == "P"
            if soup.is_idle:
                assert any(is_part_of(soup.recipe, order) and soup.recipe != order for order in layout.orders)
            else:
                assert soup.recipe in layout.orders
        for chef in state.chefs:
            held = chef.holding
            assert (
                held is None
                or held == "dish"
                or (held in used if isinstance(held, str) else held.recipe in layout.orders)
            )


@pytest.mark.parametrize("cooking", ["auto", "manual"])
def test_pots_start_empty_partly_filled_at_every_stage_of_cooking_and_ready(cooking):
    pots = [
        state.objects.get((2, 0))
        for state in starts("cramped_room", cooking=cooking, start="standard", object_probability=0.5)
    ]
    empty = sum(pot is None for pot in pots)
    idle = Counter(pot.recipe for pot in pots if pot is not None and pot.is_idle)
    remaining = Counter(pot.remaining for pot in pots if pot is not None and not pot.is_idle)
    assert abs(empty - MANY / 2) < 4 * np.sqrt(MANY / 4)
    assert set(idle) == {(1, 0), (2, 0)}
    assert set(remaining) == set(range(21))  # 0 is ready, 20 just started
    for amount in (*idle.values(), sum(remaining.values())):
        assert abs(amount - MANY / 6) < 5 * np.sqrt(MANY / 6)


@pytest.mark.parametrize("probability", [0.0, 0.3, 1.0])
def test_hands_are_filled_as_often_as_asked_with_dishes_onions_and_soups(probability):
    hands = Counter(
        chef.holding for state in starts("cramped_room", object_probability=probability) for chef in state.chefs
    )
    expected = {None: 1 - probability, "dish": 0.2 * probability, "onion": 0.6 * probability}
    expected[Soup((3, 0), 20, 20)] = 0.2 * probability
    assert sum(hands.values()) == 2 * MANY
    assert set(hands) == {thing for thing, share in expected.items() if share}
    for thing, share in expected.items():
        assert abs(hands[thing] - 2 * MANY * share) <= 5 * np.sqrt(2 * MANY * share)


def test_kitchen_i_depends_on_the_seed_and_i_alone():
    few, many = (starts("cramped_room", n, seed=7, object_probability=0.5) for n in (5, 50))
    assert many[:5] == few
    assert len({cells(state) for state in many}) > 10
    assert starts("cramped_room", 50, seed=8, object_probability=0.5) != many


def test_a_seed_repeats_and_no_seed_goes_on():
    kitchens = Kitchens("counter_circuit", 20)
    seen = []
    for seed in (3, None, None, 3, None, None):
        kitchens.reset(seed=seed)
        seen.append([kitchens.state(i) for i in range(20)])
    assert seen[:3] == seen[3:]
    assert seen[0] != seen[1] != seen[2]


def test_kitchens_without_a_seed_differ():
    one, other = (Kitchens("counter_circuit", 40) for _ in range(2))
    assert [one.state(i) for i in range(40)] != [other.state(i) for i in range(40)]


def test_keys_give_each_kitchen_its_own_stream_wherever_it_sits():
    keys = np.array([11, 2**64 - 1, 5, 11], np.uint64)
    together = Kitchens("counter_circuit", 4)
    together.reset(seed=keys)
    states = [together.state(i) for i in range(4)]
    assert states[0] == states[3]
    alone = Kitchens("counter_circuit", 1)
    for i in range(4):
        alone.reset(seed=keys[i : i + 1])
        assert alone.state(0) == states[i]


def test_the_standard_start_too_draws_objects_from_the_kitchens_stream():
    one, other = (starts("cramped_room", 60, seed=s, start="standard", object_probability=0.5) for s in (1, 2))
    assert one == starts("cramped_room", 60, seed=1, start="standard", object_probability=0.5)
    assert one != other


def test_the_key_0_is_a_key_like_any_other():
    kitchens = Kitchens("cramped_room", 2, horizon=2)
    kitchens.reset(seed=np.array([0, 1], np.uint64))
    for _ in range(3):
        kitchens.step([[4, 4], [4, 4]])
    assert [kitchens.state(i).timestep for i in range(2)] == [1, 1]


@pytest.mark.parametrize("mask", [[True], [True, False], [0, 2, 1]], ids=["one", "two", "indices"])
def test_a_wrong_mask_is_refused(mask):
    with pytest.raises(ValueError, match="mask"):
        Kitchens("cramped_room", 3).reset(mask=np.array(mask))


def test_wrong_seeds_are_refused():
    kitchens = Kitchens("cramped_room", 3)
    with pytest.raises(ValueError, match=r"seed has the shape \(2,\); give one number or an array of shape \(3,\)"):
        kitchens.reset(seed=np.zeros(2, np.uint64))
    with pytest.raises(ValueError, match="give either a seed or a mask"):
        kitchens.reset(seed=1, mask=np.ones(3, np.bool_))
    with pytest.raises(ValueError, match="seed=-1; give a whole number from 0"):
        kitchens.reset(seed=-1)
    with pytest.raises(ValueError, match="seed holds float64 keys"):
        kitchens.reset(seed=np.zeros(3))


def test_a_grid_without_digits_has_no_standard_start():
    with pytest.raises(
        ValueError, match="start='standard', but the grid names no start cells; mark two with the digits"
    ):
        Kitchens("XXPXX\nO   O\nX   X\nXDXSX", 1, start="standard")

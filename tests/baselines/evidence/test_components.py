"""Variance components that are known, found again in simulated returns."""

import numpy as np
import pytest

from overcooked_bench.baselines.evidence.components import COMPONENTS, components, shares

TRUE = {
    "partner": 400.0,
    "recipe": 150.0,
    "training seed": 60.0,
    "recipe x partner": 100.0,
    "training seed x partner": 80.0,
    "side": 200.0,
    "seat": 50.0,
    "start": 40.0,
    "noise": 120.0,
}


def simulated(rng, recipes=8, seeds=5, partners=25, episodes=4, sided=True, true=TRUE):
    """Returns of entrants in a model of which every component is known; a start has one chef on each side."""

    def effect(name, *shape):
        return np.sqrt(true[name]) * rng.standard_normal(shape)

    recipe, agents = np.repeat(np.arange(recipes), seeds), recipes * seeds
    first = rng.integers(0, 2, (partners, episodes)) if sided else np.zeros((partners, episodes), int)
    side = np.stack([first, 1 - first if sided else first], axis=2)
    sign = rng.choice([-1.0, 1.0], (agents, partners))
    seat_sign = np.array([-1.0, 1.0]) * rng.choice([-1.0, 1.0], (agents, partners))[:, :, None]
    y = 100 + effect("partner", partners)[None, :] + effect("recipe", recipes)[recipe, None]
    y = y + effect("training seed", agents)[:, None] + effect("recipe x partner", recipes, partners)[recipe]
    y = (y + effect("training seed x partner", agents, partners))[:, :, None, None]
    y = y + (np.sqrt(true["side"]) * sign[:, :, None, None] * (2 * side - 1) if sided else 0.0)
    y = y + np.sqrt(true["seat"]) * seat_sign[:, :, None, :] + effect("start", partners, episodes, 2)
    y = y + effect("noise", agents, partners, episodes, 2)
    return y, np.broadcast_to(side, y.shape), [f"recipe {index}" for index in recipe]


@pytest.mark.parametrize("episodes", [4, 6])
def test_every_component_of_a_simulation_is_found_again(episodes):
    rng = np.random.default_rng(3)
    found = [components(*simulated(rng, episodes=episodes)) for _ in range(60)]
    for name in COMPONENTS:
        values = np.array([one[name] for one in found])
        error = values.std(ddof=1) / len(values) ** 0.5
        assert abs(values.mean() - TRUE[name]) < 4 * error, name
        assert error < 0.1 * TRUE[name] + 3, name  # narrow enough to say something


def test_two_episodes_leave_the_seat_of_a_floor_with_two_sides_in_the_noise():
    rng = np.random.default_rng(7)
    found = [components(*simulated(rng, episodes=2)) for _ in range(30)]
    assert all(np.isnan(one["seat"]) for one in found)
    assert np.mean([one["side"] for one in found]) == pytest.approx(200, abs=30)
    assert np.mean([one["noise"] for one in found]) == pytest.approx(170, abs=30)
    assert components(*simulated(rng, episodes=2, sided=False))["seat"] == pytest.approx(50, abs=15)


def test_an_effect_that_is_absent_is_about_zero():
    rng = np.random.default_rng(4)
    for absent in COMPONENTS:
        true = TRUE | {absent: 0.0}
        found = np.mean([components(*simulated(rng, true=true))[absent] for _ in range(20)])
        assert abs(found) < 15, absent


def test_what_the_data_cannot_show_is_not_a_number():
    rng = np.random.default_rng(5)
    y, sides, recipes = simulated(rng, sided=False)
    assert [name for name, value in components(y, sides, recipes).items() if np.isnan(value)] == ["side"]
    alone = components(y, sides, [f"recipe {index}" for index in range(len(y))])
    assert {name for name, value in alone.items() if np.isnan(value)} >= {"recipe", "training seed", "side"}
    by_seat = components(y, np.broadcast_to(np.array([0, 1]), y.shape), recipes)
    assert np.isnan(by_seat["seat"])  # side and seat are one here
    assert by_seat["side"] == pytest.approx(50, rel=0.5)


def test_shares_sum_to_one_and_count_nothing_below_zero():
    found = shares({"partner": 30.0, "recipe": -5.0, "side": np.nan, "noise": 10.0})
    assert found["partner"] == 0.75
    assert (found["recipe"], found["noise"]) == (0.0, 0.25)
    assert np.isnan(found["side"])


def test_entrants_that_got_other_starts_are_refused():
    y, sides, recipes = simulated(np.random.default_rng(6))
    other = sides.copy()
    other[0] = 1 - other[0]
    with pytest.raises(ValueError, match="same starts"):
        components(y, other, recipes)
    with pytest.raises(ValueError, match="two at least"):
        components(y[:, :, :1], sides[:, :, :1], recipes)

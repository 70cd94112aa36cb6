import numpy as np
import pytest

from overcooked_bench import Soup
from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.pools.profile import Deeds, measure
from tests.agents.made import small_mlp
from tests.kitchen.staging import (
    AT_COUNTER,
    AT_DISHES,
    AT_LEFT_POT,
    AT_ONIONS,
    AT_SERVING,
    AWAY,
    COUNTER,
    LEFT_POT,
    SOUP,
    act,
    chef,
    stage,
)


def constant(logits, **settings) -> Policy:
    """A policy that does not look."""
    architecture = small_mlp(**settings)
    weights = {name: np.zeros(shape, np.float32) for name, shape in architecture.tensor_shapes().items()}
    weights["action.bias"] = np.asarray(logits, np.float32)
    return Policy("constant", architecture, weights, "")


def deeds(place, holding=None, lying=None, other=None):
    """What one interaction by seat 1 counts as, beside a seat 0 that waits."""
    kitchens = stage(chef(AWAY, other), chef(place, holding), lying)
    counter = Deeds(1)
    counter.watch(kitchens, act(kitchens, "stay", "interact"))
    means = counter.means()
    assert all(count[0] == 0 for count in means.values())
    return {name for name, count in means.items() if count[1]}


@pytest.mark.parametrize(
    ("place", "holding", "lying", "expected"),
    [
        (AT_LEFT_POT, "onion", None, {"pots"}),
        (AT_LEFT_POT, "tomato", None, {"pots"}),
        (AT_LEFT_POT, "dish", {LEFT_POT: SOUP}, {"plates"}),
        (AT_LEFT_POT, "dish", {LEFT_POT: Soup((3, 0), 4, 20)}, set()),
        (AT_SERVING, SOUP, None, {"deliveries"}),
        (AT_COUNTER, "onion", None, {"counter_drops"}),
        (AT_COUNTER, SOUP, None, {"counter_drops"}),
        (AT_COUNTER, None, {COUNTER: "dish"}, {"counter_pickups"}),
        (AT_COUNTER, None, {COUNTER: SOUP}, {"counter_pickups"}),
        (AT_COUNTER, "dish", {COUNTER: SOUP}, set()),
        (AT_ONIONS, None, None, set()),
        (AT_DISHES, None, None, set()),
    ],
    ids=[
        *("onion-in-pot", "tomato-in-pot", "plating", "not-ready", "serving", "drop", "soup-drop", "pickup"),
        *("soup-pickup", "full-hands", "onion-dispenser", "dish-dispenser"),
    ],
)
def test_each_deed_is_counted_for_its_chef(place, holding, lying, expected):
    assert deeds(place, holding, lying) == expected


def test_deeds_add_up_over_steps_and_are_averaged_over_episodes():
    kitchens = stage(chef(AT_COUNTER, "onion"), chef(AWAY))
    counter = Deeds(1)
    for _ in range(6):
        counter.watch(kitchens, act(kitchens, "interact", "stay"))
    assert counter.means()["counter_drops"].tolist() == [3, 0]
    assert counter.means()["counter_pickups"].tolist() == [3, 0]


@pytest.mark.parametrize(
    ("logits", "entropy"), [((0,) * 6, np.log(6)), ((0, 0, 0, 0, 99, 0), 0), ((0, 0, -99, -99, -99, -99), np.log(2))]
)
def test_entropy_is_in_nats(logits, entropy):
    assert measure(constant(logits), episodes=2, horizon=10).profile.entropy == pytest.approx(entropy, abs=1e-4)


def test_who_only_waits_brings_nothing():
    measured = measure(constant((0, 0, 0, 0, 9, 0)), mode="greedy", episodes=3, horizon=20)
    assert measured.returns.tolist() == [0, 0, 0]
    assert (measured.self_play.mean, measured.self_play.episodes) == (0, 3)
    for seat in measured.profile.seats:
        assert (seat.mean, seat.partial_reward, seat.pots, seat.counter_drops) == (0, 0, 0, 0)


@pytest.mark.parametrize("layout", ["cramped_room", "forced_coordination"])
def test_the_seats_share_what_the_team_reaches(layout):
    """On a good agent: what is delivered is paid, and nothing is delivered that was not plated and put into pots."""
    measured = measure(Pool.load("dev-v0").policy(layout, "sp-0"), episodes=10)
    seats = measured.profile.seats
    assert measured.returns.mean() == pytest.approx(measured.self_play.mean)
    assert measured.self_play.mean > 100
    assert sum(seat.mean for seat in seats) == pytest.approx(measured.self_play.mean)
    for seat in seats:
        assert seat.mean == pytest.approx(20 * seat.deliveries)
        assert seat.low <= seat.mean <= seat.high
    plates, deliveries = (sum(getattr(seat, name) for seat in seats) for name in ("plates", "deliveries"))
    assert deliveries <= plates <= sum(seat.pots for seat in seats) / 3
    drops, pickups = (sum(getattr(seat, f"counter_{name}") for seat in seats) for name in ("drops", "pickups"))
    assert pickups <= drops
    assert (drops > 10) == (layout == "forced_coordination")  # things are handed over there


def test_an_episode_depends_on_the_seed_and_its_index_alone():
    policy = constant((0, 0, 0, 0, 0, 1))
    two, three, other = (measure(policy, episodes=n, seed=seed, horizon=150) for n, seed in ((20, 1), (30, 1), (30, 2)))
    assert (two.returns == three.returns[:20]).all()
    assert two.profile != three.profile
    assert three.profile != other.profile


def test_an_interval_needs_two_episodes():
    with pytest.raises(ValueError, match="give two at least"):
        measure(constant((0,) * 6), episodes=1)

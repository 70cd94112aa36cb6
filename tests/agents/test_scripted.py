import numpy as np
import pytest

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.agents.planner.tables import targets
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.kitchen.codes import RECIPES

CLASSIC = ("cramped_room", "asymmetric_advantages", "coordination_ring", "forced_coordination", "counter_circuit")
CONNECTED = ("cramped_room", "asymmetric_advantages", "coordination_ring", "counter_circuit", "bottleneck")
COURIERS = ("onion_courier", "dish_courier")
TOMATO_GRID = "XXPXX\nO  2O\nT1  X\nXDXSX"
SALAD = Layout.from_text(TOMATO_GRID, orders=[["tomato", "onion", "tomato"], ["onion"] * 3], soup_reward=[30, 20])


def play(layout, names, episodes=6, cooking="auto", seed=0, steps=400, states=None, **options):
    """Plays two scripted agents; gives the soup rewards (episodes,) and the joint actions (steps, episodes, 2)."""
    kitchens = Kitchens(layout, episodes, cooking=cooking, **options)
    kitchens.reset(seed)
    for i, state in enumerate(states or ()):
        kitchens.set_state(i, state)
    agents = [SCRIPTED[name].factory(layout) for name in names]
    for seat, agent in enumerate(agents):
        seeds = np.arange(episodes, dtype=np.uint64) * np.uint64(2) + np.uint64(seat)
        agent.reset(kitchens.layout.name, np.full(episodes, seat), seeds)
    rewards, played = np.zeros(episodes), []
    for _ in range(steps):
        seen = kitchens.observe("lossless26")
        played.append(np.stack([agent.act(seen[:, seat]) for seat, agent in enumerate(agents)], axis=1))
        rewards += kitchens.step(played[-1]).soup_reward.sum(axis=1)
    return rewards, np.array(played)


@pytest.mark.parametrize("cooking", ["auto", "manual"])
@pytest.mark.parametrize(
    "layout", [*CLASSIC, "bottleneck", "forced_coordination-mirrored", "coordination_ring-mirrored"]
)
def test_greedy_cooks_with_itself(layout, cooking):
    rewards, _ = play(layout, ("greedy", "greedy"), cooking=cooking)
    assert rewards.mean() >= 140
    assert rewards.min() >= 100


def workable(layout, stands, chef):
    """Whether a chef can cook alone while the other stands where it is: one part of the floor reaches everything."""
    part, edge = set(), [chef]
    while edge:
        x, y = edge.pop()
        if (x, y) in part or (x, y) == stands or layout.tile((x, y)) != " ":
            continue
        part.add((x, y))
        edge += [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)]
    faced = {layout.tile((x + dx, y + dy)) for x, y in part for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))}
    return set("POSD") <= faced


@pytest.mark.parametrize("seat", [0, 1])
@pytest.mark.parametrize("layout", CONNECTED)
def test_greedy_cooks_with_one_who_stays_wherever_that_is_possible(layout, seat):
    kitchens = Kitchens(layout, 20)
    kitchens.reset(0)
    chefs = [kitchens.state(i).chefs for i in range(20)]
    possible = [workable(kitchens.layout, chef[1 - seat].position, chef[seat].position) for chef in chefs]
    rewards, _ = play(layout, ("greedy", "stay") if seat == 0 else ("stay", "greedy"), episodes=20)
    assert any(possible)
    assert (rewards[possible] >= 20).all()
    assert (rewards[np.logical_not(possible)] == 0).all()


@pytest.mark.parametrize("names", [COURIERS, COURIERS[::-1]], ids="-".join)
@pytest.mark.parametrize("layout", CONNECTED)
def test_the_couriers_cook_together(layout, names):
    rewards, _ = play(layout, names)
    assert rewards.min() >= 60


@pytest.mark.parametrize("layout", CONNECTED)
def test_greedy_cooks_with_one_who_hinders_and_with_a_courier(layout):
    for other in ("random", *COURIERS):
        rewards, _ = play(layout, ("greedy", other))
        assert rewards.min() >= 20, other


@pytest.mark.parametrize("name", COURIERS)
def test_couriers_do_half_the_work_only(name):
    kitchens = Kitchens("cramped_room", 4, events=True)
    kitchens.reset(0)
    agents = [SCRIPTED[name].factory("cramped_room") for _ in range(2)]
    for seat, agent in enumerate(agents):
        agent.reset("cramped_room", np.full(4, seat), np.arange(4, dtype=np.uint64))
    held = set()
    for _ in range(200):
        seen = kitchens.observe("lossless26")
        kitchens.step(np.stack([agent.act(seen[:, seat]) for seat, agent in enumerate(agents)], axis=1))
        held |= {chef.holding for i in range(4) for chef in kitchens.state(i).chefs}
    assert held - {None} == ({"onion"} if name == "onion_courier" else {"dish"})


@pytest.mark.parametrize("cooking", ["auto", "manual"])
def test_greedy_cooks_the_best_paid_order(cooking):
    rewards, _ = play(SALAD, ("greedy", "greedy"), cooking=cooking)
    assert (rewards % 30 == 0).all()
    assert rewards.min() >= 180


def thing(random, kinds):
    kind = random.choice(kinds)
    if kind != "soup":
        return kind
    return Soup(RECIPES[random.integers(1, len(RECIPES))], 20, 20)


def clutter(layout, random):
    """Draws a legal state with anything in hands, on counters and in pots."""
    floor = layout.positions(" ")
    cells = random.choice(len(floor), 2, replace=False)
    kinds = ["onion", "tomato", "dish", "soup"]
    facings = random.choice(["north", "south", "east", "west"], 2)
    chefs = [
        Chef(floor[c], str(faces), thing(random, kinds) if random.random() < 0.8 else None)
        for c, faces in zip(cells, facings, strict=True)
    ]
    objects = {cell: thing(random, kinds) for cell in layout.positions("X") if random.random() < 0.5}
    for cell in layout.positions("P"):
        recipe = RECIPES[random.integers(0, len(RECIPES))]
        if sum(recipe):
            objects[cell] = Soup(recipe, int(random.integers(0, 21)), 20) if random.random() < 0.5 else Soup(recipe)
    return KitchenState((chefs[0], chefs[1]), objects)


@pytest.mark.parametrize("cooking", ["auto", "manual"])
@pytest.mark.parametrize("layout", [*CLASSIC, "bottleneck", SALAD], ids=str)
def test_any_legal_state_is_played(layout, cooking):
    random = np.random.default_rng(1)
    plan = Layout.load(layout)
    states = [clutter(plan, random) for _ in range(40)]
    for names in (("greedy", "greedy"), COURIERS, ("random", "greedy")):
        _, actions = play(layout, names, 40, cooking, steps=60, states=states)
        assert set(np.unique(actions)) <= set(range(6))


@pytest.mark.parametrize("cooking", ["auto", "manual"])
@pytest.mark.parametrize("layout", ["cramped_room", "counter_circuit", SALAD], ids=str)
def test_greedy_clears_up_what_others_left(layout, cooking):
    random = np.random.default_rng(2)
    states = [clutter(Layout.load(layout), random) for _ in range(20)]
    rewards, _ = play(layout, ("greedy", "greedy"), 20, cooking, states=states)
    assert np.mean(rewards > 0) >= 0.9


def test_starts_with_objects_are_played_well():
    rewards, _ = play("coordination_ring", ("greedy", "greedy"), object_probability=1.0)
    assert rewards.min() >= 100


@pytest.mark.parametrize("name", SCRIPTED)
def test_a_row_plays_the_same_in_every_batch(name):
    random = np.random.default_rng(0)
    seeds = random.integers(0, 2**63, 5).astype(np.uint64)
    seats = np.array([0, 1, 0, 1, 1])
    kitchens = Kitchens("coordination_ring", 5, object_probability=0.5)
    kitchens.reset(3)
    together, alone = SCRIPTED[name].factory("coordination_ring"), SCRIPTED[name].factory("coordination_ring")
    together.reset("coordination_ring", seats, seeds)
    alone.reset("coordination_ring", seats[3:4], seeds[3:4])
    rows = np.arange(5)
    for _ in range(120):
        seen = kitchens.observe("lossless26")[rows, seats]
        actions = together.act(seen)
        assert alone.act(seen[3:4])[0] == actions[3]
        joint = random.integers(0, 6, (5, 2))
        joint[rows, seats] = actions
        kitchens.step(joint)


def test_a_second_game_is_played_like_the_first():
    first, again = (play("coordination_ring", ("greedy", "greedy"), 3, steps=100)[1] for _ in range(2))
    assert (first == again).all()


def test_a_planner_goes_on_in_the_layout_that_reset_names():
    agent = SCRIPTED["greedy"].factory("cramped_room")
    agent.reset("counter_circuit-mirrored", np.zeros(1, int), np.zeros(1, np.uint64))
    assert agent.act(Kitchens("counter_circuit-mirrored", 1).observe("lossless26")[:, 0]).shape == (1,)


def test_wrong_use_is_explained():
    agent = SCRIPTED["greedy"].factory("cramped_room")
    agent.reset("cramped_room", np.zeros(2, int), np.zeros(2, np.uint64))
    with pytest.raises(ValueError, match=r"\(3, 26, 4, 5\)"):
        agent.act(np.zeros((3, 26, 4, 5), np.uint8))


def test_targets_lead_to_the_best_order_or_to_a_full_pot():
    rewards = [0.0] * len(RECIPES)
    rewards[RECIPES.index((3, 0))] = 20
    rewards[RECIPES.index((0, 2))] = 30
    wanted = targets(rewards, onions=True, tomatoes=True)
    assert wanted[0, 0].tolist() == [0, 2]
    assert wanted[1, 0].tolist() == [3, 0]
    assert wanted[0, 1].tolist() == [0, 2]
    assert wanted[1, 1].tolist() == [2, 1]
    assert targets(rewards, onions=True, tomatoes=False)[0, 0].tolist() == [3, 0]
    assert targets(rewards, onions=False, tomatoes=True)[1, 0].tolist() == [1, 2]

"""What `set_state`, `from_dict` and layouts refuse, and that the kitchen is unchanged then."""

import copy
import time

import pytest

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, LayoutError, Soup
from overcooked_bench.kitchen.errors import StateError

GRID = "XXPXX\nO  2O\nX1  X\nXDXSX"
TWO = (Chef((1, 1)), Chef((2, 1)))


@pytest.mark.parametrize(
    ("state", "message"),
    [
        (KitchenState((Chef((1, 1)), Chef((2, 1)), Chef((3, 1)))), "give two"),
        (KitchenState((Chef((1, 1)),)), "give two"),
        (KitchenState((Chef((1.5, 1)), Chef((2, 1)))), "whole numbers"),
        (KitchenState((Chef((True, 1)), Chef((2, 1)))), "whole numbers"),
        (KitchenState(TWO, timestep=1.5), "timestep 1.5"),
        (KitchenState((Chef((0, 0)), Chef((2, 1)))), "chef 0 stands at"),
        (KitchenState((Chef((1, 1)), Chef((1, 1)))), "both chefs"),
        (KitchenState((Chef((1, 1), "up"), Chef((2, 1)))), "faces 'up'"),
        (KitchenState(TWO, {(2, 0): "onion"}), "soups in pots"),
        (KitchenState(TWO, {(1, 1): "onion"}), "objects are on counters"),
        (KitchenState(TWO, {(9, 9): "onion"}), "outside"),
        (KitchenState(TWO, {(2, 0): Soup((4, 0))}), "one to three"),
        (KitchenState(TWO, {(2, 0): Soup((3, 0), -2)}), "tick -2"),
        (KitchenState(TWO, {(0, 0): Soup((3, 0))}), "always finished"),
        (KitchenState(TWO, timestep=401), "horizon is 400"),
        (KitchenState(TWO, orders=((1, 0),)), "orders"),
    ],
)
def test_a_state_that_is_not_legal_changes_nothing(state, message):
    kitchens = Kitchens(GRID, 1)
    before = kitchens.state(0)
    with pytest.raises(ValueError, match=message):
        kitchens.set_state(0, state)
    assert kitchens.state(0) == before


@pytest.mark.parametrize("index", [-1, 2])
def test_there_is_no_such_kitchen(index):
    with pytest.raises(IndexError, match="there are kitchens 0 to 1"):
        Kitchens(GRID, 2).state(index)


SOUP = {"name": "soup", "_ingredients": [{"name": "onion"}], "_cooking_tick": 3, "cook_time": 20}


def nested(depth):
    value = []
    for _ in range(depth):
        value = [value]
    return value


def broken(change):
    data = copy.deepcopy(KitchenState(TWO, {(0, 0): "onion"}, orders=((3, 0),)).to_dict())
    change(data)
    return data


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d["objects"].append(d["objects"][0]), "same cell"),
        (lambda d: d["all_orders"].append({"ingredients": ["leek"]}), "leek"),
        (lambda d: d["players"][0].update(orientation=[1, 1]), "orientation"),
        (lambda d: d["players"].pop(), "1 players"),
        (lambda d: d.pop("players"), "players"),
        (lambda d: d["objects"][0].update(name="leek"), "an object is named"),
        (lambda d: d["players"][0].update(position=[float("inf"), 1]), "x of a position is inf; give a whole number"),
        (lambda d: d["players"][0].update(orientation=[0, float("inf")]), "y of an orientation is inf"),
        (lambda d: d.update(timestep=float("inf")), "timestep is inf"),
        (lambda d: d.update(timestep=True), "timestep is True"),
        (lambda d: d.update(timestep=10**5000), "timestep is a value of the type int"),
        (lambda d: d["players"][0].update(position=[1.9, 1]), "x of a position is 1.9"),
        (lambda d: d["players"][0].update(position=[True, 1]), "x of a position is True"),
        (lambda d: d["players"][0].update(position="12"), "a position is '12'; give two whole numbers"),
        (lambda d: d["players"][0].update(position=nested(5000)), "a position is"),
        (lambda d: d["objects"][0].update(position=nested(5000)), "a position is a value of the type list"),
        (lambda d: d["objects"][0].update(name=nested(5000)), "an object is named a value of the type list"),
        (lambda d: d["objects"][0].update(SOUP | {"_cooking_tick": float("inf")}), "cooking tick is inf"),
        (lambda d: d["objects"][0].update(SOUP | {"cook_time": 1.5}), "cook time is 1.5"),
        (lambda d: d["objects"].append(nested(5000)), "not a state in overcooked_ai's JSON form"),
        (lambda d: d.pop("players"), "the entry 'players' is missing"),
    ],
)
def test_a_dict_that_is_no_state_is_told(change, message):
    with pytest.raises(StateError, match=message):
        KitchenState.from_dict(broken(change))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"orders": None}, "orders is None"),
        ({"orders": [["onion"] * 3, ["onion"] * 3]}, "twice"),
        ({"bonus_orders": [["onion"]]}, "not all among the orders"),
        ({"orders": [["onion"] * 3, 1]}, "orders holds 1; write one to three"),
        ({"orders": [[["onion"]]]}, "orders holds"),
        ({"order_bonus": "x"}, "order_bonus is 'x'"),
        ({"order_bonus": float("inf")}, "order_bonus is inf"),
        ({"soup_reward": float("inf")}, "soup_reward is inf; give a finite number"),
        ({"soup_reward": 10**400}, "soup_reward is 1000"),
        ({"soup_reward": {1: 2, "onion": 3}}, "give both 'onion' and 'tomato'"),
        ({"cook_time": 10**5000}, "cook_time is a value of the type int"),
        ({"cook_time": {"onion": 1, "tomato": 10**5000}}, r"cook_time\['tomato'\] is a value"),
        ({"soup_reward": float("nan")}, "soup_reward"),
        ({"cook_time": float("inf")}, "cook_time"),
        ({"cook_time": {"onion": "a", "tomato": 1}}, r"cook_time\['onion'\]"),
    ],
)
def test_a_menu_that_is_not_legal_is_told(options, message):
    with pytest.raises(LayoutError, match=message):
        Layout.from_text(GRID, **options)


def test_files_that_are_no_layouts_are_told(tmp_path):
    (tmp_path / "a.layout").write_text(GRID + "\n---\norders: [\n")
    with pytest.raises(LayoutError, match="not YAML"):
        Layout.load(tmp_path / "a.layout")
    (tmp_path / "b.layout").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(LayoutError, match="not a text file"):
        Layout.load(tmp_path / "b.layout")


@pytest.mark.parametrize("grid", ["X" * 10_000_000, "X\n" * 5_000_000, "X" * 70_000])
def test_a_grid_of_millions_is_refused_at_once(grid):
    began = time.perf_counter()
    with pytest.raises(LayoutError, match="characters; at most 65,536 are read"):
        Layout.from_text(grid)
    assert time.perf_counter() - began < 0.5


def test_a_grid_is_a_text():
    with pytest.raises(LayoutError, match="the grid is 5"):
        Layout.from_text(5)

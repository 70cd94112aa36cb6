"""What `set_state`, `from_dict` and layouts refuse, and that the kitchen is unchanged then."""

import copy

import pytest

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, LayoutError, Soup

GRID = "XXPXX\nO  2O\nX1  X\nXDXSX"
TWO = (Chef((1, 1)), Chef((2, 1)))


@pytest.mark.parametrize(
    ("state", "message"),
    [
        (KitchenState((Chef((1, 1)), Chef((2, 1)), Chef((3, 1)))), "give two"),
        (KitchenState((Chef((1, 1)),)), "give two"),
        (KitchenState((Chef((1.5, 1)), Chef((2, 1)))), "whole numbers"),
        (KitchenState((Chef((0, 0)), Chef((2, 1)))), "chef 0 stands at"),
        (KitchenState((Chef((1, 1)), Chef((1, 1)))), "both chefs"),
        (KitchenState((Chef((1, 1), "up"), Chef((2, 1)))), "faces 'up'"),
        (KitchenState(TWO, {(2, 0): "onion"}), "soups in pots"),
        (KitchenState(TWO, {(1, 1): "onion"}), "things lie on counters"),
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
    ],
)
def test_a_dict_that_is_no_state_is_told(change, message):
    with pytest.raises(ValueError, match=message):
        KitchenState.from_dict(broken(change))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"orders": None}, "orders is None"),
        ({"orders": [["onion"] * 3, ["onion"] * 3]}, "twice"),
        ({"bonus_orders": [["onion"]]}, "not all among the orders"),
        ({"order_bonus": "x"}, "order_bonus"),
        ({"soup_reward": float("nan")}, "soup_reward"),
        ({"cook_time": float("inf")}, "cook_time"),
        ({"cook_time": {"onion": "a", "tomato": 1}}, "cook_time"),
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

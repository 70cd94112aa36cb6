"""Layouts: grids are read and checked, menus take three forms, names and mirror images are found."""

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Layout, LayoutError
from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.layout import layout_names
from tests.kitchen.strategies import ingredients, law, layouts

GOOD = "XXPXX\nO  2O\nX1  X\nXDXSX"


def prices(layout: Layout) -> dict[tuple[int, int], float]:
    return {recipe: price for recipe, price in zip(RECIPES, layout.soup_rewards, strict=True) if price}


def test_a_grid_is_read():
    layout = Layout.from_text(GOOD)
    assert layout.rows == ("XXPXX", "O   O", "X   X", "XDXSX")
    assert layout.start_cells == ((1, 2), (3, 1))
    assert (layout.width, layout.height, layout.text, layout.name) == (5, 4, GOOD, GOOD)
    assert layout.tile((2, 0)) == "P"
    assert layout.positions("OD") == [(0, 1), (4, 1), (1, 3)]
    assert not layout.has_tomatoes


def test_indentation_blank_lines_and_trailing_spaces_do_not_matter():
    indented = "\n\n    XXPXX  \n    O  2O\r\n    X1  X\n    XDXSX\n   \n"
    assert Layout.from_text(indented) == Layout.from_text(GOOD)


def test_digits_may_be_left_out():
    layout = Layout.from_text(GOOD.replace("1", " ").replace("2", " "))
    assert layout.start_cells == ()
    Kitchens(layout, 1, start="random")
    with pytest.raises(
        ValueError, match="the grid names no start cells; mark two with the digits 1 and 2, or use 'random'"
    ):
        Kitchens(layout, 1, start="standard")


BAD_GRIDS = [
    ("", "the grid is empty; write rows such as"),
    ("  \n \n", "the grid is empty"),
    ("XXPXX\nO  2O\nX1 X\nXDXSX", "row 3: 4 tiles where row 1 has 5; every row needs the same length"),
    ("XXPXX\nO  2OX\nX1  X\nXDXSX", "row 2: 6 tiles where row 1 has 5"),
    ("XXPXX\nO ?2O\nX1  X\nXDXSX", r"row 2, column 3: unknown tile '\?'; tiles are X P O T D S, space for floor"),
    ("XXPXX\nO  3O\nX1  X\nXDXSX", "row 2, column 4: unknown tile '3'"),
    ("XX XX\nO  2O\nX1  P\nXDXSX", r"row 1, column 3: floor on the border; close it with a counter \(X\)"),
    ("XXPXX\n1  2O\nX   X\nXDXSX", "row 2, column 1: floor on the border"),
    ("XXPXX\nO  2O\nX2  X\nXDXSX", "row 3, column 2: a second start cell for chef 2; use each digit once"),
    ("XXPXX\nO   O\nX1  X\nXDXSX", "only chef 1 has a start cell; mark both with 1 and 2, or neither"),
    ("XXPXX\nO  2O\nX   X\nXDXSX", "only chef 2 has a start cell"),
    ("XXXXX\nO  2O\nX1  X\nXDXSX", r"the grid has no pot \(P\); put one in reach of the floor"),
    ("XXPXX\nO  2O\nX1  X\nXXXSX", r"the grid has no dish dispenser \(D\)"),
    ("XXPXX\nO  2O\nX1  X\nXDXXX", r"the grid has no serving tile \(S\)"),
    ("PXXXX\nO  2O\nX1  X\nXDXSX", r"row 1, column 1: no floor cell is next to the pot \(P\), so no chef reaches it"),
    ("XXPXX\nX  2X\nX1  X\nXDXSX", "no order can be cooked: the grid has no ingredient dispenser; add the dispensers"),
    ("XXPXX\nT  2X\nX1  X\nXDXSX", "no order can be cooked: the grid has tomato dispensers"),
    ("OXPXX\nX  2X\nX1  X\nXDXSX", r"row 1, column 1: no floor cell is next to the onion dispenser \(O\)"),
    ("XOX\nP D\nXSX", "two chefs need at least two floor cells"),
    ("XOXXX\nP1D2X\nXXXSX", "no useful work is possible from the start cells"),
    ("XOXXX\nP D X\nXXXSX", "no useful work is possible: no one or two regions of the floor"),
    ("X" * 100 + ("\n" + "X" * 100) * 50, "the grid has 5100 cells; at most 4096 are supported"),
]


@pytest.mark.parametrize(("grid", "message"), BAD_GRIDS, ids=[message[:70] for _, message in BAD_GRIDS])
def test_a_bad_grid_is_refused_where_it_is_bad(grid, message):
    with pytest.raises(LayoutError, match=message):
        Layout.from_text(grid)


TOMATO = "XTPXX\nO  2O\nX1  X\nXDXSX"


def test_one_reward_and_time_for_all():
    layout = Layout.from_text(TOMATO, orders=[["onion"] * 3, ["tomato"]], soup_reward=15, cook_time=7)
    assert prices(layout) == {(3, 0): 15, (0, 1): 15}
    assert set(layout.cook_times) == {7}


def test_rewards_and_times_by_ingredient():
    by = {"soup_reward": {"onion": 5, "tomato": 7}, "cook_time": {"onion": 3, "tomato": 4}}
    layout = Layout.from_text(TOMATO, orders=[["onion"] * 3, ["tomato", "onion"]], **by)
    assert prices(layout) == {(3, 0): 15, (1, 1): 12}
    assert [layout.cook_times[RECIPES.index(r)] for r in ((1, 0), (0, 3), (1, 1))] == [3, 12, 7]


def test_rewards_and_times_by_order_with_20_for_the_rest():
    orders = [["onion"] * 3, ["tomato", "onion"]]
    layout = Layout.from_text(TOMATO, orders=orders, soup_reward=[9, 4], cook_time=[30, 10])
    assert prices(layout) == {(3, 0): 9, (1, 1): 4}
    assert [layout.cook_times[RECIPES.index(r)] for r in ((3, 0), (1, 1), (2, 0))] == [30, 10, 20]


def test_a_soup_is_worth_the_cheapest_paid_order():
    assert Layout.load("cramped_room").soup_points == 20
    orders = [["onion"] * 3, ["tomato"]]
    assert Layout.from_text(TOMATO, orders=orders, soup_reward=[30, 10]).soup_points == 10
    assert Layout.from_text(TOMATO, orders=orders, soup_reward=[30, 0]).soup_points == 30


def test_an_empty_menu_means_all_nine_recipes():
    layout = Layout.from_text(TOMATO, orders=[])
    assert prices(layout) == dict.fromkeys(RECIPES[1:], 20)
    assert layout.orders == RECIPES[1:]


def test_bonus_orders_pay_more():
    orders = [["onion"] * 3, ["tomato", "onion"]]
    layout = Layout.from_text(TOMATO, orders=orders, bonus_orders=[["onion", "tomato"]], order_bonus=2.5)
    assert prices(layout) == {(3, 0): 20, (1, 1): 50}
    assert layout.bonus_orders == ((1, 1),)


@pytest.mark.parametrize(
    ("menu", "message"),
    [
        ({"orders": [["onion"] * 4]}, "orders holds .*; write one to three of 'onion' and 'tomato'"),
        ({"orders": [[]]}, r"orders holds \[\]"),
        ({"orders": [["leek"]]}, "orders holds .*leek"),
        ({"bonus_orders": [["leek"]]}, "bonus_orders holds .*leek"),
        ({"soup_reward": {"onion": 3}}, r"soup_reward has the keys \['onion'\]; give both 'onion' and 'tomato'"),
        ({"soup_reward": [1, 2]}, "soup_reward has 2 numbers for 1 orders; give one for each"),
        ({"soup_reward": "much"}, "soup_reward is 'much'; give a finite number"),
        ({"soup_reward": True}, "soup_reward is True"),
        ({"cook_time": [1, 2]}, "cook_time has 2 numbers for 1 orders"),
        ({"cook_time": 255}, "cook_time makes 255 steps .*; give whole numbers from 1 to 254"),
        ({"cook_time": 0}, "cook_time makes 0 steps"),
        ({"cook_time": 2.5}, "cook_time makes 2.5 steps"),
        ({"cook_time": {"onion": 100, "tomato": 1}}, "cook_time makes 300 steps for 3 onions and 0 tomatoes"),
    ],
)
def test_a_bad_menu_is_refused(menu, message):
    with pytest.raises(LayoutError, match=message):
        Layout.from_text(GOOD, **menu)


def test_automatic_cooking_refuses_orders_that_it_can_never_cook():
    short = Layout.from_text(GOOD, orders=[["onion"] * 2])
    Kitchens(short, 1, cooking="manual")
    with pytest.raises(ValueError, match=r"cooking='auto' starts a pot at its third ingredient.*use cooking='manual'"):
        Kitchens(short, 1, cooking="auto")


@pytest.mark.parametrize("name", layout_names())
def test_every_shipped_layout_loads_and_keeps_its_name(name):
    layout = Layout.load(name)
    assert layout.name == name
    assert len(layout.start_cells) == 2
    assert layout.orders == ((3, 0),)
    assert Layout.load(layout) is layout


def test_the_classic_layouts_come_first():
    classic = ("cramped_room", "asymmetric_advantages", "coordination_ring", "forced_coordination", "counter_circuit")
    assert layout_names()[:5] == classic


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("cramped_rom", "no layout named 'cramped_rom'; did you mean 'cramped_room'"),
        ("forced_cordination-mirrored", "did you mean 'forced_coordination'"),
        ("kitchen/of/nobody.layout", "the path of a .layout file or a grid of several lines will do too"),
        ("zzzz", "no layout named 'zzzz'; Shipped are cramped_room, asymmetric_advantages"),
    ],
)
def test_an_unknown_name_is_answered_with_the_nearest(asked, message):
    with pytest.raises(LayoutError, match=message):
        Layout.load(asked)


def test_a_file_is_read_with_its_menu_below_the_grid(tmp_path):
    path = tmp_path / "soup.layout"
    path.write_text(
        TOMATO + "\n---\norders: [[onion, tomato, onion], [tomato]]\nbonus_orders: [[tomato]]\n"
        "order_bonus: 3\nsoup_reward: {onion: 4, tomato: 5}\ncook_time: [9, 5]\n"
    )
    by_path, by_text = Layout.load(path), Layout.load(str(path))
    assert by_path == by_text
    assert prices(by_path) == {(2, 1): 13, (0, 1): 15}
    assert by_path.cook_times[RECIPES.index((2, 1))] == 9
    assert by_path.start_cells == ((1, 2), (3, 1))


def test_a_file_may_hold_a_grid_alone(tmp_path):
    path = tmp_path / "plain.layout"
    path.write_text(GOOD + "\n")
    assert Layout.load(path) == Layout.from_text(GOOD)


BOMB = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]\n" for i in range(1, 10)
)


@pytest.mark.parametrize(
    ("menu", "line", "message"),
    [
        ("price: 3", 1, "unknown key `price`; .*keys are orders, "),
        ("- onion", 1, "not a mapping"),
        ("orders: []\nname: mine", 2, "unknown key `name`"),
        (f"{BOMB}orders: *a9", 1, "references"),
        ("soup_reward: .inf", 1, ".inf is not a finite number"),
        ("soup_reward: !!bool x", 1, "the tag"),
        ("orders: " + "[" * 1000, 1, "more than 8"),
        ("orders: \0", 1, "the character"),
    ],
)
def test_a_menu_that_is_wrong_is_refused_with_its_line(tmp_path, menu, line, message):
    path = tmp_path / "odd.layout"
    path.write_text(f"{GOOD}\n---\n{menu}\n")
    with pytest.raises(LayoutError, match=rf"odd\.layout:{GOOD.count(chr(10)) + 2 + line}: {message}"):
        Layout.load(path)


@pytest.mark.parametrize("name", ["x" * 300, "/proc/self/mem", "/dev/zero", "a\0b", "x" + "-mirrored" * 2000])
def test_what_is_no_layout_file_is_refused(name):
    with pytest.raises(LayoutError):
        Layout.load(name)


@pytest.mark.parametrize("name", layout_names())
def test_mirrored_names_go_both_ways(name):
    layout, mirror = Layout.load(name), Layout.load(f"{name}-mirrored")
    assert mirror.name == f"{name}-mirrored"
    assert mirror.rows == tuple(row[::-1] for row in layout.rows)
    assert mirror.mirrored() == layout
    assert Layout.load(f"{name}-mirrored-mirrored") == layout


@law
@given(st.booleans().flatmap(lambda digits: layouts(start_cells=digits)))
def test_a_grids_mirror_image_is_a_grid_and_back(layout):
    mirror = layout.mirrored()
    assert mirror.name == mirror.text
    assert mirror.mirrored() == layout
    assert (mirror.orders, mirror.soup_rewards, mirror.cook_times) == (
        layout.orders,
        layout.soup_rewards,
        layout.cook_times,
    )
    again = Layout.from_text(mirror.text, orders=[ingredients(order) for order in layout.orders])
    assert (again.rows, again.start_cells) == (mirror.rows, mirror.start_cells)


@law
@given(layouts())
def test_regions_are_the_connected_parts_of_the_floor(layout):
    numbers = layout.regions
    assert list(numbers) == [] or set(numbers) == set(layout.positions(" "))
    firsts = [min(c[::-1] for c in numbers if numbers[c] == k) for k in range(max(numbers.values()) + 1)]
    assert firsts == sorted(firsts)
    for x, y in numbers:
        for neighbour in ((x + 1, y), (x, y + 1)):
            assert neighbour not in numbers or numbers[neighbour] == numbers[x, y]
    reached = {cell: {cell} for cell in numbers}
    for _ in numbers:
        for x, y in numbers:
            for neighbour in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                reached[x, y] |= reached.get(neighbour, set())
    assert all(numbers[a] != numbers[b] or b in reached[a] for a in numbers for b in numbers)


@pytest.mark.parametrize(
    ("grid", "pairs"),
    [
        ("XXPXX\nO   O\nX   X\nXDXSX", {(0, 0)}),
        ("XXXPX\nO X P\nO X X\nD X X\nXXXSX", {(0, 1), (1, 0)}),
        ("XXXXXXXXX\nO XSXOX S\nX   P   X\nX   P   X\nXXXDXDXXX", {(0, 1), (1, 0)}),
        ("XXPXXXX\nO   X X\nX   X X\nXDXSXXX", {(0, 0), (0, 1), (1, 0)}),
        ("XPXXX\nO X X\nX X X\nXDXSX", {(0, 1), (1, 0)}),
    ],
    ids=["one room", "two half kitchens", "two whole kitchens", "a room and a cell", "served from next door"],
)
def test_which_regions_a_random_start_may_use(grid, pairs):
    layout = Layout.from_text(grid)
    apart = {(a, b) for a, b in pairs if a != b}
    assert set(map(tuple, np.argwhere(layout.start_regions).tolist())) == (apart or pairs)


def lone_cells(side: int) -> str:
    """A kitchen whose floor is lone cells, one of which has all that a soup needs."""
    rows = [["X"] * side for _ in range(side)]
    for y in range(1, side - 1, 2):
        rows[y][1 : side - 1 : 2] = " " * ((side - 1) // 2)
    rows[0][1], rows[1][0], rows[1][2], rows[2][1] = "ODPS"
    return "\n".join("".join(row) for row in rows)


def test_hundreds_of_regions_take_no_time():
    began = time.perf_counter()
    layout = Layout.from_text(lone_cells(63))
    kitchens = Kitchens(layout, 2)
    kitchens.reset(seed=0)
    assert time.perf_counter() - began < 2
    assert layout.start_regions.shape == (961, 961)
    assert layout.start_regions.sum() == 2 * 960
    sides = [[layout.regions[chef.position] for chef in kitchens.state(i).chefs] for i in range(2)]
    assert all(0 in pair and len(set(pair)) == 2 for pair in sides)


@law
@given(layouts())
def test_a_random_start_is_allowed_where_a_soup_can_be_made_of_what_is_reached(layout):
    """Said again in the plainest way: two chefs, what they face, and counters that both face."""

    def beside(x, y):
        return {layout.regions[c] for c in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)) if c in layout.regions}

    faced = {tile: [beside(*cell) for cell in layout.positions(tile)] for tile in "XPODST"}
    kinds = [[letter for letter, n in zip("OT", order, strict=True) if n] for order in layout.orders]

    def able(a, b):
        hand_over = any({a, b} <= near for near in faced["X"])

        def has(chef, tile):
            return any(chef in near or (near & {a, b} and hand_over) for near in faced[tile])

        for pot in faced["P"]:
            cooks = pot & {a, b}
            filled = any(all(any(has(chef, letter) for chef in cooks) for letter in letters) for letters in kinds)
            if cooks and filled and any(has(chef, "D") and has(chef, "S") for chef in cooks):
                return True
        return False

    numbers = set(layout.regions.values())
    apart = {(a, b) for a in numbers for b in numbers if a != b and able(a, b)}
    roomy = {(a, a) for a in numbers if able(a, a) and list(layout.regions.values()).count(a) > 1}
    assert set(map(tuple, np.argwhere(layout.start_regions).tolist())) == (apart or roomy)


def test_a_random_start_puts_one_chef_in_each_region_even_a_helpless_one_where_a_soup_is_possible():
    layout = Layout.from_text("XXPXXXX\nO   X X\nX   X X\nXDXSXXX")
    kitchens = Kitchens(layout, 50)
    kitchens.reset(seed=1)
    sides = np.array([[layout.regions[chef.position] for chef in kitchens.state(i).chefs] for i in range(50)])
    assert (sides.sum(axis=1) == 1).all()

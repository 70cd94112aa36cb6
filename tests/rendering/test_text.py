import re

import pytest
from hypothesis import given

from overcooked_bench import Chef, KitchenState, Layout, Soup
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.rendering.text import film, side_by_side
from tests.rendering.scenes import TOMATO_KITCHEN, neighbours, some_state, states


def without_colours(text):
    return re.sub(r"\x1b\[[0-9;]*m", "", text)


@given(states())
def test_colours_only_colour(state):
    plain, coloured = film(TOMATO_KITCHEN, state, colour=False), film(TOMATO_KITCHEN, state)
    assert plain.isascii()
    assert "\x1b" not in plain
    assert without_colours(coloured) == plain != coloured


@given(states())
def test_rows_are_aligned(state):
    rows = film(TOMATO_KITCHEN, state, colour=False, legend=False).splitlines()
    assert [len(row) for row in rows] == [3 * TOMATO_KITCHEN.width] * TOMATO_KITCHEN.height


@given(neighbours())
def test_whatever_differs_can_be_read(pair):
    one, other = (film(TOMATO_KITCHEN, state, colour=False) for state in pair)
    assert one != other


@pytest.mark.parametrize("name", layout_names())
def test_every_shipped_kitchen_can_be_read(name):
    layout = Layout.load(name)
    rows = film(layout, some_state(layout), colour=False, legend=False).splitlines()
    assert {len(row) for row in rows} == {3 * layout.width}
    assert "".join(rows).count("<O>") == len(layout.positions("O"))


def test_an_example():
    layout = Layout.load("cramped_room")
    chefs = Chef((1, 2), "north", "onion"), Chef((3, 1), "west")
    state = KitchenState(chefs, {(2, 0): Soup((3, 0), 8, 20), (0, 3): "dish", (4, 2): Soup((3, 0), 20, 20)}, 57)
    assert film(layout, state, colour=False).splitlines() == [
        "######~12######",
        "<O>      1< <O>",
        "###0^o      #s#",
        "#d#<D>###<S>###",
        "step 57   0^ onion   1< nothing",
        "pot (2, 0): 3 onions, 12 steps to go",
        "dish (4, 2): 3 onions",
    ]


def test_pictures_lie_side_by_side():
    pictures = ["a\nbb", "\x1b[1mcc\x1b[0m", "d"]
    assert side_by_side(pictures) == "a    \x1b[1mcc\x1b[0m   d\nbb"
    assert side_by_side(pictures, width=7) == "a    \x1b[1mcc\x1b[0m\nbb\n\nd"
    assert side_by_side(pictures, width=1).count("\n\n") == 2
    assert side_by_side([]) == ""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Chef, KitchenState, Layout, Soup
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.rendering.caption import caption_height
from overcooked_bench.rendering.picture import draw
from overcooked_bench.rendering.poster import poster
from tests.rendering.scenes import TOMATO_KITCHEN, neighbours, some_state, states

quick = settings(deadline=None)


@pytest.mark.parametrize("name", layout_names())
@pytest.mark.parametrize("tile_size", [8, 20, 33, 48])
def test_a_picture_has_a_tile_for_each_cell(name, tile_size):
    layout = Layout.load(name)
    image = draw(layout, some_state(layout), tile_size=tile_size)
    assert image.shape == (layout.height * tile_size, layout.width * tile_size, 3)
    assert image.dtype == np.uint8


def test_a_caption_adds_one_line_and_leaves_the_kitchen_as_it_is():
    layout = Layout.load("cramped_room")
    state = some_state(layout)
    plain, captioned = draw(layout, state), draw(layout, state, caption="step 7   20 points")
    assert captioned.shape[0] == plain.shape[0] + caption_height(48)
    assert np.array_equal(captioned[: plain.shape[0]], plain)
    assert not np.array_equal(captioned, draw(layout, state, caption="step 8   20 points"))


@pytest.mark.parametrize("names", [None, ("greedy", "an agent with quite a long name")])
@pytest.mark.parametrize("tile_size", [8, 20, 64])
def test_a_caption_that_is_too_long_still_fits(names, tile_size):
    layout = Layout.from_text("XPSX\nO12D\nXXXX")
    image = draw(layout, some_state(layout), tile_size=tile_size, caption="step 399   1000 points", names=names)
    assert image.shape == (3 * tile_size + caption_height(tile_size), 4 * tile_size, 3)


@quick
@given(states(), st.sampled_from([20, 48]))
def test_the_same_state_gives_the_same_picture_in_an_array_of_its_own(state, tile_size):
    first = draw(TOMATO_KITCHEN, state, tile_size=tile_size)
    kept = first.copy()
    first[:] = 0
    assert np.array_equal(draw(TOMATO_KITCHEN, state, tile_size=tile_size), kept)


@quick
@given(neighbours(), st.sampled_from([(20, 1), (48, 8)]))
def test_whatever_differs_can_be_seen(pair, size):
    tile_size, pixels = size
    one, other = (draw(TOMATO_KITCHEN, state, tile_size=tile_size) for state in pair)
    assert (np.abs(one.astype(int) - other) > 20).any(axis=2).sum() >= pixels


@pytest.mark.parametrize("remaining", [1, 7, 20])
def test_a_soup_without_a_cook_time_takes_the_layouts(remaining):
    layout = Layout.load("cramped_room")
    state = some_state(layout)
    pot = layout.positions("P")[0]
    told = replace(state, objects={pot: Soup((3, 0), 20 - remaining, 20)})
    untold = replace(state, objects={pot: Soup((3, 0), 20 - remaining)})
    assert np.array_equal(draw(layout, told), draw(layout, untold))


def test_every_tile_looks_different():
    image = draw(TOMATO_KITCHEN, KitchenState((Chef((2, 2)), Chef((3, 2)))), tile_size=24)
    tiles = {}
    for letter in "XPOTDS ":
        x, y = TOMATO_KITCHEN.positions(letter)[-1]
        tiles[letter] = image[24 * y : 24 * y + 24, 24 * x : 24 * x + 24].tobytes()
    assert len(set(tiles.values())) == len(tiles)


def test_a_large_kitchen_is_drawn_whole():
    grid = ["X" * 60, "O" + " " * 58 + "D", *["X" + " " * 58 + "X"] * 36, "X" * 30 + "PS" + "X" * 28]
    layout = Layout.from_text("\n".join(grid))
    assert draw(layout, some_state(layout), tile_size=8).shape == (39 * 8, 60 * 8, 3)


def test_wrong_use_is_told():
    layout = Layout.load("cramped_room")
    with pytest.raises(ValueError, match="tile_size=4; give at least 8"):
        draw(layout, some_state(layout), tile_size=4)
    with pytest.raises(ValueError, match=r"something at \(7, 1\); the layout is 5 x 4 cells"):
        draw(layout, KitchenState((Chef((7, 1)), Chef((1, 1)))))
    with pytest.raises(ValueError, match="at least one kitchen"):
        poster([])


def test_a_poster_holds_every_kitchen():
    layouts = [Layout.load(name) for name in layout_names()[:5]]
    kitchens = [(layout, some_state(layout)) for layout in layouts]
    image = poster(kitchens, tile_size=20)
    for layout, state in kitchens:
        kitchen = draw(layout, state, tile_size=20)
        windows = np.lib.stride_tricks.sliding_window_view(image, (1, kitchen.shape[1], 3))[:, :, 0, 0]
        assert (windows == kitchen[50]).all(axis=(2, 3)).any(), layout.name
    assert image.shape[1] < poster(kitchens, columns=5, tile_size=20).shape[1]


def test_the_module_is_light():
    heavy = "import sys, overcooked_bench.rendering.picture; print({'PIL', 'numba', 'torch'} & set(sys.modules))"
    run = subprocess.run([sys.executable, "-c", heavy], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "set()"

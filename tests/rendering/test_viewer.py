"""Games in a page: what `kitchen.js` is given, and how it draws and plays that in a browser."""

import json
from base64 import b64decode
from io import BytesIO

import numpy as np
import pytest
from hypothesis import given
from PIL import Image

from overcooked_bench import Chef, KitchenState, Layout, Soup
from overcooked_bench.rendering.picture import draw
from overcooked_bench.rendering.replay import frames_of
from overcooked_bench.rendering.viewer.games import pack_game, player, save_page
from tests.rendering.scenes import TOMATO_KITCHEN, neighbours, played

NAMES = ("</script><b>one", "two")
SCENES = (
    KitchenState(
        (Chef((1, 2), "south", Soup((2, 1), 20, 20)), Chef((3, 3), "east", "tomato")),
        {(0, 3): "onion", (2, 0): Soup((2, 1), 7, 120), (4, 0): Soup((3, 0), 15, 15), (6, 2): "dish"},
    ),
    KitchenState(
        (Chef((4, 2), "north", "dish"), Chef((3, 3), "west", "onion")),
        {(0, 3): "tomato", (0, 2): Soup((1, 2), 20, 20), (2, 0): Soup((1, 1))},
        timestep=1,
    ),
)


@given(neighbours())
def test_states_that_differ_are_given_differently(pair):
    one, other = (pack_game(TOMATO_KITCHEN, [(state, 0.0)], NAMES, "")["frames"] for state in pair)
    assert one != other


def test_no_name_ends_the_element_that_it_is_in():
    (text,) = player(pack_game(TOMATO_KITCHEN, [(SCENES[0], 0.0)], NAMES, NAMES[0])).split("</script>")[:-1]
    assert json.loads(text.partition(">")[2].partition(">")[2])["names"] == list(NAMES)


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A page with a game of 60 steps in which the first brings 20 points."""
    start, actions, _ = played("cramped_room", 60)
    layout, file = Layout.load("cramped_room"), tmp_path_factory.mktemp("page") / "game.html"
    save_page(file, layout, frames_of(layout, start, actions), NAMES, "A game")
    return file


def test_a_kitchen_looks_as_it_does_in_pictures(file, opened):
    page = opened(file)
    game = pack_game(TOMATO_KITCHEN, [(state, 0.0) for state in SCENES], NAMES, "")
    program = """game => game.frames.map(frame => {
        const canvas = document.createElement("canvas");
        Kitchen.draw(canvas, game.grid, frame, 48);
        return canvas.toDataURL();
    })"""
    for state, url in zip(SCENES, page.evaluate(program, game), strict=True):
        with Image.open(BytesIO(b64decode(url.partition(",")[2]))) as picture:
            drawn = np.asarray(picture.convert("RGB")).astype(int)
        difference = np.abs(drawn - draw(TOMATO_KITCHEN, state, tile_size=48))
        tiles = difference.reshape(TOMATO_KITCHEN.height, 48, TOMATO_KITCHEN.width, 48, 3).mean(axis=(1, 3, 4))
        for x, y in np.ndindex(TOMATO_KITCHEN.width, TOMATO_KITCHEN.height):
            pot = state.objects.get((x, y))
            figures = isinstance(pot, Soup) and pot.is_cooking  # which the browser writes in a font of its own
            assert tiles[y, x] < (20 if figures else 8), (x, y)


def test_buttons_keys_and_slider_move_through_a_game(file, opened):
    page = opened(file)
    said = page.locator(".said")

    def shows(step, points):
        assert said.inner_text().startswith(f"step {step} of 60, {points} points")

    shows(0, 0)
    assert f"{NAMES[0]} holds a soup of 3 onions" in said.inner_text()
    page.get_by_role("button", name="Step forward").click()
    shows(1, 20)
    assert f"{NAMES[0]} holds nothing" in said.inner_text()
    page.get_by_role("button", name="Last step").click()
    shows(60, 20)
    page.get_by_role("button", name="Step back").click()
    shows(59, 20)
    page.get_by_role("group").focus()
    for key, step in (("ArrowLeft", 58), ("Home", 0), ("ArrowRight", 1), ("End", 60)):
        page.keyboard.press(key)
        shows(step, 20 * (step > 0))
    page.get_by_role("slider", name="Step").fill("30")
    shows(30, 20)
    page.get_by_role("slider").press("ArrowRight")
    shows(31, 20)


def test_a_game_plays_pauses_and_starts_over(file, opened):
    page = opened(file, width=390, dark=True)
    page.get_by_role("combobox", name="Speed").select_option("64")
    page.get_by_role("group").focus()
    page.keyboard.press("-")
    assert page.get_by_role("combobox").input_value() == "32"
    page.keyboard.press("+")
    page.keyboard.press(" ")
    page.get_by_role("button", name="Pause").click()
    here = page.locator(".said").inner_text()
    page.wait_for_timeout(100)
    assert page.locator(".said").inner_text() == here
    page.get_by_role("button", name="Play").press(" ")
    page.get_by_text("step 60 of 60, 20 points").wait_for()
    page.get_by_role("button", name="Play").click()
    page.get_by_role("button", name="Pause").wait_for()
    assert "step 60" not in page.locator(".said").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390

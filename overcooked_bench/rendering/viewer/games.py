"""Writes recorded games in the form that `kitchen.js` plays, and as parts of a page."""

import json
from collections.abc import Iterable
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS, Soup, Thing
from overcooked_bench.rendering.page import page
from overcooked_bench.rendering.pots import progress
from overcooked_bench.rendering.replay import Frame

_LETTERS = {"onion": "o", "tomato": "t", "dish": "d"}


def pack_game(layout: Layout, frames: Iterable[Frame], names: tuple[str, str], title: str) -> dict[str, Any]:
    """Returns a game as `kitchen.js` takes it; the head of that file describes the form.

    Args:
        layout: The floor plan.
        frames: From `frames_of`.
        names: Names of the chefs on seats 0 and 1.
        title: Which game this is, for screen readers.
    """
    packed = [pack_frame(layout, frame) for frame in frames]
    return {"title": title, "grid": list(layout.rows), "names": list(names), "frames": packed}


def player(game: dict[str, Any]) -> str:
    """Returns the element of a page in which a game is played; `script` has to follow it."""
    data = json.dumps(game, separators=(",", ":")).replace("<", "\\u003c")  # "</script>" would end the element
    return f'<div data-kitchen><script type="application/json">{data}</script></div>'


@cache
def script() -> str:
    """Returns the end of a page with players: the program, and the call that starts it."""
    program = files("overcooked_bench.rendering.viewer").joinpath("kitchen.js").read_text("utf-8")
    return (
        "<noscript><p>The games are played by JavaScript, which is turned off here.</p></noscript>\n"
        f"<script>\n{program}Kitchen.fill(document);\n</script>"
    )


def save_page(file: str | Path, layout: Layout, frames: Iterable[Frame], names: tuple[str, str], title: str) -> None:
    """Writes a page that plays one game; `pack_game` says what it takes."""
    game = pack_game(layout, frames, names, title)
    write_whole(file, page(title, [f"<h1>{escape(title)}</h1>", player(game), script()]))


def pack_frame(layout: Layout, frame: Frame) -> list[Any]:
    """Returns one frame as `kitchen.js` takes it."""
    state, points = frame
    chefs = [[*chef.position, FACINGS.index(chef.facing), _thing(layout, chef.holding, False)] for chef in state.chefs]
    things = [
        [*position, _thing(layout, thing, layout.tile(position) == "P")] for position, thing in state.objects.items()
    ]
    return [state.timestep, points, chefs, things]


def _thing(layout: Layout, thing: Thing | None, in_pot: bool) -> str:
    if not isinstance(thing, Soup):
        return _LETTERS[thing] if thing else ""
    onions, tomatoes = thing.recipe
    cooked = progress(layout, thing) if in_pot else None
    return f"s{onions}{tomatoes}" + (f" {cooked[0]} {cooked[1]}" if cooked else "")

"""Draws a kitchen as text for a terminal."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import zip_longest

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS, KitchenState, Soup, Thing
from overcooked_bench.rendering.pots import progress

TILE_WIDTH = 3
"""Characters of one tile."""

_ARROWS = dict(zip(FACINGS, "^v><", strict=True))
_LETTERS = {"onion": "o", "tomato": "t", "dish": "d"}

# 256-colour codes: (ink, ground, bold)
_Look = tuple[int, int, bool]
_Span = tuple[str, _Look]
_FLOOR: _Look = (0, 230, False)
_COUNTER: _Look = (242, 246, False)
_CHEFS: tuple[_Look, _Look] = ((231, 25, True), (16, 214, True))
_TILES: dict[str, _Look] = {
    " ": _FLOOR,
    "X": _COUNTER,
    "O": (16, 221, True),
    "T": (231, 160, True),
    "D": (16, 255, True),
    "S": (231, 29, True),
}
_LYING: dict[str, _Look] = {"o": (16, 221, True), "t": (231, 160, True), "d": (16, 255, True), "s": (221, 94, True)}
_POT_EMPTY: _Look = (250, 238, False)
_POT_FILLED: _Look = (221, 238, True)
_POT_COOKING: _Look = (231, 88, True)
_POT_READY: _Look = (16, 46, True)


def film(
    layout: Layout, state: KitchenState, *, colour: bool = True, legend: bool = True, names: Sequence[str] = "01"
) -> str:
    r"""Draws a kitchen as text, one line per row and three characters per tile.

    A chef is its name, an arrow and the object that it holds (`1>o`). Pots are `[_]` empty, `[2]` with that many
    ingredients, `~12` with that many steps to cook, `[!]` ready. `<O>`, `<T>` and `<D>` hand out onions, tomatoes and
    dishes, `<S>` serves. `###` is a counter and `#o#` one with an onion on it (t tomato, d dish, s soup).

    Args:
        layout: The floor plan.
        state: The chefs and objects to draw.
        colour: Whether to add ANSI colours; the text is plain ASCII without them.
        legend: Whether to add a line for the step and the chefs, and one for each soup.
        names: Of the chefs by seat, one letter each.

    Returns:
        Lines joined by "\n", without one at the end.
    """
    rows = [[_tile(layout, state, (x, y)) for x in range(layout.width)] for y in range(layout.height)]
    for seat, chef in enumerate(state.chefs):
        x, y = chef.position
        rows[y][x] = [(f"{names[seat]}{_ARROWS[chef.facing]}{_letter(chef.holding)}", _CHEFS[seat])]
    paint = _paint if colour else _plain
    lines = ["".join(paint(text, look) for tile in row for text, look in tile) for row in rows]
    if legend:
        lines += _legend(layout, state, colour, names)
    return "\n".join(lines)


def side_by_side(pictures: Sequence[str], width: int = 100) -> str:
    """Puts pictures side by side, from left to right, in as many rows as are needed.

    Args:
        pictures: Texts of several lines, with or without ANSI colours.
        width: Characters of a row; a picture that is wider has a row of its own.
    """
    gap, cell = 3, max((_shown(line) for picture in pictures for line in picture.split("\n")), default=1)
    across = max(1, (width + gap) // (cell + gap))
    rows = []
    for first in range(0, len(pictures), across):
        columns = [picture.split("\n") for picture in pictures[first : first + across]]
        lines = zip_longest(*columns, fillvalue="")
        rows.append(
            "\n".join("".join(text + " " * (cell + gap - _shown(text)) for text in line).rstrip() for line in lines)
        )
    return "\n\n".join(rows)


def describe(thing: Thing | None) -> str:
    """Returns an object's name: "nothing", "onion", "soup of 2 onions and 1 tomato"."""
    if thing is None:
        return "nothing"
    return f"soup of {_ingredients(thing)}" if isinstance(thing, Soup) else thing


def _shown(text: str) -> int:
    """Counts a line's characters on a terminal, without its colour codes."""
    return len(re.sub(r"\x1b\[[0-9;]*m", "", text))


def _ingredients(soup: Soup) -> str:
    counts = [(n, kind) for n, kind in zip(soup.recipe, ("onion", "tomato"), strict=True) if n]
    plural = {"onion": "onions", "tomato": "tomatoes"}
    return " and ".join(f"{n} {kind if n == 1 else plural[kind]}" for n, kind in counts)


def _letter(thing: Thing | None) -> str:
    if thing is None:
        return " "
    return "s" if isinstance(thing, Soup) else _LETTERS[thing]


def _tile(layout: Layout, state: KitchenState, position: tuple[int, int]) -> list[_Span]:
    tile, thing = layout.tile(position), state.objects.get(position)
    if tile == "P":
        return [_pot(layout, thing)]
    if tile == "X" and thing is not None:
        letter = _letter(thing)
        return [("#", _COUNTER), (letter, _LYING[letter]), ("#", _COUNTER)]
    return [({" ": "   ", "X": "###"}.get(tile, f"<{tile}>"), _TILES[tile])]


def _pot(layout: Layout, content: Thing | None) -> _Span:
    if not isinstance(content, Soup):
        return "[_]", _POT_EMPTY
    cooked = progress(layout, content)
    if cooked is None:
        return f"[{sum(content.recipe)}]", _POT_FILLED
    left = cooked[1] - cooked[0]
    if left == 0:
        return "[!]", _POT_READY
    return (f"~{left:2d}" if left < 100 else str(left)), _POT_COOKING


def _legend(layout: Layout, state: KitchenState, colour: bool, names: Sequence[str]) -> list[str]:
    chefs = []
    for seat, chef in enumerate(state.chefs):
        label = f"{names[seat]}{_ARROWS[chef.facing]}"
        chefs.append(f"{_paint(label, _CHEFS[seat]) if colour else label} {describe(chef.holding)}")
    lines = [f"step {state.timestep}   " + "   ".join(chefs)]
    for position, content in state.objects.items():
        if isinstance(content, Soup):
            where = "pot" if layout.tile(position) == "P" else "dish"
            lines.append(f"{where} {position}: {_ingredients(content)}{_condition(layout, content, where)}")
    return lines


def _condition(layout: Layout, soup: Soup, where: str) -> str:
    cooked = progress(layout, soup)
    if where == "dish" or cooked is None:
        return ""
    left = cooked[1] - cooked[0]
    return f", {left} step{'s' * (left > 1)} to go" if left else ", ready"


def _paint(text: str, look: _Look) -> str:
    ink, ground, bold = look
    return f"\x1b[{'1;' if bold else ''}38;5;{ink};48;5;{ground}m{text}\x1b[0m"


def _plain(text: str, look: _Look) -> str:
    return text

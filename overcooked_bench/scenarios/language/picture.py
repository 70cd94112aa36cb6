"""Reads kitchens drawn with letters: a layout with the chefs A and B and the objects on the counters."""

from collections.abc import Mapping
from typing import Final, Literal, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.codes import MAX_INGREDIENTS, RECIPES, Position
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState, Soup, Thing

CHEFS: Final = "AB"
LYING: Final[dict[str, Literal["onion", "tomato", "dish", "soup"]]] = {
    "o": "onion",
    "t": "tomato",
    "d": "dish",
    "s": "soup",
}
THINGS: Final = tuple(LYING.values())

_CLASSIC: Final = (MAX_INGREDIENTS, 0)
_LETTERS: Final[Mapping[Thing, str]] = {"onion": "o", "tomato": "t", "dish": "d"}


class PictureError(WrongUse):
    """A picture does not show its layout.

    Attributes:
        row: The row at fault, from 0.
    """

    def __init__(self, message: str, row: int) -> None:
        super().__init__(message)
        self.row = row


class Picture(NamedTuple):
    """What a picture shows besides the layout.

    Attributes:
        chefs: The cells of A and B.
        lying: The objects on counters.
    """

    chefs: tuple[Position, Position]
    lying: dict[Position, Thing]


def read_picture(text: str, layout: Layout) -> Picture:
    """Reads a picture and compares it with its layout, cell by cell.

    Args:
        text: The layout's rows, with `A` and `B` on the floor and `o`, `t`, `d` and `s` on counters.
        layout: The layout that it should show.

    Raises:
        PictureError: It does not show this layout, or not both chefs.
    """
    rows = text.rstrip("\n").split("\n")
    chefs: dict[str, Position] = {}
    lying: dict[Position, Thing] = {}
    for y, row in enumerate(rows[: layout.height]):
        if len(row.rstrip()) > layout.width or len(row) < layout.width:
            raise PictureError(f"{len(row)} cells {row!r}; the layout is {layout.width} wide, {layout.rows[y]!r}", y)
        for x, letter in enumerate(row[: layout.width]):
            if letter in CHEFS and letter in chefs:
                raise PictureError(f"column {x} (from 0) is {letter!r} a second time; there is one chef {letter}", y)
            wrong = _misfit(letter, layout.tile((x, y)))
            if wrong:
                raise PictureError(f"column {x} (from 0) is {letter!r}, {wrong}: {layout.rows[y]!r}", y)
            if letter in CHEFS:
                chefs[letter] = x, y
            elif letter in LYING:
                lying[x, y] = _thing(LYING[letter], layout)
    if len(rows) != layout.height:
        raise PictureError(f"the picture has {len(rows)} rows, the layout {layout.height}", len(rows) - 1)
    for letter in CHEFS:
        if letter not in chefs:
            raise PictureError(f"no chef {letter}; put the letter {letter} on a floor cell", 0)
    return Picture((chefs["A"], chefs["B"]), lying)


def _misfit(letter: str, tile: str) -> str:
    """Returns why a letter of the picture does not fit a tile of the layout; an empty text if it does."""
    if letter in CHEFS:
        return "" if tile == " " else f"but chefs stand on the floor and the layout has {tile!r} there"
    if letter not in LYING:
        return "" if letter == tile else f"but the layout has {tile!r} there"
    where = "is for an object on a counter (X); capital O, T, D and S are dispensers and the serving tile"
    return "" if tile == "X" else f"which {where}, and the layout has {tile!r} there"


def _thing(name: Literal["onion", "tomato", "dish", "soup"], layout: Layout) -> Thing:
    return finished_soup(layout) if name == "soup" else name


def draw_picture(layout: Layout, state: KitchenState, seat: int) -> str:
    """Draws a state so that `read_picture` reads it; hands, directions and pots are not shown.

    Args:
        layout: The floor plan.
        state: The chefs and objects to draw.
        seat: Chef A's seat.
    """
    rows = [list(row) for row in layout.rows]
    for (x, y), thing in state.objects.items():
        if layout.tile((x, y)) == "X":
            rows[y][x] = "s" if isinstance(thing, Soup) else _LETTERS[thing]
    for letter, chef in zip(CHEFS, (state.chefs[seat], state.chefs[1 - seat]), strict=True):
        x, y = chef.position
        rows[y][x] = letter
    return "\n".join("".join(row) for row in rows)


def finished_soup(layout: Layout) -> Soup:
    """Returns a finished soup of the first recipe on the menu."""
    recipe = _CLASSIC if _CLASSIC in layout.orders else layout.orders[0]
    time = layout.cook_times[RECIPES.index(recipe)]
    return Soup(recipe, time, time)

"""A kitchen's floor plan and menu: reads an ASCII grid, checks it, and names it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.files import read_text, shown
from overcooked_bench.kitchen.codes import TILE_NAMES, TILES, Position, Recipe
from overcooked_bench.kitchen.errors import LayoutError, said
from overcooked_bench.kitchen.menu import DEFAULT_COOK_TIME, DEFAULT_SOUP_REWARD, PerRecipe, read_menu
from overcooked_bench.kitchen.regions import able_regions, faced_from, number_regions
from overcooked_bench.shelf import Shelf, guess

MIRRORED = "-mirrored"
MOST_CELLS = 4096

CLASSIC: Final = (
    "cramped_room",
    "asymmetric_advantages",
    "coordination_ring",
    "forced_coordination",
    "counter_circuit",
)
"""The layouts of the studies since Carroll et al. 2019."""

_MENU: Final = ("orders", "bonus_orders", "order_bonus", "soup_reward", "cook_time")


_SHELF: Final = Shelf(
    "layout",
    "overcooked_bench.kitchen.layouts",
    ".layout",
    LayoutError,
    "a .layout file or a grid of several lines",
    first=CLASSIC,
)


@dataclass(frozen=True)
class Layout:
    """A checked floor plan with its orders, rewards and cook times.

    Make one with `Layout.from_text` or `Layout.load`.

    Attributes:
        name: The name that agents get: a shipped layout's name, or the grid's text.
        rows: H strings of W tiles: `X` counter, `P` pot, `O` onions, `T` tomatoes, `D` dishes, `S` serving, ` ` floor.
        start_cells: Standard start cell of each chef, from the digits of the grid; empty if there are none.
        orders: Recipes that are paid for.
        bonus_orders: Recipes that are paid `order_bonus` times.
        order_bonus: The factor for bonus orders.
        soup_rewards: Reward points of one delivery by recipe index (0 if it is not ordered), bonus included.
        cook_times: Steps by recipe index.
    """

    name: str
    rows: tuple[str, ...]
    start_cells: tuple[Position, ...] = ()
    orders: tuple[Recipe, ...] = ((3, 0),)
    bonus_orders: tuple[Recipe, ...] = ()
    order_bonus: float = 2
    soup_rewards: tuple[float, ...] = field(default=(), repr=False)
    cook_times: tuple[int, ...] = field(default=(), repr=False)

    @classmethod
    def from_text(
        cls,
        grid: str,
        orders: Sequence[Sequence[str]] = (("onion", "onion", "onion"),),
        bonus_orders: Sequence[Sequence[str]] = (),
        order_bonus: float = 2,
        soup_reward: PerRecipe = DEFAULT_SOUP_REWARD,
        cook_time: PerRecipe = DEFAULT_COOK_TIME,
        name: str | None = None,
    ) -> "Layout":
        """Reads a grid and its menu.

        Args:
            grid: Rows of tiles; the digits 1 and 2 mark where chef 0 and chef 1 start.
            orders: Each a list of one to three ingredients, "onion" or "tomato"; an empty list means all nine recipes.
            bonus_orders: Orders that pay `order_bonus` times.
            order_bonus: Factor for bonus orders.
            soup_reward: Points per delivery: one number, {"onion": v, "tomato": v} summed over the ingredients, or one
                number for each order.
            cook_time: Steps, in the same three forms.
            name: Set by `load`; by default the grid's text.

        Raises:
            LayoutError: The grid or the menu breaks a rule; names row and column, counted from 1.

        Source: overcooked_ai (`SoupState`'s and `Recipe`'s configuration, and its layout files).
        """
        rows, starts = _parse_grid(grid)
        menu = read_menu(orders, bonus_orders, order_bonus, soup_reward, cook_time)
        layout = cls(name or "\n".join(_with_digits(rows, starts)), rows, starts, *menu)
        layout._check()
        return layout

    @property
    def soup_points(self) -> float:
        """Points of one soup, the cheapest order that is paid for; thresholds count soups of this value."""
        return min((points for points in self.soup_rewards if points > 0), default=float(DEFAULT_SOUP_REWARD))

    @classmethod
    def load(cls, source: "str | Path | Layout") -> "Layout":
        """Returns a layout by a shipped name, `<name>-mirrored`, the path of a `.layout` file or a grid's text.

        Raises:
            LayoutError: No such name or file, or the grid is not legal.
        """
        if isinstance(source, Layout):
            return source
        text = str(source)
        if "\n" in text:
            return cls.from_text(text)
        turns = 0
        while text.endswith(MIRRORED):
            text, turns = text.removesuffix(MIRRORED), turns + 1
        file = _SHELF.find(text)
        content = read_text(file, LONGEST, raises=LayoutError)
        layout = cls._from_file(content, str(file), text if text in layout_names() else None)
        return layout.mirrored() if turns % 2 else layout

    @classmethod
    def named(cls, text: str) -> "Layout":
        """Loads a layout named in a file: a shipped name, its mirror image or a grid's text, never a path.

        Raises:
            LayoutError: It is none of these, or the grid is not legal.
        """
        names = layout_names()
        if "\n" not in text and text.removesuffix(MIRRORED) not in names:
            raise LayoutError(f"no layout named {shown(text)!r}; {guess(text, names)}Shipped are {', '.join(names)}")
        return cls.load(text)

    @classmethod
    def _from_file(cls, text: str, where: str, name: str | None) -> "Layout":
        """Reads a grid, optionally followed by a line `---` and a YAML mapping of `from_text`'s other arguments."""
        grid, _, menu = text.partition("\n---\n")
        if not menu:
            return cls.from_text(grid, name=name)
        above = "\n" * (grid.count("\n") + 2)  # so that errors name the file's own lines
        document = parse_yaml(above + menu, where, LayoutError)
        for key in document.data:
            if key not in _MENU:
                raise document.error((key,), f"unknown key `{key}`; {guess(key, _MENU)}keys are {', '.join(_MENU)}")
        return cls.from_text(grid, name=name, **document.data)

    def mirrored(self) -> "Layout":
        """Returns the left-right mirror image; its name gains or loses `-mirrored`, a grid's text is mirrored."""
        rows = tuple(row[::-1] for row in self.rows)
        starts = tuple((self.width - 1 - x, y) for x, y in self.start_cells)
        if "\n" in self.name:
            name = "\n".join(_with_digits(rows, starts))
        else:
            name = self.name.removesuffix(MIRRORED) if self.name.endswith(MIRRORED) else self.name + MIRRORED
        return replace(self, name=name, rows=rows, start_cells=starts)

    @property
    def width(self) -> int:
        """W, cells."""
        return len(self.rows[0])

    @property
    def height(self) -> int:
        """H, cells."""
        return len(self.rows)

    @property
    def text(self) -> str:
        """The grid with its digits, one row per line."""
        return "\n".join(_with_digits(self.rows, self.start_cells))

    @property
    def has_tomatoes(self) -> bool:
        """Whether tomatoes can be taken or are ordered here."""
        ordered = any(tomatoes for _, tomatoes in self.orders + self.bonus_orders)
        return ordered or any("T" in row for row in self.rows)

    def tile(self, position: Position) -> str:
        """Returns the tile's letter at (x, y)."""
        return self.rows[position[1]][position[0]]

    def positions(self, tiles: str) -> list[Position]:
        """Lists the cells of the given tile letters in row-major order, the canonical order everywhere."""
        return [(x, y) for y, row in enumerate(self.rows) for x, tile in enumerate(row) if tile in tiles]

    @cached_property
    def regions(self) -> dict[Position, int]:
        """Numbers the separate parts of the floor: (x, y) of a floor cell -> region, from 0 in row-major order."""
        return number_regions(self.positions(" "))

    @cached_property
    def start_regions(self) -> NDArray[np.bool_]:
        """Whether a random start may use these regions, (regions, regions) bool: of chef 0, then of chef 1.

        A soup is possible, and the regions differ; both chefs share a region only if no two different regions allow a
        soup.

        Source: the thesis, 6.2.1: the reference sampler ignores regions.
        """
        able = self._able
        apart = able & ~np.eye(len(able), dtype=np.bool_)
        if apart.any():
            return apart
        roomy = np.bincount(list(self.regions.values())) > 1
        together: NDArray[np.bool_] = np.diag(np.diag(able) & roomy)
        return together

    @cached_property
    def _able(self) -> NDArray[np.bool_]:
        return able_regions(self.rows, self.regions, self.orders)

    def _check(self) -> None:
        for letters, what in (("P", "pot (P)"), ("D", "dish dispenser (D)"), ("S", "serving tile (S)")):
            self._need(letters, what)
        menu = [{letter for letter, n in zip("OT", recipe, strict=True) if n} for recipe in self.orders]
        present = {letter for letter in "OT" if self.positions(letter)}
        if not any(letters <= present for letters in menu):
            raise LayoutError(
                "no order can be cooked: the grid has "
                + (" and ".join(TILE_NAMES[letter] + "s" for letter in sorted(present)) or "no ingredient dispenser")
                + "; add the dispensers (O onions, T tomatoes) that one of the orders needs"
            )
        for letter in sorted(set.union(*[letters for letters in menu if letters <= present])):
            self._need(letter, TILE_NAMES[letter] + f" ({letter})")
        if len(self.regions) < 2:
            raise LayoutError("two chefs need at least two floor cells (spaces or digits)")
        if self.start_cells and not self._able[tuple(self.regions[cell] for cell in self.start_cells)]:
            raise LayoutError(
                "no useful work is possible from the start cells: the chefs' regions and the counters they share "
                "do not connect an ingredient, a dish, a pot and a serving tile; move a digit or open a wall"
            )
        if not self.start_regions.any():
            raise LayoutError(
                "no useful work is possible: no one or two regions of the floor, with the counters they share, connect "
                "an ingredient, a dish, a pot and a serving tile; open a wall"
            )

    def _need(self, letters: str, what: str) -> None:
        cells = self.positions(letters)
        if not cells:
            raise LayoutError(f"the grid has no {what}; put one in reach of the floor")
        if not any(faced_from(cell, self.regions) for cell in cells):
            x, y = cells[0]
            raise LayoutError(
                f"row {y + 1}, column {x + 1}: no floor cell is next to the {what}, so no chef reaches it"
            )


def layout_names() -> tuple[str, ...]:
    """Lists the shipped layouts, the five classic ones first."""
    return _SHELF.names()


def _parse_grid(  # noqa: C901 (one check after the other, each with its own message)
    grid: str,
) -> tuple[tuple[str, ...], tuple[Position, ...]]:
    if not isinstance(grid, str):
        raise LayoutError(f"the grid is {said(grid)}; write a text of rows such as 'XXPXX'")
    if len(grid) > LONGEST:
        raise LayoutError(
            f"the grid has {len(grid):,} characters; at most {LONGEST:,} are read, for at most {MOST_CELLS} cells"
        )
    lines = [line.rstrip("\r") for line in grid.split("\n")]
    while lines and not lines[0].strip():
        lines.pop(0)
    while lines and not lines[-1].strip():
        lines.pop()
    if not lines:
        raise LayoutError("the grid is empty; write rows such as 'XXPXX'")
    indent = min(len(line) - len(line.lstrip()) for line in lines)
    lines = [line[indent:].rstrip() for line in lines]
    width = len(lines[0])
    starts: dict[int, Position] = {}
    for y, line in enumerate(lines):
        if len(line) != width:
            raise LayoutError(
                f"row {y + 1}: {len(line)} tiles where row 1 has {width}; every row needs the same length and a border"
            )
        for x, tile in enumerate(line):
            where = f"row {y + 1}, column {x + 1}: "
            if tile not in TILES and tile not in "12":
                raise LayoutError(
                    f"{where}unknown tile {tile!r}; tiles are X P O T D S, space for floor, 1 and 2 for chefs"
                )
            edge = x in (0, width - 1) or y in (0, len(lines) - 1)
            if edge and tile in " 12":
                raise LayoutError(f"{where}floor on the border; close it with a counter (X)")
            if tile in "12":
                if int(tile) in starts:
                    raise LayoutError(f"{where}a second start cell for chef {tile}; use each digit once")
                starts[int(tile)] = (x, y)
    if width * len(lines) > MOST_CELLS:
        raise LayoutError(f"the grid has {width * len(lines)} cells; at most {MOST_CELLS} are supported")
    if len(starts) == 1:
        raise LayoutError(f"only chef {next(iter(starts))} has a start cell; mark both with 1 and 2, or neither")
    rows = tuple(line.replace("1", " ").replace("2", " ") for line in lines)
    return rows, tuple(starts[k] for k in sorted(starts))


def _with_digits(rows: Sequence[str], starts: Sequence[Position]) -> list[str]:
    marked = [list(row) for row in rows]
    for chef, (x, y) in enumerate(starts):
        marked[y][x] = str(chef + 1)
    return ["".join(row) for row in marked]

"""Grids, menus and `.layout` files."""

import json
import random
from collections.abc import Iterator
from typing import Any

import yaml

from overcooked_bench import Kitchens, Layout, LayoutError
from overcooked_bench.kitchen.layout import layout_names
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, lines_of, trees_of, written

MENU = {
    "orders": [["onion"] * 3, ["onion", "tomato"]],
    "bonus_orders": [["onion", "tomato"]],
    "order_bonus": 2,
    "soup_reward": {"onion": 5, "tomato": 7.5},
    "cook_time": [20, 15],
}
GRID = "XTPXX\nO  2O\nX1  X\nXDXSX"


def used(layout: Layout) -> None:
    """A layout that was read can be played."""
    kitchens = Kitchens(layout, 1, cooking="manual")
    kitchens.reset(seed=0)
    kitchens.step([[0, 5]])
    kitchens.observe("lossless26")


def files() -> list[bytes]:
    shipped = [Layout.load(name).text for name in layout_names()]
    return [*(text.encode() for text in shipped), f"{GRID}\n---\n{yaml.safe_dump(MENU)}".encode()]


def grids(rng: random.Random) -> Iterator[bytes]:
    """Grids of any tiles, and grids with tiles changed."""
    texts = [Layout.load(name).text for name in layout_names()]
    while True:
        if rng.random() < 0.3:
            width, height = rng.choice((1, 3, 5, 9, 60)), rng.choice((1, 3, 4, 7, 60))
            tiles = rng.choice(("XPODST 12", "X ", " ", "XXXXXXXPODS      "))
            yield "\n".join("".join(rng.choice(tiles) for _ in range(width)) for _ in range(height)).encode()
            continue
        rows = [list(row) for row in rng.choice(texts).split("\n")]
        for _ in range(rng.choice((1, 2, 5, 20))):
            row = rng.choice(rows)
            row[rng.randrange(len(row))] = rng.choice("XPODST 12")
        yield "\n".join(map("".join, rows)).encode()


@TRIES
def test_layout_files(tries, tmp_path):
    file = tmp_path / "x.layout"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        used(Layout.load(file))

    seeds, rng = files(), seeded("layout files")
    menus = (f"{GRID}\n---\n".encode() + menu for menu in as_json(trees_of([MENU], rng)))
    inputs = mixed(rng, bytes_of(seeds, rng), lines_of(seeds, rng), grids(rng), menus)
    attack(".layout file", seeds, inputs, read, LayoutError, tries).check()


@TRIES
def test_grids_and_menus_of_python(tries):
    def read(content: bytes) -> None:
        arguments: Any = json.loads(content)
        used(Layout.from_text(arguments["grid"], **arguments["menu"]))

    def whole(tree: Any) -> Any:
        if not isinstance(tree, dict) or not isinstance(tree.get("menu"), dict) or "grid" not in tree:
            return {"grid": tree, "menu": {}}
        return {"grid": tree["grid"], "menu": {key: value for key, value in tree["menu"].items() if key in MENU}}

    trees = [{"grid": GRID, "menu": MENU}, *({"grid": Layout.load(name).text, "menu": {}} for name in layout_names())]
    seeds, rng = [written(tree).encode() for tree in trees], seeded("grids")
    menus = (written({"grid": GRID, "menu": menu}).encode() for menu in map(menu_of, trees_of([MENU], rng)))
    inputs = mixed(rng, as_json(trees_of(trees, rng), whole), menus)
    attack("Layout.from_text", seeds, inputs, read, LayoutError, tries).check()


def menu_of(tree: Any) -> Any:
    """What of a tree `from_text` knows by name."""
    return {key: value for key, value in tree.items() if key in MENU} if isinstance(tree, dict) else {"orders": tree}


@TRIES
def test_names_and_paths_of_layouts(tries):
    names = [name.encode() for name in layout_names()]
    seeds = [*names, b"cramped_room-mirrored", b"/proc/self/mem", b"/dev/zero", b"x" * 300]
    inputs = bytes_of(seeds, seeded("names of layouts"))

    def read(content: bytes) -> None:
        Layout.load(content.decode("utf-8", "surrogateescape"))

    attack("name of a layout", names, inputs, read, LayoutError, tries).check()

"""Layout files with their menus, menus as arguments, names of layouts, and states in overcooked_ai's JSON form."""

import itertools
import json

from overcooked_bench.kitchen.convert import StateError
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout, LayoutError, layout_names
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.shelf import Shelf
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import VALUES, as_json, bytes_of, lines_of, trees_of

SHELF = Shelf("layout", "overcooked_bench.kitchen.layouts", ".layout", LayoutError, "a file")
MENU = b"orders: [[onion, onion, onion], [tomato]]\nbonus_orders: [[tomato]]\norder_bonus: 2.5\nsoup_reward: [9, 4]\n"
GRID = "XXPXX\nO1 2O\nX   T\nXDXSX"
FILES = [
    *(SHELF.find(name).read_bytes() for name in layout_names()),
    f"{GRID}\n---\n".encode() + MENU + b"cook_time: {onion: 5, tomato: 7}\n",
    b"X" * 30 + b"\n" + b"\n".join([b"X " * 15] * 28) + b"\n" + b"XPODS" * 6,
]


@TRIES
def test_layout_files(tries, tmp_path):
    file = tmp_path / "f.layout"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        layout = Layout.load(file)
        assert layout.mirrored().mirrored() == layout
        assert len(layout.start_regions)

    rng = seeded("layouts")
    texts = [content for content in FILES if content.isascii()]
    inputs = mixed(rng, bytes_of(FILES, rng), lines_of(texts, rng))
    attack(".layout", FILES[:-1], inputs, read, LayoutError, tries).check()


@TRIES
def test_menus(tries):
    seeds = [
        {"orders": [["onion"] * 3, ["tomato"]], "soup_reward": [20, 10.5], "cook_time": {"onion": 5, "tomato": 7}},
        {"orders": [], "bonus_orders": [["tomato"]], "order_bonus": 2.5, "soup_reward": {"onion": 1, "tomato": 2}},
    ]
    rng = seeded("menus")
    trees = trees_of(seeds, rng)

    def read(_: bytes) -> None:
        tree = next(trees)
        keys = ("orders", "bonus_orders", "order_bonus", "soup_reward", "cook_time")
        Layout.from_text(GRID, **{key: tree[key] for key in keys if isinstance(tree, dict) and key in tree})

    attack("Layout.from_text", [], itertools.repeat(b""), read, LayoutError, tries).check()


@TRIES
def test_names_of_layouts(tries):
    seeds = [*(name.encode() for name in layout_names()), b"cramped_room-mirrored", GRID.encode()]
    seeds += [value.encode("utf-8", "surrogatepass") for value in VALUES if isinstance(value, str)]

    def read(content: bytes) -> None:
        Layout.load(content.decode("utf-8", "surrogateescape"))

    attack("Layout.load", seeds[:1], bytes_of(seeds, seeded("names")), read, LayoutError, tries).check()


@TRIES
def test_states(tries):
    kitchens = Kitchens("cramped_room", 20, start="random", object_probability=0.9)
    kitchens.reset(seed=3)
    seeds = [kitchens.state(i).to_dict() for i in range(20)]
    soup = {"name": "soup", "position": [2, 0], "_ingredients": [{"name": "onion"}] * 3, "cooking_tick": 5}
    seeds += [dict(seeds[0], objects=[dict(soup, cook_time=20)])]

    def read(content: bytes) -> None:
        state = KitchenState.from_dict(json.loads(content))
        assert KitchenState.from_dict(state.to_dict()) == state
        kitchens.set_state(0, state)
        kitchens.step([[0, 5]] * 20)

    rng = seeded("states")
    whole = [json.dumps(seed).encode() for seed in seeds]
    trees = as_json(tree for tree in trees_of(seeds, rng) if isinstance(tree, dict))
    texts = (content for content in bytes_of(whole, rng) if is_object(content))
    attack("KitchenState", whole, mixed(rng, trees, trees, trees, texts), read, StateError, tries).check()


def is_object(content: bytes) -> bool:
    try:
        return isinstance(json.loads(content), dict)
    except (ValueError, RecursionError):
        return False

"""Replays recordings of the reference kitchen in ours and compares every recorded array, value by value.

`python -m tests.kitchen.replay FILE ...` replays golden recordings (.npz) and human games (.json with a .ref.npz).
"""

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.kitchen.state import FACINGS

NAMES = {1: "onion", 2: "tomato", 3: "dish"}
RECORDED_SOUP = 4


class Comparison:
    """Compares arrays and counts the values that were equal."""

    def __init__(self, source: str) -> None:
        self.source = source
        self.values = 0

    def same(self, ours: Any, theirs: Any, what: str, step: int) -> None:
        np.testing.assert_array_equal(ours, theirs, err_msg=f"{self.source}, step {step}: {what}")
        self.values += np.size(theirs)


def read_golden(path: Path) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
    """Gives a recording's arrays and its description."""
    with np.load(path) as archive:
        arrays = {key: archive[key] for key in archive.files}
    return arrays, json.loads(str(arrays.pop("meta")))


def golden_layout(meta: Mapping[str, Any]) -> Layout:
    """Builds the layout from the recording's own terrain and menu, not from our shipped files."""
    rows = [list(row) for row in meta["terrain"]]
    for chef, (x, y) in enumerate(meta["start_positions"]):
        rows[y][x] = str(chef + 1)
    grid = "\n".join("".join(row) for row in rows)
    if "recipe_config" not in meta:
        return Layout.from_text(grid, cook_time=meta["cook_time"])
    config = meta["recipe_config"]
    return Layout.from_text(
        grid,
        orders=meta["orders"],
        bonus_orders=meta["bonus_orders"],
        order_bonus=meta["order_bonus"],
        soup_reward={"onion": config["onion_value"], "tomato": config["tomato_value"]},
        cook_time={"onion": config["onion_time"], "tomato": config["tomato_time"]},
    )


def golden_state(data: Mapping[str, np.ndarray], layout: Layout, t: int) -> KitchenState:
    """The KitchenState that a golden file records at index t."""

    def soup(content: np.ndarray, tick: int | None) -> Soup:
        recipe = (int(content[0]), int(content[1]))
        time = layout.cook_times[RECIPES.index(recipe)]
        if tick is None:
            return Soup(recipe, time, time)
        return Soup(recipe, tick, time) if tick >= 0 else Soup(recipe)

    chefs = []
    for k in range(2):
        code = int(data["held"][t, k])
        x, y = data["player_pos"][t, k].tolist()
        holding = soup(data["held_ing"][t, k], None) if code == RECORDED_SOUP else NAMES.get(code)
        chefs.append(Chef((x, y), FACINGS[data["player_or"][t, k]], holding))
    objects: dict[tuple[int, int], Any] = {}
    for y, x in np.argwhere(data["obj"][t]).tolist():
        code = int(data["obj"][t, y, x])
        made = soup(data["obj_ing"][t, y, x], int(data["obj_tick"][t, y, x])) if code == RECORDED_SOUP else NAMES[code]
        objects[x, y] = made
    return KitchenState((chefs[0], chefs[1]), objects, t, layout.orders, layout.bonus_orders)


def replay_golden(path: Path) -> int:
    """Replays one golden file; gives the number of values compared."""
    data, meta = read_golden(path)
    layout = golden_layout(meta)
    cooking = "auto" if meta["old_dynamics"] else "manual"
    assert tuple(meta["events"]) == EVENTS
    kitchens = Kitchens(layout, 1, cooking=cooking, start="standard", events=True, horizon=meta["horizon"])
    kitchens.autoreset = False
    if meta["random_start"]:
        kitchens.set_state(0, golden_state(data, layout, 0))
    steps = len(data["actions"])
    compare = Comparison(path.name)
    for t in range(steps + 1):
        assert kitchens.state(0) == golden_state(data, layout, t), f"{path.name}, step {t}"
        parts = ("player_pos", "player_or", "held", "held_ing", "obj", "obj_ing", "obj_tick")
        compare.values += sum(data[key][t].size for key in parts)
        compare.same(kitchens.observe("lossless26")[0], data["lossless"][t].transpose(0, 3, 2, 1), "lossless26", t)
        compare.same(kitchens.observe("features")[0], data["feats"][t], "features", t)
        if t == steps:
            break
        result = kitchens.step(data["actions"][t][None])
        assert result.events is not None
        compare.same(result.soup_reward[0], data["sparse_by_agent"][t], "soup reward", t)
        compare.same(result.soup_reward[0].sum(), data["sparse"][t], "team reward", t)
        compare.same(result.partial_reward[0], data["shaped_by_agent"][t], "partial reward", t)
        compare.same(result.events[0].T, data["events"][t], "events", t)
        compare.same(result.truncated[0], t == meta["horizon"] - 1, "truncated", t)
    return compare.values


def human_layout(game: Mapping[str, Any]) -> Layout:
    """Builds the layout of a human game."""
    params = game["params"]
    if params.get("delivery_reward") is None:
        reward = {"onion": params["onion_value"], "tomato": params["tomato_value"]}
        time = {"onion": params["onion_time"], "tomato": params["tomato_time"]}
    else:
        reward, time = params["delivery_reward"], params["cook_time"]
    orders, bonus = (
        [["onion"] * onions + ["tomato"] * tomatoes for onions, tomatoes in game[key]]
        for key in ("orders", "bonus_orders")
    )
    return Layout.from_text("\n".join(game["grid"]), orders, bonus, params["order_bonus"], reward, time)


def human_things(state: KitchenState) -> tuple[list[Any], set[Any]]:
    """Gives what the chefs hold and what lies about, in the form of a human recording."""
    held = [
        ["soup", *chef.holding.recipe, chef.holding.tick] if isinstance(chef.holding, Soup) else chef.holding
        for chef in state.chefs
    ]
    lying = {
        ("soup", *place, *thing.recipe, thing.tick) if isinstance(thing, Soup) else (thing, *place)
        for place, thing in state.objects.items()
    }
    return held, lying


def replay_human(path: Path) -> int:
    """Replays one human game and its reference arrays; gives the number of values compared."""
    game = json.loads(path.read_text())
    reference, steps = game["reference"], game["n_steps"]
    with np.load(path.with_suffix(".ref.npz")) as archive:
        lossless, features = archive["lossless"], archive["feats"]
    cooking = {"old": "auto", "new": "manual"}[game["dynamics"]]
    layout = human_layout(game)
    kitchens = Kitchens(layout, 1, cooking=cooking, start="standard", events=True, horizon=reference["horizon"])
    kitchens.autoreset = False
    events = np.zeros((steps, 2, len(EVENTS)), np.bool_)
    for t, chef, name in reference["events"]:
        events[t, chef, EVENTS.index(name)] = True
    compare = Comparison(path.name)
    for t in range(steps + 1):
        state = kitchens.state(0)
        compare.same([chef.position for chef in state.chefs], game["player_pos"][t], "positions", t)
        compare.same([FACINGS.index(chef.facing) for chef in state.chefs], game["player_or"][t], "directions", t)
        held, lying = human_things(state)
        assert held == game["held"][t], f"{path.name}, step {t}"
        assert lying == {tuple(thing) for thing in game["objects"][t]}, f"{path.name}, step {t}"
        compare.values += 2 + len(lying)
        compare.same(kitchens.observe("lossless26")[0], lossless[t].transpose(0, 3, 2, 1), "lossless26", t)
        compare.same(kitchens.observe("features")[0], features[t], "features", t)
        if t == steps:
            break
        result = kitchens.step(np.array(game["actions"][t])[None])
        compare.same(result.soup_reward.sum(), game["reward"][t], "team reward", t)
        compare.same(result.soup_reward[0], reference["sparse_by_agent"][t], "soup reward", t)
        compare.same(result.partial_reward[0], reference["shaped_by_agent"][t], "partial reward", t)
        assert result.events is not None
        compare.same(result.events[0], events[t], "events", t)
    return compare.values


if __name__ == "__main__":
    for given in map(Path, sys.argv[1:]):
        values = replay_golden(given) if given.suffix == ".npz" else replay_human(given)
        print(f"{given}: {values} values equal")

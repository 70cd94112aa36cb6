"""Replays a recorded trajectory in our kitchen and compares every recorded array, value by value."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.kitchen.events import EVENTS

FACINGS = ("north", "south", "east", "west")
NAMES = {1: "onion", 2: "tomato", 3: "dish"}
ITEM = {name: code for code, name in NAMES.items()}


def names(recipe: tuple[int, int]) -> list[str]:
    return ["onion"] * recipe[0] + ["tomato"] * recipe[1]


def golden_layout(meta: dict[str, Any]) -> Layout:
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
        orders=[o["ingredients"] if isinstance(o, dict) else o for o in meta["orders"]],
        bonus_orders=[o["ingredients"] if isinstance(o, dict) else o for o in meta["bonus_orders"]],
        order_bonus=meta["order_bonus"],
        soup_reward={"onion": config["onion_value"], "tomato": config["tomato_value"]},
        cook_time={"onion": config["onion_time"], "tomato": config["tomato_time"]},
    )


def recorded_state(data: Any, layout: Layout, t: int) -> KitchenState:
    """The KitchenState that a golden file records at index t."""

    def thing(code: int, recipe: Any, tick: int | None) -> Any:
        if code != 4:
            return NAMES[int(code)]
        content = (int(recipe[0]), int(recipe[1]))
        from overcooked_bench.kitchen.codes import RECIPES

        time = layout.cook_times[RECIPES.index(content)]
        if tick is None:
            return Soup(content, time, time)
        return Soup(content, int(tick), time) if tick >= 0 else Soup(content)

    chefs = []
    for k in range(2):
        held = int(data["held"][t, k])
        x, y = data["player_pos"][t, k]
        holding = None if held == 0 else thing(held, data["held_ing"][t, k], None)
        chefs.append(Chef((int(x), int(y)), FACINGS[data["player_or"][t, k]], holding))
    objects = {}
    for y, x in zip(*np.nonzero(data["obj"][t]), strict=True):
        tick = data["obj_tick"][t, y, x]
        objects[int(x), int(y)] = thing(data["obj"][t, y, x], data["obj_ing"][t, y, x], tick)
    return KitchenState((chefs[0], chefs[1]), objects, t, layout.orders, layout.bonus_orders)


def replay_golden(path: Path) -> int:
    """Replays one golden file; gives the number of values compared."""
    with np.load(path) as archive:
        data = {key: archive[key] for key in archive.files}
    meta = json.loads(str(data["meta"]))
    layout = golden_layout(meta)
    cooking = "auto" if meta["old_dynamics"] else "manual"
    assert tuple(meta["events"]) == EVENTS
    kitchens = Kitchens(layout, 1, cooking=cooking, start="standard", events=True, horizon=meta["horizon"])
    kitchens.autoreset = False
    kitchens.reset(seed=0)
    if meta["random_start"]:
        kitchens.set_state(0, recorded_state(data, layout, 0))
    steps = len(data["actions"])
    compared = 0

    def same(ours: Any, theirs: Any, what: str, t: int) -> None:
        nonlocal compared
        np.testing.assert_array_equal(ours, theirs, err_msg=f"{path.name}, step {t}: {what}")
        compared += np.size(theirs)

    for t in range(steps + 1):
        assert kitchens.state(0) == recorded_state(data, layout, t), f"{path.name}, step {t}"
        compared += sum(data[key][t].size for key in ("player_pos", "player_or", "held", "held_ing", "obj", "obj_ing", "obj_tick"))
        same(kitchens.observe("lossless26")[0], data["lossless"][t].transpose(0, 3, 2, 1), "lossless26", t)
        same(kitchens.observe("features")[0], data["feats"][t], "features", t)
        if t == steps:
            break
        result = kitchens.step(data["actions"][t][None].astype(int))
        same(result.soup_reward[0], data["sparse_by_agent"][t], "soup reward", t)
        same(result.soup_reward[0].sum(), data["sparse"][t], "team reward", t)
        same(result.partial_reward[0], data["shaped_by_agent"][t], "partial reward", t)
        same(result.events[0].T, data["events"][t], "events", t)
    return compared


def replay_human(path: Path) -> int:
    """Replays one human game and its reference arrays; gives the number of values compared."""
    game = json.loads(path.read_text())
    params = game["params"]
    per = {"soup_reward": params.get("delivery_reward"), "cook_time": params.get("cook_time")}
    if per["soup_reward"] is None:
        per = {
            "soup_reward": {"onion": params["onion_value"], "tomato": params["tomato_value"]},
            "cook_time": {"onion": params["onion_time"], "tomato": params["tomato_time"]},
        }
    layout = Layout.from_text(
        "\n".join(game["grid"]),
        orders=[names(order) for order in game["orders"]],
        bonus_orders=[names(order) for order in game["bonus_orders"]],
        order_bonus=params["order_bonus"],
        **per,
    )
    cooking = {"old": "auto", "new": "manual"}[game["dynamics"]]
    steps = game["n_steps"]
    reference = game["reference"]
    with np.load(path.with_suffix(".ref.npz")) as archive:
        lossless, feats = archive["lossless"], archive["feats"]
    kitchens = Kitchens(layout, 1, cooking=cooking, start="standard", events=True, horizon=reference["horizon"])
    kitchens.autoreset = False
    logged = {(t, chef, name) for t, chef, name in reference["events"]}
    compared = 0
    for t in range(steps + 1):
        state = kitchens.state(0)
        ours = [[list(c.position), FACINGS.index(c.facing)] for c in state.chefs]
        assert ours == [[p, o] for p, o in zip(game["player_pos"][t], game["player_or"][t], strict=True)], (path.name, t)
        for chef, held in zip(state.chefs, game["held"][t], strict=True):
            given = held if held is None or isinstance(held, str) else held[0]
            assert (chef.holding.__class__ is Soup and given == "soup") or chef.holding == given, (path.name, t, held)
        theirs = {tuple(o) for o in game["objects"][t]}
        mine = {
            ("soup", *p, *s.recipe, s.tick) if isinstance(s, Soup) else (s, *p) for p, s in state.objects.items()
        }
        assert mine == theirs, (path.name, t)
        np.testing.assert_array_equal(kitchens.observe("lossless26")[0], lossless[t].transpose(0, 3, 2, 1), f"{path.name} {t}")
        np.testing.assert_array_equal(kitchens.observe("features")[0], feats[t], f"{path.name} {t}")
        compared += lossless[t].size + feats[t].size + 6 + len(theirs)
        if t == steps:
            break
        result = kitchens.step(np.array(game["actions"][t])[None])
        assert result.soup_reward.sum() == game["reward"][t], (path.name, t)
        np.testing.assert_array_equal(result.soup_reward[0], np.array(reference["sparse_by_agent"][t]), f"{path.name} {t}")
        np.testing.assert_array_equal(result.partial_reward[0], np.array(reference["shaped_by_agent"][t]), f"{path.name} {t}")
        now = {(t, chef, EVENTS[e]) for chef, e in zip(*np.nonzero(result.events[0]), strict=True)}
        assert now == {entry for entry in logged if entry[0] == t}, (path.name, t, now)
        compared += 5 + 50
    return compared

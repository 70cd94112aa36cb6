"""One kitchen at one moment in readable form: `KitchenState`, and overcooked_ai's JSON form of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from overcooked_bench.kitchen.codes import ACTION_NAMES, DIRECTIONS, MAX_INGREDIENTS, Position, Recipe

FACINGS = ACTION_NAMES[: len(DIRECTIONS)]


@dataclass(frozen=True)
class Soup:
    """What is in a pot, or a finished soup on a counter or in a chef's hands.

    Attributes:
        recipe: (onions, tomatoes).
        tick: Steps cooked so far; -1 while idle in a pot.
        cook_time: Steps it takes; -1 while idle, and where a foreign state did not say (then the layout decides).
    """

    recipe: Recipe
    tick: int = -1
    cook_time: int = -1

    @property
    def is_idle(self) -> bool:
        """Whether it does not cook yet."""
        return self.tick < 0

    @property
    def is_ready(self) -> bool:
        """Whether a dish would bring it out of its pot."""
        return 0 <= self.cook_time <= self.tick

    @property
    def is_cooking(self) -> bool:
        """Whether it cooks and is not ready."""
        return not self.is_idle and not self.is_ready

    @property
    def remaining(self) -> int:
        """Steps until it is ready; 0 when ready or idle."""
        return max(0, self.cook_time - self.tick) if self.is_cooking else 0


Thing = Literal["onion", "tomato", "dish"] | Soup
"""What can be held or lie on a counter."""


@dataclass(frozen=True)
class Chef:
    """One of the two cooks.

    Attributes:
        position: (x, y).
        facing: "north", "south", "east" or "west".
        holding: What is in the hands, or None.
    """

    position: Position
    facing: str = "north"
    holding: Thing | None = None


@dataclass(frozen=True)
class KitchenState:
    """One kitchen at one moment, readable; `Kitchens.state(i)` gives it and `Kitchens.set_state(i, ...)` takes it.

    Attributes:
        chefs: The chefs on seats 0 and 1.
        objects: (x, y) -> what lies there: things on counters, soups in pots (an empty pot has no entry). Row-major.
        timestep: Steps since the start.
        orders: Recipes that are paid for; None where a foreign state did not say.
        bonus_orders: Recipes that are paid more.
    """

    chefs: tuple[Chef, Chef]
    objects: Mapping[Position, Thing] = field(default_factory=dict)
    timestep: int = 0
    orders: tuple[Recipe, ...] | None = None
    bonus_orders: tuple[Recipe, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Gives overcooked_ai's JSON form of this state."""
        return {
            "players": [
                {
                    "position": list(chef.position),
                    "orientation": list(DIRECTIONS[FACINGS.index(chef.facing)]),
                    "held_object": None if chef.holding is None else _thing_dict(chef.position, chef.holding),
                }
                for chef in self.chefs
            ],
            "objects": [_thing_dict(position, thing) for position, thing in self.objects.items()],
            "bonus_orders": [_recipe_dict(recipe) for recipe in self.bonus_orders],
            "all_orders": [_recipe_dict(recipe) for recipe in self.orders or ()],
            "timestep": self.timestep,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "KitchenState":
        """Reads overcooked_ai's JSON form of a state.

        Args:
            data: The parsed JSON. Derived entries (`is_cooking`, ...) may be missing or stale.

        Raises:
            ValueError: Something is missing or not legal; says which entry.
        """
        try:
            chefs = [
                Chef(
                    _pair(player["position"]),
                    _facing(player["orientation"]),
                    None if player.get("held_object") is None else _thing(player["held_object"]),
                )
                for player in data["players"]
            ]
            objects = {_pair(entry["position"]): _thing(entry) for entry in data["objects"]}
            if len(objects) != len(data["objects"]):
                raise ValueError("two objects lie on the same cell")
            orders = tuple(_dict_recipe(order) for order in data.get("all_orders") or ()) or None
            bonus = tuple(_dict_recipe(order) for order in data.get("bonus_orders") or ())
            timestep = int(data.get("timestep", 0))
        except (KeyError, IndexError, TypeError, AttributeError) as error:
            raise ValueError(f"not a state in overcooked_ai's JSON form: {type(error).__name__}: {error}") from error
        if len(chefs) != 2:
            raise ValueError(f"the state has {len(chefs)} players; a kitchen here has two")
        return cls((chefs[0], chefs[1]), row_major(objects), timestep, orders, bonus)


def row_major(objects: Mapping[Position, Thing]) -> dict[Position, Thing]:
    """Sorts objects by row, then column."""
    return dict(sorted(objects.items(), key=lambda entry: (entry[0][1], entry[0][0])))


def _pair(value: Any) -> Position:
    x, y = value
    return int(x), int(y)


def _facing(value: Any) -> str:
    if _pair(value) not in DIRECTIONS:
        raise ValueError(f"orientation {value!r}; directions are {', '.join(map(str, DIRECTIONS))}")
    return FACINGS[DIRECTIONS.index(_pair(value))]


def _thing(entry: Mapping[str, Any]) -> Thing:
    name = entry["name"]
    if name != "soup":
        if name not in ("onion", "tomato", "dish"):
            raise ValueError(f"an object is named {name!r}; names are onion, tomato, dish and soup")
        return name  # type: ignore[no-any-return]
    recipe = _ingredients([ingredient["name"] for ingredient in entry["_ingredients"]], "a soup")
    tick = int(entry["_cooking_tick"] if "_cooking_tick" in entry else entry["cooking_tick"])
    return Soup(recipe, tick, int(entry.get("cook_time") or -1) if tick >= 0 else -1)


def _thing_dict(position: Position, thing: Thing) -> dict[str, Any]:
    place = {"position": list(position)}
    if not isinstance(thing, Soup):
        return {"name": thing, **place}
    return {
        "name": "soup",
        **place,
        "_ingredients": [{"name": name, **place} for name in _recipe_dict(thing.recipe)["ingredients"]],
        "cooking_tick": thing.tick,
        "_cooking_tick": thing.tick,
        "is_idle": thing.is_idle,
        "is_cooking": thing.is_cooking,
        "is_ready": thing.is_ready,
        "cook_time": thing.cook_time,
    }


def _ingredients(names: Any, what: str) -> Recipe:
    recipe = list(names).count("onion"), list(names).count("tomato")
    if sum(recipe) != len(names) or not 1 <= len(names) <= MAX_INGREDIENTS:
        raise ValueError(f"{what} of {list(names)}; one to three of 'onion' and 'tomato' make a soup")
    return recipe


def _dict_recipe(order: Mapping[str, Any]) -> Recipe:
    return _ingredients(order["ingredients"], "an order")


def _recipe_dict(recipe: Recipe) -> dict[str, Any]:
    return {"ingredients": ["onion"] * recipe[0] + ["tomato"] * recipe[1]}

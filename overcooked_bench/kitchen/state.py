"""One kitchen at one moment in readable form: `KitchenState`, and overcooked_ai's JSON form of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal, NoReturn

from overcooked_bench.kitchen.codes import ACTION_NAMES, DIRECTIONS, MAX_INGREDIENTS, Position, Recipe
from overcooked_bench.kitchen.errors import StateError, said

FACINGS = ACTION_NAMES[: len(DIRECTIONS)]


@dataclass(frozen=True)
class Soup:
    """The content of a pot, or a finished soup on a counter or in a chef's hands.

    Attributes:
        recipe: (onions, tomatoes).
        tick: Steps cooked so far; -1 while idle in a pot.
        cook_time: Steps it takes; -1 while idle, or if a foreign state does not say (then the layout decides).
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
        """Whether a dish can take it out of its pot."""
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
"""An object in hands or on a counter."""


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


class Objects(dict[Position, Thing]):
    """A read-only dict, since several agents may see one state. `dict(objects)` is a copy to change."""

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise TypeError(
            "a state's objects are only read; change a copy, dict(state.objects), and make a state of it with "
            "dataclasses.replace(state, objects=...)"
        )

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type["Objects"], tuple[dict[Position, Thing]]]:
        return Objects, (dict(self),)


@dataclass(frozen=True)
class KitchenState:
    """One kitchen at one moment, readable; `Kitchens.state(i)` gives it and `Kitchens.set_state(i, ...)` takes it.

    Attributes:
        chefs: The chefs on seats 0 and 1.
        objects: (x, y) -> the object there: objects on counters, soups in pots (an empty pot has no entry). Row-major
            and read-only.
        timestep: Steps since the start.
        orders: Recipes that are paid for; None if a foreign state does not say.
        bonus_orders: Recipes that are paid more.
    """

    chefs: tuple[Chef, Chef]
    objects: Mapping[Position, Thing] = field(default_factory=dict)
    timestep: int = 0
    orders: tuple[Recipe, ...] | None = None
    bonus_orders: tuple[Recipe, ...] = ()

    def __post_init__(self) -> None:
        """Copies the objects, so that an agent that gets this state cannot change it for others."""
        if type(self.objects) is not Objects:
            object.__setattr__(self, "objects", Objects(self.objects))

    def to_dict(self) -> dict[str, Any]:
        """Returns overcooked_ai's JSON form of this state."""
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
            StateError: Something is missing or not legal; says which entry.
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
                raise StateError("two objects are on the same cell")
            orders = tuple(_dict_recipe(order) for order in data.get("all_orders") or ()) or None
            bonus = tuple(_dict_recipe(order) for order in data.get("bonus_orders") or ())
            timestep = _whole(data.get("timestep", 0), "timestep")
        except KeyError as error:
            raise StateError(f"not a state in overcooked_ai's JSON form: the entry {error} is missing") from None
        except (IndexError, TypeError, AttributeError) as error:
            raise StateError(f"not a state in overcooked_ai's JSON form: {said(data)}") from error
        if len(chefs) != 2:
            raise StateError(f"the state has {len(chefs)} players; a kitchen here has two")
        return cls((chefs[0], chefs[1]), row_major(objects), timestep, orders, bonus)


_LARGEST: Final = 10**9


def row_major(objects: Mapping[Position, Thing]) -> dict[Position, Thing]:
    """Sorts objects by row, then column."""
    return dict(sorted(objects.items(), key=lambda entry: (entry[0][1], entry[0][0])))


def _whole(value: Any, what: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not -_LARGEST <= value <= _LARGEST:
        raise StateError(f"{what} is {said(value)}; give a whole number")
    return value


def _pair(value: Any, what: str = "a position") -> Position:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise StateError(f"{what} is {said(value)}; give two whole numbers, [x, y]")
    return _whole(value[0], f"x of {what}"), _whole(value[1], f"y of {what}")


def _facing(value: Any) -> str:
    direction = _pair(value, "an orientation")
    if direction not in DIRECTIONS:
        raise StateError(f"orientation {said(value)}; directions are {', '.join(map(str, DIRECTIONS))}")
    return FACINGS[DIRECTIONS.index(direction)]


def _thing(entry: Mapping[str, Any]) -> Thing:
    name = entry["name"]
    if name != "soup":
        if name not in ("onion", "tomato", "dish"):
            raise StateError(f"an object is named {said(name)}; names are onion, tomato, dish and soup")
        return name  # type: ignore[no-any-return]
    recipe = _ingredients([ingredient["name"] for ingredient in entry["_ingredients"]], "a soup")
    tick = _whole(entry["_cooking_tick" if "_cooking_tick" in entry else "cooking_tick"], "a soup's cooking tick")
    time = entry.get("cook_time")
    return Soup(recipe, tick, _whole(time, "a soup's cook time") or -1 if tick >= 0 and time is not None else -1)


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
    names = list(names)[: MAX_INGREDIENTS + 1]
    recipe = names.count("onion"), names.count("tomato")
    if sum(recipe) != len(names) or not 1 <= len(names) <= MAX_INGREDIENTS:
        raise StateError(f"{what} of {said(names)}; one to three of 'onion' and 'tomato' make a soup")
    return recipe


def _dict_recipe(order: Mapping[str, Any]) -> Recipe:
    return _ingredients(order["ingredients"], "an order")


def _recipe_dict(recipe: Recipe) -> dict[str, Any]:
    return {"ingredients": ["onion"] * recipe[0] + ["tomato"] * recipe[1]}

"""Reads the menu below a grid: orders, rewards and cooking times."""

from collections.abc import Mapping, Sequence
from typing import Any, Final, NamedTuple

from overcooked_bench.kitchen.codes import MAX_INGREDIENTS, RECIPES, Recipe
from overcooked_bench.kitchen.errors import LayoutError, said

DEFAULT_SOUP_REWARD: Final = 20
DEFAULT_COOK_TIME: Final = 20
LONGEST_COOK_TIME: Final = 254  # grids are uint8, and 255 would make SB3 take them for images
_LARGEST: Final = 1e9

PerRecipe = float | Mapping[str, float] | Sequence[float]
"""One number for all, one for each ingredient, or one for each order."""


class Menu(NamedTuple):
    """Fields of `Layout`, in its order."""

    orders: tuple[Recipe, ...]
    bonus_orders: tuple[Recipe, ...]
    order_bonus: float
    soup_rewards: tuple[float, ...]
    cook_times: tuple[int, ...]


def read_menu(
    orders: Sequence[Sequence[str]],
    bonus_orders: Sequence[Sequence[str]],
    order_bonus: float,
    soup_reward: PerRecipe,
    cook_time: PerRecipe,
) -> Menu:
    """Reads a menu; arguments as for `Layout.from_text`.

    Raises:
        LayoutError: Names the entry that breaks a rule.
    """
    for key, given in (("orders", orders), ("bonus_orders", bonus_orders)):
        if isinstance(given, str) or not isinstance(given, Sequence):
            raise LayoutError(f"{key} is {said(given)}; give a list of orders, each a list of ingredients")
    if not _is_number(order_bonus) or order_bonus < 0:
        raise LayoutError(f"order_bonus is {said(order_bonus)}; give a factor from 0")
    recipes = tuple(_recipe(order, "orders") for order in orders)
    bonus = tuple(_recipe(order, "bonus_orders") for order in bonus_orders)
    if len(set(recipes)) < len(recipes):
        raise LayoutError(f"orders names a recipe twice: {said([list(order) for order in orders])}")
    if not set(bonus) <= set(recipes or RECIPES[1:]):
        raise LayoutError(f"bonus_orders {said([list(order) for order in bonus_orders])} are not all among the orders")
    values = _per_recipe(soup_reward, recipes, DEFAULT_SOUP_REWARD, "soup_reward")
    times = _per_recipe(cook_time, recipes, DEFAULT_COOK_TIME, "cook_time")
    for recipe, time in zip(RECIPES[1:], times[1:], strict=True):
        if not 1 <= time <= LONGEST_COOK_TIME or time != int(time):
            raise LayoutError(
                f"cook_time makes {said(time)} steps for {recipe[0]} onions and {recipe[1]} tomatoes; "
                f"give whole numbers from 1 to {LONGEST_COOK_TIME}"
            )
    paid = recipes or RECIPES[1:]
    return Menu(
        orders=paid,
        bonus_orders=bonus,
        order_bonus=order_bonus,
        soup_rewards=tuple(
            float(v * (order_bonus if r in bonus else 1) if r in paid else 0)
            for r, v in zip(RECIPES, values, strict=True)
        ),
        cook_times=tuple(int(t) for t in times),
    )


def _recipe(order: Sequence[str], where: str) -> Recipe:
    names = [order] if isinstance(order, str) else list(order) if isinstance(order, Sequence) else []
    if not 1 <= len(names) <= MAX_INGREDIENTS or any(name not in ("onion", "tomato") for name in names):
        raise LayoutError(f"{where} holds {said(order)}; write one to three of 'onion' and 'tomato'")
    return names.count("onion"), names.count("tomato")


def _per_recipe(given: Any, orders: Sequence[Recipe], default: float, key: str) -> list[float]:
    """Resolves one of the three forms to a number for each recipe index."""
    if isinstance(given, Mapping):
        if set(given) != {"onion", "tomato"}:
            raise LayoutError(f"{key} has the keys {said(list(given))}; give both 'onion' and 'tomato'")
        for ingredient in ("onion", "tomato"):
            _number(given[ingredient], f"{key}[{ingredient!r}]")
        return [given["onion"] * onions + given["tomato"] * tomatoes for onions, tomatoes in RECIPES]
    if isinstance(given, Sequence) and not isinstance(given, str):
        if len(given) != len(orders):
            raise LayoutError(f"{key} has {len(given)} numbers for {len(orders)} orders; give one for each")
        for number in given:
            _number(number, key)
        listed = dict(zip(orders, given, strict=True))
        return [listed.get(recipe, default) for recipe in RECIPES]
    return [_number(given, key)] * len(RECIPES)


def _number(given: Any, key: str) -> float:
    if not _is_number(given):
        raise LayoutError(
            f"{key} is {said(given)}; give a finite number, {{'onion': v, 'tomato': v}}, or one number for each order"
        )
    return float(given) if isinstance(given, float) else int(given)


def _is_number(given: Any) -> bool:
    """Returns whether a value is a finite number of a size that rewards can have."""
    return isinstance(given, int | float) and not isinstance(given, bool) and -_LARGEST <= given <= _LARGEST

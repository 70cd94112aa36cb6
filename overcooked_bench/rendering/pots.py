"""Says how far the soup in a pot is."""

from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Soup


def progress(layout: Layout, soup: Soup) -> tuple[int, int] | None:
    """Returns (steps cooked, cook time), or None while idle; a soup without a cook time of its own has the layout's."""
    if soup.is_idle:
        return None
    cook_time = soup.cook_time if soup.cook_time >= 0 else layout.cook_times[RECIPES.index(soup.recipe)]
    return min(soup.tick, cook_time), cook_time

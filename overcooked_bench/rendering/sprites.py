"""Draws every tile, object and chef from circles and polygons."""

from __future__ import annotations

from functools import lru_cache
from math import cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DIRECTIONS, Recipe
from overcooked_bench.kitchen.state import FACINGS, Soup, Thing
from overcooked_bench.rendering.brush import Brush, Colour

MARGIN = 0.25
"""Room around a chef's tile for the object that it holds, tiles."""

CHEF_COLOURS: tuple[Colour, Colour] = ((0, 107, 178), (240, 138, 0))
"""Seats 0 and 1.

Source: blue and orange from the colour-blind safe palette of Okabe and Ito (2008).
"""

FLOORS: tuple[Colour, Colour] = ((246, 239, 226), (237, 227, 209))
COUNTER: Colour = (126, 147, 160)
COUNTER_LIGHT: Colour = (156, 176, 187)
COUNTER_JOINT: Colour = (114, 134, 147)
COUNTER_FRONT: Colour = (79, 97, 109)
COUNTER_SHADOW: Colour = (215, 203, 183)

INK: Colour = (48, 40, 36)
WHITE: Colour = (255, 255, 255)
ONION: Colour = (244, 190, 62)
ONION_LIGHT: Colour = (255, 226, 142)
ONION_INK: Colour = (128, 78, 14)
TOMATO: Colour = (222, 52, 44)
TOMATO_LIGHT: Colour = (248, 138, 120)
TOMATO_INK: Colour = (118, 18, 18)
LEAF: Colour = (58, 132, 56)
DISH: Colour = (250, 251, 252)
DISH_DEEP: Colour = (219, 227, 232)
DISH_INK: Colour = (92, 106, 117)
CRATE: Colour = (150, 104, 62)
CRATE_DARK: Colour = (99, 63, 34)
CRATE_LIGHT: Colour = (184, 137, 90)
SERVING: Colour = (24, 140, 122)
SERVING_LIGHT: Colour = (120, 208, 190)
STOVE: Colour = (58, 64, 70)
STOVE_LIGHT: Colour = (86, 94, 101)
POT: Colour = (176, 186, 193)
POT_INK: Colour = (32, 36, 40)
POT_INSIDE: Colour = (72, 79, 86)
BROTH: Colour = (226, 214, 178)
ONION_SOUP: Colour = (217, 142, 44)
TOMATO_SOUP: Colour = (205, 66, 36)
TRACK: Colour = (24, 27, 30)
COOKING: Colour = (255, 176, 32)
READY: Colour = (96, 214, 122)
READY_INK: Colour = (12, 98, 48)
SKIN: Colour = (250, 212, 176)
HAT_INK: Colour = (128, 134, 142)


def onion(brush: Brush, x: float, y: float, size: float) -> None:
    """Draws an onion about (x, y)."""
    r = 0.43 * size
    y += 0.07 * size
    tip = [(x - 0.62 * r, y - 0.62 * r), (x, y - 1.45 * r), (x + 0.62 * r, y - 0.62 * r)]
    brush.line([(x - 0.12 * r, y - 0.9 * r), (x - 0.16 * r, y - 1.35 * r)], ONION_INK, 0.24 * r)
    brush.line([(x + 0.12 * r, y - 0.9 * r), (x + 0.22 * r, y - 1.3 * r)], ONION_INK, 0.2 * r)
    brush.shape([(px, py + 0.25 * r) for px, py in tip], ONION_INK)
    brush.oval(x, y, 1.05 * r, r, ONION, ONION_INK, 0.13 * r)
    brush.shape([(x - 0.5 * r, y - 0.6 * r), (x, y - 1.0 * r), (x + 0.5 * r, y - 0.6 * r)], ONION)
    brush.oval(x - 0.34 * r, y + 0.02 * r, 0.2 * r, 0.52 * r, ONION_LIGHT)
    brush.oval(x + 0.36 * r, y + 0.06 * r, 0.08 * r, 0.5 * r, ONION_INK)


def tomato(brush: Brush, x: float, y: float, size: float) -> None:
    """Draws a tomato about (x, y)."""
    r = 0.45 * size
    y += 0.04 * size
    brush.oval(x, y, 1.08 * r, r, TOMATO, TOMATO_INK, 0.13 * r)
    brush.oval(x - 0.45 * r, y + 0.1 * r, 0.16 * r, 0.3 * r, TOMATO_LIGHT)
    points = []
    for k in range(10):
        reach = (0.62 if k % 2 == 0 else 0.2) * r
        angle = 2 * pi * k / 10 - pi / 2
        points.append((x + reach * cos(angle), y - 0.58 * r + 0.72 * reach * sin(angle)))
    brush.shape(points, LEAF)
    brush.line([(x, y - 0.6 * r), (x + 0.08 * r, y - 1.12 * r)], LEAF, 0.2 * r)


def dish(brush: Brush, x: float, y: float, size: float) -> None:
    """Draws an empty dish about (x, y)."""
    brush.disc(x, y, 0.5 * size, DISH, DISH_INK, 0.055 * size)
    brush.disc(x, y, 0.31 * size, DISH_DEEP)


def soup(brush: Brush, x: float, y: float, size: float, recipe: Recipe) -> None:
    """Draws a dish full of soup about (x, y), with a mark for each ingredient."""
    brush.disc(x, y, 0.54 * size, DISH, INK, 0.06 * size)
    brush.disc(x, y, 0.41 * size, liquid(recipe))
    marks(brush, x, y, 0.2 * size, 0.33 * size, recipe)


def thing(brush: Brush, x: float, y: float, size: float, what: Thing) -> None:
    """Draws what can be carried about (x, y)."""
    if isinstance(what, Soup):
        soup(brush, x, y, size, what.recipe)
    else:
        {"onion": onion, "tomato": tomato, "dish": dish}[what](brush, x, y, size)


def liquid(recipe: Recipe) -> Colour:
    """Mixes the colour of a soup."""
    share = recipe[1] / sum(recipe)
    return tuple(round(a + share * (b - a)) for a, b in zip(ONION_SOUP, TOMATO_SOUP, strict=True))


def marks(brush: Brush, x: float, y: float, spread: float, size: float, recipe: Recipe) -> None:
    """Draws a recipe's ingredients, small, about (x, y)."""
    kinds = [onion] * recipe[0] + [tomato] * recipe[1]
    for (dx, dy), kind in zip(_places(len(kinds)), kinds, strict=True):
        kind(brush, x + dx * spread, y + dy * spread, size)


def _places(count: int) -> list[tuple[float, float]]:
    if count == 1:
        return [(0, 0)]
    if count == 2:
        return [(-0.9, 0), (0.9, 0)]
    return [(0, -0.95), (-0.95, 0.65), (0.95, 0.65)]


def crate(brush: Brush) -> None:
    """Draws an open wooden crate."""
    brush.box(0.09, 0.09, 0.91, 0.91, CRATE_DARK, 0.08)
    brush.box(0.13, 0.13, 0.87, 0.87, CRATE, 0.05)
    brush.box(0.19, 0.19, 0.81, 0.81, CRATE_DARK, 0.03)
    for x in (0.13, 0.81):
        for y in (0.13, 0.81):
            brush.box(x, y, x + 0.06, y + 0.06, CRATE_LIGHT, 0.02)


def cloche(brush: Brush) -> None:
    """Draws a serving hatch with a covered dish on it."""
    brush.box(0.04, 0.04, 0.96, 0.96, SERVING_LIGHT, 0.1)
    brush.box(0.08, 0.08, 0.92, 0.92, SERVING, 0.07)
    brush.disc(0.5, 0.27, 0.075, WHITE)
    brush.disc(0.5, 0.62, 0.3, WHITE)
    brush.box(0.18, 0.625, 0.82, 0.93, SERVING)
    brush.line([(0.2, 0.71), (0.8, 0.71)], WHITE, 0.09)
    brush.line([(0.34, 0.55), (0.38, 0.46), (0.45, 0.4)], SERVING_LIGHT, 0.05)


@lru_cache(maxsize=256)
def fixture(tile: str, tile_size: int) -> NDArray[np.uint8]:
    """Draws what is fixed to a counter, (tile, tile, 4) uint8: a dispenser, the serving hatch, a stove."""
    brush = Brush(tile_size)
    if tile == "S":
        cloche(brush)
    elif tile == "P":
        brush.box(0.03, 0.03, 0.97, 0.97, POT_INK, 0.1)
        brush.box(0.06, 0.06, 0.94, 0.94, STOVE, 0.08)
    elif tile == "D":
        for y in (0.58, 0.52, 0.46):
            dish(brush, 0.5, y, 0.74)
    else:
        crate(brush)
        kind = onion if tile == "O" else tomato
        for x, y in ((0.36, 0.34), (0.64, 0.34), (0.34, 0.62), (0.66, 0.62), (0.5, 0.49)):
            kind(brush, x, y, 0.36)
    return brush.finish()


@lru_cache(maxsize=2048)
def pot(recipe: Recipe, tick: int, cook_time: int, tile_size: int) -> NDArray[np.uint8]:
    """Draws a pot on its stove, (tile, tile, 4) uint8.

    Args:
        recipe: (onions, tomatoes), (0, 0) for an empty pot.
        tick: Steps cooked, -1 while idle.
        cook_time: Steps until it is ready.
        tile_size: Pixels.
    """
    brush = Brush(tile_size)
    cooking, ready = 0 <= tick < cook_time, 0 <= cook_time <= tick
    if ready:
        brush.box(0.03, 0.03, 0.97, 0.97, READY_INK, 0.1)
        brush.box(0.06, 0.06, 0.94, 0.94, READY, 0.08)
    elif cooking:
        brush.disc(0.5, 0.5, 0.46, TRACK)
        brush.arc(0.5, 0.5, 0.46, tick / cook_time, COOKING, 0.1)
    else:
        brush.disc(0.5, 0.5, 0.42, STOVE_LIGHT)
        brush.disc(0.5, 0.5, 0.39, STOVE)
    for x in (0.1, 0.9):
        brush.box(x - 0.06, 0.42, x + 0.06, 0.58, POT_INK, 0.04)
        brush.box(x - 0.035, 0.445, x + 0.035, 0.555, POT, 0.03)
    brush.disc(0.5, 0.5, 0.36, POT_INK)
    brush.disc(0.5, 0.5, 0.335, POT)
    brush.disc(0.5, 0.5, 0.285, POT_INSIDE)
    if not any(recipe):
        return brush.finish()
    brush.disc(0.5, 0.5, 0.285, liquid(recipe) if cooking or ready else BROTH)
    if cooking:
        _remaining(brush, recipe, cook_time - tick, tile_size)
    else:
        marks(brush, 0.5, 0.5, 0.135, 0.28, recipe)
    if ready:
        brush.disc(0.79, 0.79, 0.18, WHITE)
        brush.disc(0.79, 0.79, 0.15, READY_INK)
        brush.line([(0.72, 0.79), (0.77, 0.85), (0.86, 0.74)], WHITE, 0.045)
    return brush.finish()


def _remaining(brush: Brush, recipe: Recipe, steps: int, tile_size: int) -> None:
    """Writes the remaining steps above a small row of the ingredients; larger figures on small tiles."""
    kinds = [onion] * recipe[0] + [tomato] * recipe[1]
    small = tile_size < 32
    for k, kind in enumerate(kinds):
        kind(brush, 0.5 + 0.16 * (k - (len(kinds) - 1) / 2), 0.76 if small else 0.7, 0.18)
    size = (0.56 if small else 0.42) * (1 if steps < 100 else 0.75)
    brush.text(0.5, 0.44, str(steps), size, WHITE, INK)


@lru_cache(maxsize=512)
def lying(what: Thing, tile_size: int) -> NDArray[np.uint8]:
    """Draws the object on a counter, (tile, tile, 4) uint8."""
    brush = Brush(tile_size)
    brush.oval(0.5, 0.6, 0.3, 0.26, (0, 0, 0, 50))
    thing(brush, 0.5, 0.5, 0.6, what)
    return brush.finish()


@lru_cache(maxsize=512)
def chef(seat: int, facing: str, holding: Thing | None, tile_size: int) -> NDArray[np.uint8]:
    """Draws a chef from above, holding its object in front, (tile + 2 margins, ..., 4) uint8."""
    brush = Brush(tile_size, MARGIN)
    fx, fy = DIRECTIONS[FACINGS.index(facing)]
    colour = CHEF_COLOURS[seat]
    dark = tuple(round(0.55 * c) for c in colour)

    def at(forward: float, aside: float) -> tuple[float, float]:
        forward -= 0.06
        return 0.5 + forward * fx - aside * fy, 0.5 + forward * fy + aside * fx

    def oval(forward: float, deep: float, wide: float, fill: Colour, edge: Colour) -> None:
        brush.oval(*at(forward, 0), *((deep, wide) if fx else (wide, deep)), fill, edge, 0.03)

    x, y = at(0, 0)
    brush.disc(x, y + 0.05, 0.4, (0, 0, 0, 45))
    reach = 0.3
    for side in (-1, 1):
        arm = [at(0.02, 0.29 * side), at(reach, 0.2 * side)]
        brush.line(arm, dark, 0.19)
        brush.line(arm, colour, 0.13)
        brush.disc(*at(reach + 0.03, 0.19 * side), 0.09, SKIN, INK)
    oval(0, 0.27, 0.4, colour, dark)
    brush.disc(*at(0.05, 0), 0.26, SKIN, INK)
    for side in (-1, 1):
        brush.disc(*at(0.2, 0.11 * side), 0.05, INK)
    brush.disc(*at(-0.08, 0), 0.235, colour, dark)
    for k in range(6):
        brush.disc(*at(-0.09 + 0.115 * cos(pi * k / 3), 0.115 * sin(pi * k / 3)), 0.1, WHITE, HAT_INK, 0.02)
    brush.disc(*at(-0.09, 0), 0.14, WHITE)
    if holding is not None:
        thing(brush, *at(0.43, 0.1), 0.42, holding)
    return brush.finish()

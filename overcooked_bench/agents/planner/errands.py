"""Chooses a scripted chef's next errand from both chefs' hands, the needs of the pots and the partner's activity."""

from typing import Final

import numpy as np

from overcooked_bench.agents.planner.facts import (
    ACTIVE,
    AT,
    BEST,
    BITS,
    CLEAR,
    COOKS,
    DISHES,
    DISHES_WANTED,
    ERRAND,
    FOOD_PLACES,
    FOOD_ROOM,
    FOOD_WANTED,
    FOODS,
    GOAL,
    HAND,
    HAND_OVER,
    ME,
    NEED,
    PARTNER,
    PARTNER_BEST,
    PARTNER_DISH,
    PARTNER_FOOD,
    PARTNER_HAND,
    PUT_DOWN,
    ROLE,
    ROOM,
    SERVES,
    SHARED,
    SOONEST,
    SOUPS,
    START,
    STARTS,
    USE,
    USE_STEPS,
    WAIT,
    Facts,
)
from overcooked_bench.agents.planner.tables import DISH, FAR, NOTHING, ONION, SOUP, TOMATO
from overcooked_bench.kitchen.jit import jit

GREEDY, ONION_COURIER, DISH_COURIER = range(3)

_EARLY: Final = 3  # steps that a dish may come before its soup
_LAY_DOWN: Final = 2  # steps it takes to have one's hands free


def choose(facts: Facts) -> None:
    """Sets GOAL, the tile to work at, or -1 if there is nothing to do but wait.

    Args:
        facts: (B, FACTS), as `weigh`, `trust` and `take_jobs` leave them.
    """
    _judge(facts)
    _empty_handed(facts)
    _with_dish(facts)
    _with_food(facts)
    errands = facts[:, ERRAND]
    facts[:, GOAL] = np.where(errands == WAIT, -1, facts[np.arange(len(facts)), AT + errands])


@jit
def _judge(facts: Facts) -> None:
    """Finds what is missing that the partner does not supply; decides at once if its hands determine the errand."""
    for row in range(facts.shape[0]):
        f = facts[row]
        there = 0 if f[COOKS] else 1
        f[DISHES_WANTED] = f[SOUPS] - f[PARTNER_DISH] - there * f[DISHES]
        f[FOOD_WANTED] = f[NEED] - f[PARTNER_FOOD] - there * f[FOODS]
        spare = f[ROOM] > 1 or (f[ROOM] == 1 and (f[DISHES] > 0 or f[SHARED] == 1))
        f[FOOD_ROOM] = f[COOKS] or (spare and f[FOOD_PLACES] > 0)
        nearer = f[PARTNER_BEST + START] < f[BEST + START] or (
            f[PARTNER_BEST + START] == f[BEST + START] and f[PARTNER] < f[ME]
        )
        f[STARTS] = f[COOKS] and f[AT + START] >= 0 and not (f[ACTIVE] and f[PARTNER_HAND] == NOTHING and nearer)
        f[ERRAND] = WAIT
        if f[HAND] == SOUP:
            f[ERRAND] = USE if f[SERVES] else HAND_OVER
            if f[AT + f[ERRAND]] < 0:
                f[ERRAND] = PUT_DOWN
        if (f[HAND] > TOMATO and f[ROLE] == ONION_COURIER) or (NOTHING < f[HAND] < DISH and f[ROLE] == DISH_COURIER):
            f[ERRAND] = PUT_DOWN


@jit
def _empty_handed(facts: Facts) -> None:
    for row in range(facts.shape[0]):
        f = facts[row]
        if f[HAND] != NOTHING:
            continue
        onions, tomatoes = f[BITS] >> ONION & 1, f[BITS] >> TOMATO & 1
        food = TOMATO if tomatoes and (not onions or f[BEST + TOMATO] < f[BEST + ONION]) else ONION
        dish_steps, food_steps = f[BEST + DISH], f[BEST + food]
        brings_dish = f[ROLE] != ONION_COURIER and dish_steps < FAR
        brings_food = f[ROLE] != DISH_COURIER and food_steps < FAR and f[FOOD_ROOM]
        free = f[ROLE] == GREEDY and f[COOKS] and f[ACTIVE] and f[PARTNER_HAND] == NOTHING
        partner_dish, partner_food = f[PARTNER_BEST + DISH] if free else FAR, f[PARTNER_BEST + food] if free else FAR
        first = f[ME] < f[PARTNER]  # where all else is equal
        takes_dish = brings_dish and f[DISHES_WANTED] > 0
        takes_food = brings_food and f[FOOD_WANTED] > 0
        if takes_dish and takes_food:
            due = f[SOONEST] <= dish_steps + _EARLY * (1 if f[COOKS] else 3)
            if due and partner_dish < FAR and partner_food < FAR:
                due = dish_steps + partner_food < food_steps + partner_dish + first
            takes_food = not due
        elif takes_dish:
            takes_dish = f[DISHES_WANTED] > 1 or dish_steps < partner_dish + first
        elif takes_food:
            takes_food = f[FOOD_WANTED] > 1 or food_steps < partner_food + first
        ahead_dish = f[ROLE] == DISH_COURIER or (f[COOKS] and f[SOUPS] == 0 and f[NEED] > 0 and not f[PARTNER_DISH])
        ahead_food = f[ROLE] == ONION_COURIER or not f[COOKS] or (f[PARTNER_DISH] and f[SOUPS] == 1)
        if f[STARTS]:
            f[ERRAND] = START
        elif f[ROLE] != ONION_COURIER and f[SERVES] and f[AT + SOUP] >= 0:
            f[ERRAND] = SOUP
        elif takes_food or (brings_food and ahead_food and not takes_dish and not (brings_dish and ahead_dish)):
            f[ERRAND] = food
        elif takes_dish or (brings_dish and ahead_dish):
            f[ERRAND] = DISH
        elif f[SHARED] > 0 and f[ROOM] == 0 and f[DISHES_WANTED] > 0 and f[DISHES] == 0:
            f[ERRAND] = CLEAR


@jit
def _with_dish(facts: Facts) -> None:
    for row in range(facts.shape[0]):
        f = facts[row]
        if f[HAND] != DISH or f[ROLE] == ONION_COURIER:
            continue
        wanted = f[DISHES_WANTED] > 0
        nearer = f[PARTNER_BEST + USE] < f[BEST + USE] + (f[PARTNER] < f[ME])
        if not f[COOKS]:
            if f[ROOM] > 0 and (wanted or f[DISHES] == 0):
                f[ERRAND] = HAND_OVER
            elif wanted or f[FOOD_WANTED] > 0:
                f[ERRAND] = PUT_DOWN
        elif f[SOUPS] > 0 and not (f[SOUPS] == 1 and f[PARTNER_DISH] and nearer):
            if f[STARTS]:
                f[ERRAND] = PUT_DOWN
            elif f[BEST + USE] <= f[USE_STEPS] + 1:
                f[ERRAND] = USE
        elif f[ROLE] == GREEDY and f[FOOD_WANTED] > 0:
            f[ERRAND] = PUT_DOWN


@jit
def _with_food(facts: Facts) -> None:
    for row in range(facts.shape[0]):
        f = facts[row]
        if not NOTHING < f[HAND] < DISH or f[ROLE] == DISH_COURIER:
            continue
        wanted, first = f[DISHES_WANTED], f[PARTNER] < f[ME]
        if f[BITS] and not f[BITS] >> f[HAND] & 1:
            f[ERRAND] = PUT_DOWN
        elif not f[COOKS]:
            if f[FOOD_ROOM]:
                f[ERRAND] = HAND_OVER
            elif wanted > 0:
                f[ERRAND] = PUT_DOWN
        elif f[AT + USE] >= 0 and not (
            f[NEED] == 1 and f[PARTNER_FOOD] and f[PARTNER_BEST + USE] < f[BEST + USE] + first
        ):
            f[ERRAND] = USE
        elif f[ROLE] == GREEDY:
            partner_steps = f[PARTNER_BEST + DISH] - (_LAY_DOWN if f[PARTNER_HAND] == NOTHING else 0)
            partner_goes = f[ACTIVE] and (f[PARTNER_HAND] == NOTHING or f[PARTNER_FOOD])
            partner_goes = partner_goes and wanted == 1 and partner_steps < f[BEST + DISH] + first
            if f[STARTS] or (wanted > 0 and f[BEST + DISH] < FAR and not partner_goes):
                f[ERRAND] = PUT_DOWN

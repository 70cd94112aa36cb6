"""What a scripted chef does next: an errand, chosen from what is held, what the pots need and what the mate does."""

from typing import Final

from overcooked_bench.agents.looking import (
    ACTIVE,
    AT,
    BEST,
    BITS,
    CLEAR,
    COOKS,
    DISHES,
    FOODS,
    GOAL,
    HAND,
    HAND_OVER,
    MATE,
    MATE_DISH,
    MATE_FOOD,
    MATE_HAND,
    MATES,
    ME,
    NEED,
    PUT_DOWN,
    ROOM,
    SAME,
    SERVES,
    SHARED,
    SOONEST,
    SOUPS,
    START,
    USE,
    USE_STEPS,
    WAIT,
    Facts,
)
from overcooked_bench.agents.planning import DISH, FAR, NOTHING, ONION, SOUP, TOMATO
from overcooked_bench.kitchen.jit import jit

GREEDY, ONION_COURIER, DISH_COURIER = range(3)

_EARLY: Final = 3  # steps that a dish may come before its soup
_LAY_DOWN: Final = 2  # steps it takes to have one's hands free


@jit
def choose(facts: Facts, role: int) -> None:
    """Sets GOAL, the tile to work at, or -1 where there is nothing to do but wait.

    Args:
        facts: (B, FACTS), as `tally` and `trust` leave them.
        role: GREEDY, ONION_COURIER or DISH_COURIER.
    """
    for row in range(facts.shape[0]):
        f = facts[row]
        there = 0 if f[COOKS] else 1
        dishes = f[SOUPS] - f[MATE_DISH] - there * f[DISHES]
        food = f[NEED] - f[MATE_FOOD] - there * f[FOODS]
        room = f[COOKS] or f[ROOM] > 1 or (f[ROOM] == 1 and (f[DISHES] > 0 or f[SHARED] == 1))
        nearer = f[MATES + START] < f[BEST + START] or (f[MATES + START] == f[BEST + START] and f[MATE] < f[ME])
        starts = f[COOKS] and f[AT + START] >= 0 and not (f[ACTIVE] and f[MATE_HAND] == NOTHING and nearer)
        hand = f[HAND]
        if hand == NOTHING:
            errand = START if starts else _empty_handed(f, role, dishes, food, room)
        elif hand == SOUP:
            errand = USE if f[SERVES] else HAND_OVER
            if role == ONION_COURIER or f[AT + errand] < 0:
                errand = PUT_DOWN
        elif hand == DISH:
            errand = PUT_DOWN if role == ONION_COURIER else _with_dish(f, role, dishes, food, starts)
        else:
            errand = PUT_DOWN if role == DISH_COURIER else _with_food(f, role, dishes, room, starts)
        f[GOAL] = f[AT + errand] if errand != WAIT else -1


@jit
def _empty_handed(f: Facts, role: int, dishes: int, food: int, room: bool) -> int:
    if role != ONION_COURIER and f[SERVES] and f[AT + SOUP] >= 0:
        return SOUP
    kind = (
        TOMATO if f[BITS] >> TOMATO & 1 and (not f[BITS] >> ONION & 1 or f[BEST + TOMATO] < f[BEST + ONION]) else ONION
    )
    dish_steps, food_steps = f[BEST + DISH], f[BEST + kind]
    brings_dish = role != ONION_COURIER and dish_steps < FAR
    brings_food = role != DISH_COURIER and food_steps < FAR and room
    takes_dish, takes_food = brings_dish and dishes > 0, brings_food and food > 0
    free = role == GREEDY and f[COOKS] and f[ACTIVE] and f[MATE_HAND] == NOTHING
    mate_dish, mate_food = f[MATES + DISH] if free else FAR, f[MATES + kind] if free else FAR
    if takes_dish and takes_food:
        due = f[SOONEST] <= dish_steps + _EARLY * (1 if f[COOKS] else 3)
        if due and mate_dish < FAR and mate_food < FAR:
            apart = dish_steps + mate_food - food_steps - mate_dish
            due = apart < 0 or (apart == 0 and f[ME] < f[MATE])
        return DISH if due else kind
    if takes_dish and not (dishes == 1 and (mate_dish < dish_steps or (mate_dish == dish_steps and f[MATE] < f[ME]))):
        return DISH
    if takes_food and not (food == 1 and (mate_food < food_steps or (mate_food == food_steps and f[MATE] < f[ME]))):
        return kind
    if brings_dish and (role == DISH_COURIER or (f[COOKS] and f[SOUPS] == 0 and f[NEED] > 0 and not f[MATE_DISH])):
        return DISH
    if brings_food and (role == ONION_COURIER or not f[COOKS] or (f[MATE_DISH] and f[SOUPS] == 1)):
        return kind
    if not f[SAME] and f[SHARED] > 0 and f[ROOM] == 0 and dishes > 0 and f[DISHES] == 0:
        return CLEAR
    return WAIT


@jit
def _with_dish(f: Facts, role: int, dishes: int, food: int, starts: bool) -> int:
    if not f[COOKS]:
        if f[ROOM] > 0 and (dishes > 0 or f[DISHES] == 0):
            return HAND_OVER
        return PUT_DOWN if dishes > 0 or food > 0 else WAIT
    nearer = f[MATES + USE] < f[BEST + USE] or (f[MATES + USE] == f[BEST + USE] and f[MATE] < f[ME])
    if f[SOUPS] > 0 and not (f[SOUPS] == 1 and f[MATE_DISH] and nearer):
        if starts:
            return PUT_DOWN
        return USE if f[BEST + USE] <= f[USE_STEPS] + 1 else WAIT
    return PUT_DOWN if role == GREEDY and food > 0 else WAIT


@jit
def _with_food(f: Facts, role: int, dishes: int, room: bool, starts: bool) -> int:
    if f[BITS] and not f[BITS] >> f[HAND] & 1:
        return PUT_DOWN
    if not f[COOKS]:
        if room:
            return HAND_OVER
        return PUT_DOWN if dishes > 0 else WAIT
    nearer = f[MATES + USE] < f[BEST + USE] or (f[MATES + USE] == f[BEST + USE] and f[MATE] < f[ME])
    if f[AT + USE] >= 0 and not (f[NEED] == 1 and f[MATE_FOOD] and nearer):
        return USE
    if role != GREEDY:
        return WAIT
    steps, mates = f[BEST + DISH], f[MATES + DISH] - (_LAY_DOWN if f[MATE_HAND] == NOTHING else 0)
    mate_goes = f[ACTIVE] and dishes == 1 and (mates < steps or (mates == steps and f[MATE] < f[ME]))
    mate_goes = mate_goes and (f[MATE_HAND] == NOTHING or f[MATE_FOOD])
    return PUT_DOWN if starts or (dishes > 0 and steps < FAR and not mate_goes) else WAIT

"""Writes a moment as a scenario: the tested agent in the scored agent's place, beside a cook with the partner's habits.

A scenario cannot hold a network, so its partner is a behaviour that keeps to what the two have to agree on: it does
whatever is most useful, and hands objects over on the counters that the partner uses with a copy of itself.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from math import ceil
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.agents.seated import Seated
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.explaining.casting import GREEDY, Played
from overcooked_bench.evaluation.explaining.continuing import play_on
from overcooked_bench.evaluation.explaining.conventions import counts_of
from overcooked_bench.evaluation.explaining.moments import STEPS
from overcooked_bench.evaluation.explaining.reasons import Reason
from overcooked_bench.evaluation.games.play import make_kitchens
from overcooked_bench.kitchen.codes import Position
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.scenarios import SUFFIX
from overcooked_bench.scenarios.language.loading import read_scenario
from overcooked_bench.scenarios.language.predicates import parse_any_of
from overcooked_bench.scenarios.language.writing import scenario_text
from overcooked_bench.scenarios.scenario import Scenario

_CATEGORIES: Final[Mapping[Reason, str]] = {"clash": "convention"}
"""Category of scenarios of a reason; `state` for the others."""

_SLACK, _MARGIN = 1.5, 4  # of budgets, as the language's `auto` has them: shortest known way * slack + margin


def write_scenario(played: Played, moment: int, reason: Reason, name: str, why: str) -> str | None:
    """Writes a moment as a scenario.

    Args:
        played: What was played from it on.
        moment: Its index.
        reason: Why the pair failed.
        name: The scenario's id.
        why: What happened, in a sentence.

    Returns:
        The content of `<name>.scenario.yaml`; None if the language cannot say what is in this kitchen, or if not even
        `greedy` reaches a soup with this partner.
    """
    layout = Layout.load(played.task.layout)
    seat = played.task.moments[moment].episode.seat
    state = played.continued.states[played.of(moment, "pair")[0]]
    drawn: dict[str, Any] = {"does": "helper"}
    if counters := _counters(played, moment):
        drawn["counters"] = [list(cell) for cell in counters]
    goal = _goal(played, layout, state, seat, drawn)
    if goal is None:
        return None
    soups, budget = goal
    return _written(
        Scenario(
            id=name,
            category=_CATEGORIES.get(reason, "state"),
            family=layout.name if "\n" not in layout.name else "grid",
            layout=layout,
            cooking=played.task.cooking,
            state=replace(state, timestep=0, chefs=(state.chefs[seat], state.chefs[1 - seat])),
            behaviour=parse_behaviour(drawn),
            accept=parse_any_of([f"score >= {soups * layout.soup_points:g}"], layout),
            never=None,
            budget=budget,
            before=(),
            pair=None,
            tags=(reason.replace(" ", "-"),),
            why=why,
            source="",
            drawn=drawn,
        )
    )


def _written(scenario: Scenario) -> str | None:
    """Returns a scenario's text if the same state is read from it."""
    try:
        text = scenario_text(scenario)
        read = read_scenario(text, scenario.id + SUFFIX)
    except WrongUse:
        return None
    layout, state = scenario.layout, replace(scenario.state, orders=None, bonus_orders=())
    return text if read.layout == layout and read.state == state else None


def _counters(played: Played, moment: int) -> list[Position]:
    """Lists the counters over which the partner and a copy of it hand objects over; greedy's if they use none.

    A counter counts if at least a quarter of the hand-overs of an object are there.
    """
    for pairing in ("partner", "greedy"):
        handed: dict[str, Counter[Position]] = {}
        for counts in counts_of(played, moment, pairing):
            for (cell, item, _), times in counts.handed.items():
                handed.setdefault(item, Counter())[cell] += times
        if handed:
            usual = {cell for of in handed.values() for cell, times in of.items() if 4 * times >= of.total()}
            return sorted(usual, key=lambda cell: cell[::-1])
    return []


def _goal(
    played: Played, layout: Layout, state: KitchenState, seat: int, drawn: Mapping[str, Any]
) -> tuple[int, int] | None:
    """Finds what to ask for: the first soup, or the first one more than this partner delivers beside one who stays.

    Returns:
        Soups and a budget; None if `greedy` reaches none with this partner.
    """
    reached = _deliveries(played, layout, state, seat, drawn, GREEDY)
    alone = _deliveries(played, layout, state, seat, drawn, "stay")
    goals = [(soups, _budget(step)) for soups, step in enumerate(reached, start=1)]
    needed = [(soups, budget) for soups, budget in goals if len([step for step in alone if step <= budget]) < soups]
    return next(iter(needed or goals), None)


def _deliveries(
    played: Played, layout: Layout, state: KitchenState, seat: int, drawn: Mapping[str, Any], agent: str
) -> list[int]:
    """Returns after how many steps a scripted agent and a behaviour deliver each of their soups."""
    seats = {agent: (seat, SCRIPTED[agent].factory(layout)), "B": (1 - seat, ScriptAgent(parse_behaviour(drawn)))}
    parties = [Seated(one, name, np.zeros(1, np.int64), np.array([at])) for name, (at, one) in seats.items()]
    kitchens = make_kitchens(layout, 1, parties, cooking=played.task.cooking, horizon=STEPS)
    kitchens.reset(seed=0)
    kitchens.set_state(0, replace(state, timestep=0))
    none: NDArray[np.uint8] = np.zeros((0, 1, 2), np.uint8)
    found = play_on(kitchens, parties, np.zeros((1, 2), np.uint64), none, np.zeros(1, np.int64), STEPS)
    soups = (found.rewards[:, 0] > 0).sum(axis=1)
    return (np.repeat(np.arange(STEPS), soups) + 1).tolist()


def _budget(steps: int) -> int:
    return min(STEPS, ceil(_SLACK * steps) + _MARGIN)

"""Finds the exact shortest solution of a scenario, with the partner that the scenario has."""

from typing import TYPE_CHECKING, Final, NamedTuple

from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.solving.search import MOST_STATES, Search, TooManyStates

if TYPE_CHECKING:
    from overcooked_bench.scenarios.scenario import Situation

LONGEST: Final = 80
"""Steps after which a scenario without a budget counts as unsolvable."""


class Solution(NamedTuple):
    """A shortest solution.

    Attributes:
        steps: T*.
        actions: Chef A's T* actions, which pass with the scenario's partner.
    """

    steps: int
    actions: tuple[int, ...]


def solve(situation: "Situation", limit: int | None = None) -> Solution | None:
    """Finds a shortest solution by search over both chefs' joint state.

    Args:
        situation: A scenario from one seat.
        limit: Steps; by default the scenario's own budget, or `LONGEST` if it has none.

    Returns:
        The solution, or None if there is none within the limit.

    Raises:
        ScenarioError: The search was given up before anything was known.
    """
    if limit is None:
        limit = LONGEST if situation.scenario.budget is None else situation.scenario.budget
    search = search_for(situation)
    row, counts = search.row(situation.state), search.no_counts()
    for joint in situation.before:
        row, _ = search.step(row, counts, joint)
    try:
        found = search.run(row, counts, situation.behaviour, 0, limit, MOST_STATES)
    except TooManyStates as error:
        raise ScenarioError(
            f"{situation.scenario.source}: {situation.id}: {error}; check whether `accept` and `never` exclude each "
            "other, give a smaller budget, or ask for less"
        ) from None
    return None if found is None else Solution(len(found.actions), found.actions)


def search_for(situation: "Situation") -> Search:
    """Prepares a search for the goal of a situation."""
    scenario = situation.scenario
    goal = (situation.accept, situation.never, situation.counters)
    return Search(situation.layout, scenario.cooking, situation.seat, *goal)

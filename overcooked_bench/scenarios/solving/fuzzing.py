"""Random kitchens of a family: hypothesis searches for one that can be solved and that the agent fails, and shrinks it.

A's cell and hands, the content of the pots and the objects on the counters are random. B's behaviour, B's start and the
condition are those of one of the family's scenarios.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from overcooked_bench.kitchen.codes import MAX_INGREDIENTS, Position
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS, Chef, KitchenState, Soup, Thing, row_major
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import Item
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.language.picture import finished_soup
from overcooked_bench.scenarios.results import ItemResult
from overcooked_bench.scenarios.scenario import SEATS, Scenario, Situation
from overcooked_bench.scenarios.solving.lock import budget_for
from overcooked_bench.scenarios.solving.solver import solve

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

LONGEST: Final = 30
"""Longest shortest solution, in steps; kitchens that take more are left out, as solving them takes long."""

MOST_CLUTTER: Final = 3
"""Objects put on counters besides those that the scenario needs."""


class Search(NamedTuple):
    """The result of a search for a kitchen that the agent fails.

    Attributes:
        tried: Kitchens that can be solved and were played.
        failure: The result of the smallest one that the agent failed; None if it failed none.
    """

    tried: int
    failure: ItemResult | None


def search_failure(scenarios: Sequence[Scenario], play: Callable[[list[Item]], list[ItemResult]], most: int) -> Search:
    """Searches for the smallest kitchen of a family that the agent fails; tries the same kitchens every time.

    Args:
        scenarios: The family's scenarios without `before`.
        play: Plays items with the tested agent.
        most: How many solvable kitchens to try.

    Raises:
        ScenarioFault: The agent broke the contract.
    """
    import hypothesis
    from hypothesis.errors import NoSuchExample, Unsatisfiable

    tried = 0

    def fails(drawn: Situation) -> bool:
        nonlocal tried
        item = _item(drawn)
        hypothesis.assume(item is not None)
        assert item is not None
        tried += 1
        return not play([item])[0].passed

    phases = (hypothesis.Phase.generate, hypothesis.Phase.shrink)
    settings = hypothesis.settings(max_examples=most, deadline=None, derandomize=True, database=None, phases=phases)
    try:
        smallest = hypothesis.find(_situations(scenarios), fails, settings=settings)
    except (NoSuchExample, Unsatisfiable):
        return Search(tried, None)
    found = _item(smallest)
    assert found is not None
    return Search(tried, play([found])[0])


def _situations(scenarios: Sequence[Scenario]) -> "SearchStrategy[Situation]":
    """Returns a strategy of situations; shrinking ends at the first of each list of choices."""
    from hypothesis import strategies as st

    @st.composite
    def drawn(draw: Any) -> Situation:
        scenario = draw(st.sampled_from(scenarios))
        layout, (first, second) = scenario.layout, scenario.state.chefs
        holding = st.sampled_from(_unique(None, first.holding, "onion", "dish"))
        chef = Chef(draw(st.sampled_from(_cells(scenario))), draw(st.sampled_from(FACINGS)), draw(holding))
        objects: dict[Position, Thing] = {}
        for pot in layout.positions("P"):
            content = draw(st.sampled_from(_fillings(layout, scenario.state.objects.get(pot), scenario.cooking)))
            if content is not None:
                objects[pot] = content
        for cell, thing in scenario.state.objects.items():
            if layout.tile(cell) == "X" and draw(st.booleans()):
                objects[cell] = thing
        free = sorted(set(layout.positions("X")) - set(objects))
        thing_on = st.tuples(st.sampled_from(free), st.sampled_from(("onion", "dish"))) if free else st.nothing()
        clutter = draw(st.lists(thing_on, max_size=MOST_CLUTTER if free else 0, unique_by=lambda pair: pair[0]))
        state = KitchenState((chef, second), row_major({**objects, **dict(clutter)}))
        changed = replace(scenario, id=f"{scenario.family}-drawn", state=state, budget=None, pair=None, source="drawn")
        situation: Situation = changed.seated(draw(st.sampled_from(SEATS)))
        return situation

    return drawn()


def _item(drawn: Situation) -> Item | None:
    """Makes an item of a situation, with its budget; None if it cannot be solved or solves itself."""
    try:
        solution = solve(drawn, LONGEST)
    except ScenarioError:  # too many states
        return None
    if solution is None or not solution.steps:
        return None
    budget = budget_for(drawn.scenario.category, solution.steps)
    if judge(drawn, budget, []).passed:
        return None
    situation = replace(drawn.scenario, budget=budget).seated(drawn.seat)
    return Item(situation.id, (situation,), situation.scenario.family, situation.scenario.tags)


def _cells(scenario: Scenario) -> list[Position]:
    """Lists the cells of A's part of the kitchen, the one in the picture first."""
    regions, (first, second) = scenario.layout.regions, scenario.state.chefs
    here = [cell for cell in regions if regions[cell] == regions[first.position] and cell != second.position]
    return sorted(here, key=lambda cell: (cell != first.position, cell[1], cell[0]))


def _fillings(layout: Layout, given: Thing | None, cooking: str) -> list[Thing | None]:
    """Lists what a pot may hold: nothing, its content in the scenario, some onions, a finished soup."""
    most = MAX_INGREDIENTS - (cooking == "auto")
    return _unique(None, given, *(Soup((onions, 0)) for onions in range(1, most + 1)), finished_soup(layout))


def _unique(*things: Thing | None) -> list[Thing | None]:
    return list(dict.fromkeys(things))

"""Checks of pairs of scenarios.

A pair of the category `memory` looks the same when A is asked for the first time, and no agent without memory of what
happened before can pass it. Any other pair is about what must not matter: its halves differ in objects far away.
"""

from overcooked_bench.kitchen.codes import PICTURE_NAMES
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.scenario import SEATS, Scenario, Situation
from overcooked_bench.scenarios.solving.lock import budget_of, entry_of, situations
from overcooked_bench.scenarios.solving.memory import unknowing
from overcooked_bench.scenarios.solving.solver import search_for


def pair_faults(one: Scenario, other: Scenario) -> list[str]:
    """Lists what is wrong with a pair, one sentence each; an empty list if nothing is."""
    if one.category == "memory":
        return _faults_of_memory(one, other)
    return _faults_of_invariance(one, other)


def _faults_of_memory(one: Scenario, other: Scenario) -> list[str]:
    faults = []
    for half in (one, other):
        if not half.before:
            return [f"{half.id} has no `before`; the halves of a memory pair differ in what happened before"]
        faults += _faults_of_history(half.seated(0))
    if len(one.before) != len(other.before):
        faults.append("one `before` is longer than the other, so the clock gives away which one it is")
    for seat in SEATS:
        try:
            ways = unknowing(one.seated(seat), other.seated(seat), (budget_of(one), budget_of(other)))
        except ValueError as error:
            return [*faults, str(error)]
        if ways:
            told = " ".join(PICTURE_NAMES[action] for action in ways[0].actions)
            steps = " and ".join(f"{n} steps" for n in ways[0].steps)
            faults.append(
                f"it takes no memory from seat {seat}: {told}, then what the kitchen shows, passes in {steps}"
            )
    return faults


def _faults_of_history(situation: Situation) -> list[str]:
    """Compares B's actions in `before` with those of its behaviour."""
    behaviour, name = situation.behaviour, situation.scenario.id
    if any(behaviour.phase(t) for t in range(len(situation.before) + 1)):
        return [f"B of {name} goes by the clock, so nothing before says what it will do"]
    search = search_for(situation)
    row, counts = search.row(situation.state), search.no_counts()
    for t, joint in enumerate(situation.before):
        action = search.answer(row, behaviour, 0)
        if action != joint[situation.partner_seat]:
            did = PICTURE_NAMES[joint[situation.partner_seat]]
            return [f"B of {name} does {did} at step {t} of `before`; its behaviour would do {PICTURE_NAMES[action]}"]
        row, _ = search.step(row, counts, joint)
    return []


def _faults_of_invariance(one: Scenario, other: Scenario) -> list[str]:
    if _essence(one) != _essence(other) or one.state.objects == other.state.objects:
        return ["halves of a pair that is not about memory must differ in the objects on counters, and only there"]
    faults = []
    for first, second in ((one, other), (other, one)):
        witnesses = entry_of(first).witnesses
        for key, situation in situations(second).items():
            if not judge(situation, witnesses[key].steps, witnesses[key].own).passed:
                faults.append(f"it does matter: what passes {first.id} from {key} does not pass {second.id}")
    return faults


def _essence(scenario: Scenario) -> list[object]:
    """Returns everything except the objects on counters."""
    layout, state = scenario.layout, scenario.state
    pots = [state.objects.get(cell) for cell in layout.positions("P")]
    goal = str(scenario.accept), str(scenario.never), scenario.budget
    return [layout, scenario.cooking, scenario.category, state.chefs, pots, scenario.drawn, scenario.before, goal]

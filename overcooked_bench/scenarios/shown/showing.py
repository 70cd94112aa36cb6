"""Shows a scenario to people: the kitchen, the chefs' hands, the condition, and the frames of a shortest solution."""

from overcooked_bench.kitchen.codes import PICTURE_NAMES
from overcooked_bench.rendering.text import describe, film
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.language.terms import Either
from overcooked_bench.scenarios.language.writing import behaviour_text
from overcooked_bench.scenarios.scenario import Situation
from overcooked_bench.scenarios.solving.lock import entry_of, known_entry, situations


def show(situation: Situation, *, colour: bool = False) -> str:
    """Draws a situation and states its condition.

    Args:
        situation: A scenario from one seat, plain or mirrored.
        colour: Whether to use a terminal's colours.
    """
    scenario, state = situation.scenario, situation.state
    names = "AB" if situation.seat == 0 else "BA"
    layout = "a grid of its own" if "\n" in situation.layout.name else situation.layout.name
    lines = [
        f"{situation.id}: {scenario.category}, family {scenario.family}, {layout}",
        scenario.why,
        "",
        film(situation.layout, state, colour=colour, legend=False, names=names),
        "",
    ]
    for name, seat in (("A", situation.seat), ("B", situation.partner_seat)):
        chef = state.chefs[seat]
        x, y = chef.position
        lines.append(f"{name} at ({x}, {y}) holds {describe(chef.holding)}")
    where = ", mirrored" if situation.mirrored else ""
    lines += [f"B's part{where}: {behaviour_text(scenario)}", *_asked(situation)]
    if situation.before:
        played = [
            f"{name} {' '.join(PICTURE_NAMES[joint[names.index(name)]] for joint in situation.before)}" for name in "AB"
        ]
        lines.append(f"before: {'; '.join(played)}")
    entry = known_entry(scenario)
    budget = scenario.budget or (entry.budget if entry else None)
    told = f"{budget} steps" if budget else "auto: 1.5 times the shortest solution plus 4"
    lines.append(f"budget: {told}{f'; the shortest solution takes {entry.steps}' if entry else ''}")
    for word, value in (("pair", scenario.pair), ("tags", ", ".join(scenario.tags))):
        lines += [f"{word}: {value}"] if value else []
    return "\n".join(lines)


def show_solution(situation: Situation, *, colour: bool = False, width: int = 100) -> str:
    """Draws a shortest solution step by step; if the lock file has none, it searches for one, which takes seconds.

    Raises:
        ScenarioError: There is none.
    """
    scenario = situation.scenario
    entry = entry_of(scenario)
    key = next(name for name, each in situations(scenario).items() if each.id == situation.id)
    witness = entry.witnesses[key]
    run = judge(situation, scenario.budget or entry.budget, witness.own)
    told = f"a shortest solution, {witness.steps} steps"
    return f"{told}\n\n{run.film(len(run.actions), colour=colour, width=width)}"


def _asked(situation: Situation) -> list[str]:
    accept = situation.accept
    asked = [f"accept: {accept}"]
    if isinstance(accept, Either):
        asked = ["accept one of:", *(f"  {condition}" for condition in accept.conditions)]
    return asked + ([f"never: {situation.never}"] if situation.never else [])

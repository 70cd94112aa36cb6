"""The tables of `results/human.md`."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from overcooked_bench.human.distances import hand_over_distance, visit_distance
from overcooked_bench.human.shown import percent
from overcooked_bench.rendering.table import Column, Table

from ..cloning.sweep import choose, cost, obeys
from .crowds import Crowd
from .foretold import CLONES, REGULARISED, Pairwise, accuracy, nats, over_pairs
from .likeness import OTHERS, PEOPLE, Likeness, gates, share
from .proxies import both_stages, staged

_HANDED: Final = 1.0
"""Hand-overs of people per 400 steps from which it is compared where they happen."""


def foretold_table(found: Sequence[Likeness], pairs: str) -> Table:
    """How well people are foretold from one set of them: on the other set, and on pairs held out of the same set."""
    rows = []
    for one in _of(found, pairs):
        for row, who in enumerate(who for who, judged in one.foretelling.others.items() if judged):
            others, own = one.foretelling.others[who], one.foretelling.held_out[who]
            told = *_told(others), *_told(own)
            rows.append(["" if row else one.layout, who, *told])
    other = "A" if pairs == "B" else "B"
    heads = f"nats, set {other}", "right, %", f"nats, held out of {pairs}", "right, %"
    return Table(["layout", Column("who foretells", left=True), *heads], rows)


def conduct_table(found: Sequence[Likeness], pairs: str) -> Table:
    """What the people of a set, their proxies and self-play agents do, and how far from these people that is."""
    rows = []
    for one in _of(found, pairs):
        people = one.crowds[PEOPLE].all
        for row, (who, crowd) in enumerate(one.crowds.items()):
            does = crowd.all
            handed = people.hand_overs.value >= _HANDED and who != PEOPLE
            rows.append(
                [
                    *(
                        "" if row else one.layout,
                        who,
                        _soups(who, crowd),
                        f"{100 * share(does.soups, people.soups):.0f}",
                    ),
                    *(_idle(who, crowd), f"{100 * does.stuck.value:.0f}", f"{does.hand_overs.value:.1f}"),
                    f"{hand_over_distance(people, does):.2f}" if handed else "",
                    f"{visit_distance(people, does):.2f}" if who != PEOPLE else "",
                    "" if does.clockwise is None else f"{100 * does.clockwise.value:.0f}",
                ]
            )
    heads = (
        "soups",
        "of people's, %",
        "idle, %",
        "stuck, %",
        "hand-overs",
        "hand-over distance",
        "visit distance",
        "clockwise, %",
    )
    return Table(["layout", Column("who", left=True), *heads], rows)


def stages_table(found: Sequence[Likeness]) -> Table:
    """What the second stage costs each proxy in likelihood, and what it changes in the kitchen."""
    rows = []
    for one in found:
        people, told = one.crowds[PEOPLE].all, one.foretelling
        does = {
            proxy.name: each
            for who, stage in ((CLONES, "clone"), (REGULARISED, "regularised"))
            for proxy, each in zip(
                staged(one.proxies, stage), one.crowds[who].each if who in one.crowds else (), strict=True
            )
        }
        runs = zip(both_stages(one.proxies), told.own_costs, told.costs, strict=True)
        for row, ((clone, proxy), own, others) in enumerate(runs):
            idle = [f"{100 * (does[name].idle.value - people.idle.value):+.0f}" for name in (clone.name, proxy.name)]
            soups = [f"{100 * share(does[name].soups, people.soups):.0f}" for name in (clone.name, proxy.name)]
            rows.append(
                [
                    *(("", "") if row else (one.layout, one.pairs)),
                    *(proxy.name, f"{proxy.coefficient:g}", f"{np.mean([*own.values()]):+.3f}"),
                    *(over_pairs([others]).text(3), " to ".join(soups), " to ".join(idle)),
                ]
            )
    heads = "coefficient", "nats, held out", "nats, other set", "soups of people's, %", "idle, points"
    return Table(["layout", *(Column(name, left=True) for name in ("set", "proxy")), *heads], rows)


def tries_table(tries: Sequence[dict[str, Any]], found: Sequence[Likeness]) -> Table:
    """What was tried to choose the coefficient; `tries` as `cloning.sweep` keeps them."""
    used = {(one.layout, one.pairs): one.coefficients for one in found}
    order = {one.layout: k for k, one in enumerate(found)}
    places = sorted({(one["layout"], one["pairs"]) for one in tries}, key=lambda at: (order.get(at[0], 99), at))
    rows = []
    for layout, pairs in places:
        here = [one for one in tries if (one["layout"], one["pairs"]) == (layout, pairs)]
        chosen = choose(here)["coefficient"]
        for row, one in enumerate(sorted(here, key=lambda one: -float(one["coefficient"]))):
            after, people, number = one["regularised"], one["people"], float(one["coefficient"])
            rows.append(
                [
                    *(("", "") if row else (layout, pairs)),
                    *(f"{number:g}", f"{cost(one):+.3f}", f"{100 * after['soups'] / people['soups']:.0f}"),
                    *(f"{100 * (after['idle'] - people['idle']):+.0f}", "yes" if obeys(one) else "no"),
                    "chosen" * (number == chosen),
                    "yes" if number in used.get((layout, pairs), ()) else "",
                ]
            )
    heads = "coefficient", "nats", "soups of people's, %", "idle, points", "obeys", "rule", "in the pool"
    return Table(["layout", Column("set", left=True), *heads], rows)


def gates_table(found: Sequence[Likeness]) -> Table:
    """Which gates are passed: the mean, and how many proxies or pairings are within the bounds."""
    names = list(dict.fromkeys(gate.name for one in found for gate in gates(one)))
    rows = []
    for one in found:
        cells = {
            gate.name: f"{'yes' if gate.passed else '**no**'}: {gate.text.format(np.mean(gate.values))} "
            f"({gate.within} of {len(gate.values)})"
            for gate in gates(one)
        }
        rows.append([one.layout, one.pairs, *(cells.get(name, "-") for name in names)])
    return Table(["layout", Column("set", left=True), *names], rows)


def verdict(found: Sequence[Likeness]) -> str:
    """Counts the gates that are passed, and names the others."""
    asked = [(one, gate) for one in found for gate in gates(one)]
    missed = [
        f"{gate.name} on {one.layout}, set {one.pairs} ({gate.text.format(np.mean(gate.values))})"
        for one, gate in asked
        if not gate.passed
    ]
    said = f"{len(asked) - len(missed)} of {len(asked)} gates are passed"
    return "\n".join([f"{said}. Not passed:\n", *(f"- {one}" for one in missed)]) if missed else f"{said}."


def _told(guessers: Sequence[Pairwise]) -> tuple[str, str]:
    found = nats(guessers)
    if found.low == found.high:  # uniform: no action is the likeliest
        return f"{found.value:.2f}", ""
    return found.text(2), f"{100 * accuracy(guessers):.0f}"


def _soups(who: str, crowd: Crowd) -> str:
    """Writes soups: with the interval over pairs of people, or from the lowest to the highest agent or pairing."""
    if who in (PEOPLE, OTHERS):
        return crowd.all.soups.text(1)
    each = [one.soups.value for one in crowd.each]
    return f"{crowd.all.soups.value:.1f} ({min(each):.1f} to {max(each):.1f})"


def _idle(who: str, crowd: Crowd) -> str:
    if who in (PEOPLE, OTHERS):
        return percent(crowd.all.idle)
    each = [one.idle.value for one in crowd.each]
    return f"{100 * crowd.all.idle.value:.0f} ({100 * min(each):.0f} to {100 * max(each):.0f})"


def _of(found: Sequence[Likeness], pairs: str) -> list[Likeness]:
    return [one for one in found if one.pairs == pairs]

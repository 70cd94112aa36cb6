"""Why the agent failed, where `overcooked-bench explain` was asked: shares of moments, and the worst to watch."""

import shlex
from collections.abc import Iterator
from html import escape
from typing import Final

from overcooked_bench.evaluation.explaining.reasons import PAIRINGS, REASONS, Pairing
from overcooked_bench.evaluation.explaining.records import PREFIX, Explanation, LayoutExplanation, Moment, Worst
from overcooked_bench.evaluation.pools.axes import AXES
from overcooked_bench.evaluation.shown.explanation import conventions_table, notes, reasons_table, soups_table
from overcooked_bench.evaluation.shown.sections.reasons_plot import reasons_plot
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.viewer.games import pack_game, player

_NAMES: Final[dict[Pairing, str]] = {
    "pair": "The pair",
    "agent": "Two of the agent",
    "partner": "Two of the partner",
    "greedy": "Two of greedy",
}


def failure_section(material: Material) -> Section | None:
    """Shows an explanation, or how to ask for one; None if no episode was kept that could be explained."""
    title, found = "Why it failed", material.explanation
    if found is None:
        if material.episodes is None or not material.scores.layouts:
            return None
        command = escape(shlex.join(["overcooked-bench", "explain", str(material.folder)]))
        return Section(title, [f'<p class="note">Not asked yet: <code>{command}</code></p>'])
    tables = {"reasons": reasons_table(found), "soups": soups_table(found), "conventions": conventions_table(found)}
    plot = reasons_plot(found)
    parts = [f'<div class="narrow">{plot.element()}</div>'] if found.total.reasons else []
    parts += [table.html() for table in tables.values() if table.rows] + [note(one) for one in notes(found)]
    moments = [_moment(found, layout, worst) for layout in found.layouts for worst in layout.worst]
    if moments:
        parts += ["<h3>The worst moments</h3>", *moments]
    plots = {"reasons": plot} if found.total.reasons else {}
    return Section(title, parts, {name: table for name, table in tables.items() if table.rows}, plots)


def _moment(found: Explanation, layout: LayoutExplanation, worst: Worst) -> str:
    moment = layout.moments[worst.moment]
    means = ", ".join(f"{_NAMES[pairing].lower()} {moment.soups.mean(pairing):.1f}" for pairing in PAIRINGS)
    differ = f" ({', '.join(moment.differ)})" if moment.differ and moment.reason == "clash" else ""
    reason = REASONS[moment.reason].heading.replace("\n", " ")
    head = f"{worst.name.removeprefix(PREFIX)}, with {moment.partner}: {reason}{differ}"
    said = f"Soups from step {moment.step} on: {means}. {' '.join(_differences(layout, moment, worst))}"
    return f"<details><summary>{escape(head)}</summary>{note(said)}{''.join(_games(found, layout, worst))}</details>"


def _differences(layout: LayoutExplanation, moment: Moment, worst: Worst) -> Iterator[str]:
    """Yields a sentence for each axis on which the conventions of agent and partner differ."""
    own, other = worst.conventions
    for axis in AXES.get(layout.layout, ()):
        if axis.name in moment.differ:
            yield f"{axis.meaning.capitalize()}: {own[axis.name]} for the agent, {other[axis.name]} for its partner."


def _games(found: Explanation, layout: LayoutExplanation, worst: Worst) -> Iterator[str]:
    """Yields the game of each pairing, that of the pair unfolded."""
    moment, plan = layout.moments[worst.moment], Layout.load(layout.layout)
    pair = (found.agent.name, moment.partner) if moment.seat == 0 else (moment.partner, found.agent.name)
    names = {
        "pair": pair,
        "agent": (found.agent.name,) * 2,
        "partner": (moment.partner,) * 2,
        "greedy": ("greedy",) * 2,
    }
    for pairing in PAIRINGS:
        frames = worst.frames(layout.layout, pairing, found.cooking)
        title = f"{_NAMES[pairing]} from step {moment.step} on {layout.layout}"
        shown = player(pack_game(plan, frames, names[pairing], title))
        soups = worst.games[pairing].soups
        head = f"{_NAMES[pairing]}: {soups:g} soup{'s' * (soups != 1)} in this game"
        yield f"<details{' open' * (pairing == 'pair')}><summary>{escape(head)}</summary>{shown}</details>"

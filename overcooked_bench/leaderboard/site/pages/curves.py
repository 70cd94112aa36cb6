"""Ordered curves: of any two entries of a protocol beside each other on a page, and of one entry on its own."""

import json
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.sections.section import STYLE
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.pages.look import choice, link, program, whole
from overcooked_bench.rendering.page import note

_NOTE = "Points per episode with the worst partner, the second worst, and so on; means over training seeds."


def curves_page(games: Games) -> str:
    """Writes the page of a protocol."""
    entries = games.entries
    options = [(entry.key, f"{entry.name} ({entry.status})") for entry in entries]
    curves = {entry.key: {"name": entry.name, "curves": curves_of(entry.scores)} for entry in entries}
    title = f"Ordered curves: {games.title}"
    body = [
        "<h1>Ordered curves</h1>",
        f'<p class="sub">{link(f"../{games.page}", games.title)}</p>',
        note(_NOTE),
        _form(options),
        *_panels(games.scores, [entry.key for entry in entries], curves),
    ]
    return whole(title, body, "../", style=STYLE)


def curves_part(entry: Entry, reference: Scores | None) -> list[str]:
    """Returns the curves of an entry beside those of the reference, as parts of its page."""
    shown = {"entry": {"name": entry.name, "curves": curves_of(entry.scores)}}
    names = f'<p><span class="first">{escape(entry.name)}</span>'
    if reference is not None:
        shown["beside"] = {"name": reference.agent.name, "curves": curves_of(reference)}
        names += f' &nbsp; <span class="second">{escape(reference.agent.name)}</span>'
    return [note(_NOTE), f"{names}</p>", *_panels(entry.scores, list(shown), shown)]


def _panels(scores: Scores, keys: Sequence[str], curves: Mapping[str, Any]) -> list[str]:
    data = {"layouts": list(scores.settings.play.layouts), "keys": list(keys), "entries": curves}
    packed = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")  # "</script>" would end the element
    return [
        '<div class="panels"></div>',
        f'<script type="application/json" id="curves">{packed}</script>',
        program("curves.js"),
    ]


def _form(options: Sequence[tuple[str, str]]) -> str:
    fields = choice("first", "first entry", options, "none"), choice("second", "second entry", options, "none")
    marked = "".join(
        field.replace("<label>", f'<label class="{name}">', 1)
        for name, field in zip(("first", "second"), fields, strict=True)
    )
    return f'<form class="filters" aria-label="Choose two entries">{marked}</form>'


def curves_of(scores: Scores) -> dict[str, list[int]]:
    """Returns the curve of each layout, rounded to points."""
    found: dict[str, list[tuple[float, float]]] = {}
    for row in scores.select("curve"):
        if row.layout is not None:
            found.setdefault(row.layout, []).append((row.params["rank"], row.value))
    return {layout: [round(value) for _, value in sorted(pairs)] for layout, pairs in found.items()}

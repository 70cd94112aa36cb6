"""The page of ordered curves: any two entries of a protocol beside each other, drawn in the browser."""

import json
from collections.abc import Sequence
from html import escape

from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.sections.section import STYLE
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.look import choice, program, whole
from overcooked_bench.rendering.page import note


def curves_page(games: Games) -> str:
    """Writes the page of a protocol."""
    entries = [entry for board in games.boards for entry in board.entries]
    options = [(entry.key, f"{entry.name} ({entry.status})") for entry in entries]
    data = {
        "layouts": list(games.scores.settings.play.layouts),
        "keys": [entry.key for entry in entries],
        "entries": {entry.key: {"name": entry.name, "curves": curves_of(entry.scores)} for entry in entries},
    }
    packed = json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")  # "</script>" would end the element
    title = f"Ordered curves: {games.title}"
    body = [
        f"<h1>{escape(title)}</h1>",
        note("Points per episode with the worst partner, the second worst, and so on; means over training seeds."),
        _form(options),
        '<div class="panels"></div>',
        f'<script type="application/json" id="curves">{packed}</script>',
        program("curves.js"),
    ]
    return whole(title, body, style=STYLE)


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

"""The page of a layout: its picture, its rules, and how well it separates good agents from bad ones."""

import json
from collections.abc import Iterator, Mapping, Sequence
from html import escape
from statistics import median
from typing import Final
from urllib.parse import urlencode

from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.discriminating import BOTTOM, TOP, Discrimination
from overcooked_bench.leaderboard.site.pages.look import TITLE, link, program, whole
from overcooked_bench.rendering.page import definitions, note, section
from overcooked_bench.rendering.table import Cell, Column, Table
from overcooked_bench.rendering.viewer.games import pack_game, script

_TILES: Final = {
    "P": "pot",
    "O": "onion dispenser",
    "T": "tomato dispenser",
    "D": "dish dispenser",
    "S": "serving tile",
}
COLUMNS: Final = (
    "Spread: standard deviation between entries. Half an interval: median of half the width of their 95 % intervals. "
    "A layout discriminates well if the spread is three times that or more. A rank correlation near 1 says that the "
    "layout orders entries as the others do. Points with partners by points with a copy: how much of an agent's play "
    "with itself is left with strangers; median of the entries."
)
"""What the columns of `discrimination_table` are."""

_BINS: Final = 20
_WIDE: Final = 480
_HIGH: Final = 120
_STYLE: Final = "figure.bars { max-width: 32rem; margin: .6rem 0; } figure.bars rect { fill: #0072B2; }\n"


def layout_page(name: str, playing: Sequence[tuple[Games, Discrimination]]) -> str:
    """Writes the page of a shipped layout.

    Args:
        name: Its name.
        playing: The protocols that play it, each with what its entries say about the layout.
    """
    layout = Layout.load(name)
    body = [
        f"<h1>{escape(name)}</h1>",
        f'<p class="sub">Environment <code>{escape(_environment(name))}</code></p>',
        _still(layout),
        *section("Rules", definitions(_rules(layout))),
        *(part for games, found in playing for part in _of_protocol(name, games, found)),
        script(),
        program("still.js"),
    ]
    return whole(f"{name}: {TITLE}", body, "../", _STYLE)


def _environment(name: str) -> str:
    return f"Overcooked/{''.join(word.capitalize() for word in name.split('_'))}-v0"


def _still(layout: Layout) -> str:
    """Returns the kitchen as both chefs find it, drawn by the program that plays games."""
    kitchens = Kitchens(layout, 1, start="standard" if layout.start_cells else "random")
    kitchens.reset(seed=0)
    game = pack_game(layout, [(kitchens.state(0), 0.0)], ("chef 0", "chef 1"), layout.name)
    data = json.dumps(game, separators=(",", ":")).replace("<", "\\u003c")
    said = f"The kitchen {layout.name}: {layout.width} by {layout.height} cells"
    return (
        f'<canvas class="still" role="img" aria-label="{escape(said)}"></canvas>'
        f'<script type="application/json" class="still">{data}</script>'
    )


def _rules(layout: Layout) -> Iterator[tuple[str, str]]:
    yield "size", f"{layout.width} by {layout.height} cells, counters around it included"
    yield "tiles", ", ".join(_many(n, what) for tile, what in _TILES.items() if (n := len(layout.positions(tile))))
    parts = max(layout.regions.values(), default=0) + 1
    if parts > 1:
        yield "floor", f"{parts} separate parts; each chef starts in another one and never leaves it"
    else:
        yield "floor", "one part; chefs get into each other's way"
    orders = [" and ".join(filter(None, (_many(o, "onion"), _many(t, "tomato")))) for o, t in layout.orders]
    yield "orders", "; ".join(orders)
    times = sorted({layout.cook_times[index] for index, points in enumerate(layout.soup_rewards) if points > 0})
    yield "cooking", f"{' or '.join(map(str, times))} steps"
    yield "points", f"{layout.soup_points:g} per soup, for both chefs together"
    yield "grid", " / ".join(row.replace(" ", "·") for row in layout.rows)


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'es' if what.endswith('o') and count > 1 else 's' if count > 1 else ''}" if count else ""


def _of_protocol(name: str, games: Games, found: Discrimination) -> Iterator[str]:
    scores = games.scores
    old = "" if games.current else ' class="old"'
    yield f"<section{old}><h2>{link(f'../{games.page}', games.title)}</h2>"
    play = scores.settings.play
    yield note(
        f"Cooking {play.cooking}, {play.horizon} steps, {play.start} starts, {play.episodes} of them per partner."
    )
    headline = headline_of(games)
    few = note("Too few entries to say how well it discriminates.")
    yield f"<p>Discriminates {found.verdict}.</p>" if found.verdict else few
    if found.verdict:
        yield discrimination_table({name: found}, headline).html()
        yield note(COLUMNS)
        yield _bars(found, headline)
    if games.current:
        chosen = urlencode({"layout": name, "sort": f"on-{play.layouts.index(name)}:down"})
        yield f'<p class="note">{link(f"../index.html#{chosen}", "All entries, sorted by this layout")}</p>'
    yield "</section>"


def headline_of(games: Games) -> str:
    """Returns what the metric that ranks is called."""
    scores = games.scores
    return next((title_of(facts) for facts in scores.metrics if facts.name == scores.headline), scores.headline)


def discrimination_table(found: Mapping[str, Discrimination], headline: str) -> Table:
    """Lays out one row per layout: where its scores are, and what separates them.

    Args:
        found: Layout -> what its entries say about it.
        headline: What the metric that ranks is called.
    """
    rows: list[list[Cell]] = []
    for name, one in found.items():
        ends = (one.values[0], median(one.values), one.values[-1]) if one.values else (None, None, None)
        rows.append(
            [
                name,
                f"{len(one.values):,}",
                *(_text(value) for value in (*ends, one.spread, one.half_width, one.ratio)),
                "-" if one.separated is None else f"{one.separated[0]:,} of {one.separated[1]:,}",
                *(_text(value) for value in (one.agreement, one.cross_play)),
            ]
        )
    heads: list[str | Column] = [
        "layout",
        "entries",
        f"lowest {headline}",
        "median",
        "highest",
        "spread between entries",
    ]
    heads += ["half an interval", "spread / half", "pairs separated", "rank correlation with other layouts"]
    return Table([*heads, "points with partners / with a copy"], rows)


def _text(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _bin(index: int) -> str:
    """Says which scores a bar counts; the outermost ones have no end."""
    if index == 0:
        return f"below {1 / _BINS:.2f}"
    low = f"{index / _BINS:.2f}"
    return f"{low} or above" if index == _BINS - 1 else f"{low} to {(index + 1) / _BINS:.2f}"


def _bars(found: Discrimination, headline: str) -> str:
    """Draws how many entries have which score."""
    counts = [0] * _BINS
    for value in found.values:
        counts[min(_BINS - 1, max(0, int(value * _BINS)))] += 1
    wide, top = _WIDE / _BINS, max(counts)
    bars = "".join(
        f'<rect x="{index * wide + 1:g}" y="{_HIGH * (1 - count / top):.1f}" width="{wide - 2:g}" '
        f'height="{_HIGH * count / top:.1f}">'
        f"<title>{_bin(index)}: {count}</title></rect>"
        for index, count in enumerate(counts)
        if count
    )
    ticks = "".join(
        f'<text class="tick" x="{share * _WIDE:g}" y="{_HIGH + 14}" text-anchor="{anchor}">{share:g}</text>'
        for share, anchor in ((0, "start"), (BOTTOM, "middle"), (0.5, "middle"), (TOP, "middle"), (1, "end"))
    )
    near = f"{sum(value >= TOP for value in found.values)} of {len(found.values)} entries at {TOP} or above"
    return (
        f'<figure class="bars"><svg viewBox="0 0 {_WIDE} {_HIGH + 18}" role="img" '
        f'aria-label="{escape(f"Entries by their {headline}: {near}")}">'
        f'<line x1="0" x2="{_WIDE}" y1="{_HIGH}" y2="{_HIGH}" stroke="var(--dim)"/>{bars}{ticks}</svg></figure>'
        + note(f"Entries by their {headline} here; {near}.")
    )

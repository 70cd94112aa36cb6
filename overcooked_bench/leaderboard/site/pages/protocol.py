"""The page of a protocol: what is played, with whom, and what its layouts separate; an old one has its tables here."""

from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape

from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.discriminating import Discrimination
from overcooked_bench.leaderboard.site.lines import line_of
from overcooked_bench.leaderboard.site.pages.layout import COLUMNS, discrimination_table, headline_of
from overcooked_bench.leaderboard.site.pages.look import TITLE, link, program, whole
from overcooked_bench.leaderboard.site.pages.table import boards, filters, style
from overcooked_bench.rendering.page import definitions, note, section
from overcooked_bench.rendering.table import Table

_OLD = "Another protocol than the newest one. Its numbers are not to be compared with those of any other."


def protocol_page(games: Games, found: Mapping[str, Discrimination]) -> str:
    """Writes the page.

    Args:
        games: The protocol.
        found: Layout -> what its entries say about it.
    """
    layouts = list(games.scores.settings.play.layouts)
    links = "".join(link(f"../layouts/{name}.html", name) for name in layouts if name in layout_names())
    body = [
        f"<h1>Protocol {escape(games.scores.protocol.name)}</h1>",
        note(games.title, "sub"),
    ]
    body += [] if games.current else [note(_OLD, "warn")]
    body += [
        *section("What is played", definitions(_facts(games))),
        *section("Partners", _partners(games)),
        *section(
            "Layouts",
            f'<nav aria-label="Layouts">{links}</nav>',
            discrimination_table(found, headline_of(games)).html(),
            note(COLUMNS),
        ),
        *section("Ordered curves", f'<p class="note">{link(f"../{games.curves}", "Of any two of its entries")}</p>'),
    ]
    if games.current:
        body += section("Entries", f'<p class="note">{link("../index.html", "All entries")}</p>')
        return whole(f"{games.title}: {TITLE}", body, "../")
    shown = [filters([line_of(entry) for entry in games.entries], layouts), *boards(games, "../")]
    body += section("Entries", f'<div class="old">{"".join(shown)}</div>')
    return whole(f"{games.title}: {TITLE}", [*body, program("board.js")], "../", style(layouts))


def _facts(games: Games) -> Iterator[tuple[str, str]]:
    scores, play = games.scores, games.scores.settings.play
    yield "protocol", f"{scores.protocol.name}, version {scores.settings.version}, SHA-256 {scores.protocol.sha256}"
    yield "pool", f"{scores.pool.name}, SHA-256 {scores.pool.sha256}" if scores.pool else "none"
    yield "episodes", f"{play.episodes} start states per partner, each from seats {', '.join(map(str, play.seats))}"
    yield "kitchens", f"{play.horizon} steps, cooking {play.cooking}, {play.start} starts"
    yield "salt", f"{play.salt}; official runs draw another one, which is published with the result"
    known = {one.name: one for one in scores.metrics}
    for name in scores.settings.report.headlines:
        if name in known:
            yield name, known[name].note or known[name].label
    ranked = "methods of five training seeds or more, and single agents apart from them"
    yield "ranks", ranked if scores.settings.report.ranked else "nothing"


def _partners(games: Games) -> str:
    """Lays out how many partners of each stratum the pool has on each layout."""
    counts = {
        one.layout: Counter(label.stratum for label in one.partners if label.counts) for one in games.scores.layouts
    }
    strata = sorted({stratum for count in counts.values() for stratum in count})
    if not strata:
        return ""
    rows = [[name, *(str(count[stratum]) for stratum in strata), str(count.total())] for name, count in counts.items()]
    return Table(["layout", *strata, "all"], rows).html()

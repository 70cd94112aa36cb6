"""The index: the tables of the newest protocol, and links to everything else."""

from collections.abc import Iterator, Sequence

from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.lines import line_of
from overcooked_bench.leaderboard.site.pages.look import TITLE, link, program, whole
from overcooked_bench.leaderboard.site.pages.table import boards, filters, style
from overcooked_bench.rendering.page import note


def index_page(games: Sequence[Games], refused: int) -> str:
    """Writes the index.

    Args:
        games: All protocols.
        refused: How many folders of the results are not shown.
    """
    body = [f"<h1>{TITLE}</h1>", note(_INTRODUCTION), _links(games)]
    shown = [one for one in games if one.current]
    layouts: list[str] = []
    for one in shown:
        layouts = list(one.scores.settings.play.layouts)
        body += [f"<h2>{link(one.page, one.title)}</h2>"]
        if not any(board.table == "main" for board in one.boards):
            body.append(note("No method of five or more training seeds is ranked yet."))
        body += [filters([line_of(entry) for entry in one.entries], layouts), *boards(one)]
    if refused:
        body.append(f'<p class="note">{refused} folders of the results {link("errata.html", "are not shown")}.</p>')
    return whole(TITLE, [*body, program("board.js")], style=style(layouts))


_INTRODUCTION = (
    "Agents that cooperate with partners whom they have never met, on the classic kitchens; brackets hold 95 % "
    "intervals. Reproduced: every number was computed again and all games were played again by somebody else; "
    "spot-checked: every number, and a random part of the games; reported: nothing, or something was wrong. "
    "References ship with the package."
)


def _links(games: Sequence[Games]) -> str:
    return "".join(_link_lists(games))


def _link_lists(games: Sequence[Games]) -> Iterator[str]:
    current = [one for one in games if one.current]
    layouts = [name for one in current for name in one.scores.settings.play.layouts if name in layout_names()]
    shown = "".join(link(f"layouts/{name}.html", name) for name in layouts)
    yield f'<nav aria-label="Layouts">Layouts: {shown}</nav>'
    rules = "".join(link(one.page, f"{one.scores.protocol.name}") for one in current)
    old = "".join(link(one.page, one.title) for one in games if not one.current)
    yield f'<nav aria-label="Protocols">Protocols: {rules}<span class="old">{old}</span></nav>'
    curves = "".join(link(one.curves, "of any two entries, beside each other") for one in current)
    yield f'<nav aria-label="Curves">Ordered curves: {curves}</nav>'

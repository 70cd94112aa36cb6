"""The index: a table for each protocol, never two in one, with fields to sort and filter them."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.tables import NONE, figure
from overcooked_bench.leaderboard.site.board import TABLES, Board, Games
from overcooked_bench.leaderboard.site.entries import Refused
from overcooked_bench.leaderboard.site.lines import Line, line_of
from overcooked_bench.leaderboard.site.look import choice, program, whole
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.table import Column, Table

_TITLE: Final = "overcooked-bench leaderboard"
_SHARE: Final = MetricFacts(name="scenarios", label="scenarios passed", unit="share", digits=0)
_GROUPS: Final = (
    "Methods that share a letter of the column group are not separated by the data: a permutation test over training "
    "seeds, adjusted by Holm for all pairs of the table. Agents and methods of fewer than five training seeds are in "
    "no group. Brackets hold 95 % intervals."
)


def index_page(games: Sequence[Games], refused: Sequence[Refused]) -> str:
    """Writes the index."""
    lines = {
        entry.key: line_of(entry, board.groups.get(entry.key, ""))
        for one in games
        for board in one.boards
        for entry in board.entries
    }
    layouts = sorted({layout for line in lines.values() for layout in line.layouts})
    body = [
        f"<h1>{_TITLE}</h1>",
        note(_GROUPS),
        _filters([*lines.values()], layouts),
        '<p class="note" id="said" role="status"></p>',
        *(part for one in games for part in _section(one, lines)),
        *_refused(refused),
        program("board.js"),
    ]
    return whole(_TITLE, body)


def _filters(lines: Sequence[Line], layouts: Sequence[str]) -> str:
    def some(values: set[str]) -> list[tuple[str, str]]:
        return [(value, value) for value in sorted(values)]

    fields = [
        '<label>name<input name="name" type="search" autocomplete="off"></label>',
        choice("layout", "layout", some(set(layouts)), "mean of layouts"),
        '<label>score at least<input name="least" type="number" step="any"></label>',
        choice("status", "status", some({line.status for line in lines})),
        choice("kind", "kind", some({line.kind for line in lines})),
        choice("observation", "observation", some({line.observation for line in lines if line.observation})),
        choice("human", "human data", [("yes", "used"), ("no", "not used")]),
        '<label>joint steps at most<input name="steps" type="number" min="0" step="any"></label>',
        '<button type="reset">Show all</button>',
    ]
    return f'<form class="filters" aria-label="Filter the tables">{"".join(fields)}</form>'


def _section(games: Games, lines: dict[str, Line]) -> Iterator[str]:
    old = "" if games.current else ' class="old"'
    yield f'<section{old} aria-label="{escape(games.title)}"><h2>{escape(games.title)}</h2>'
    if not games.current:
        yield note("Another protocol than the newest one: its numbers are not to be compared with those above.")
    yield f'<p class="note"><a href="curves-{games.mark}.html">Ordered curves of any two of its entries</a></p>'
    for board in games.boards:
        yield f"<h3>{TABLES[board.table]}</h3>"
        yield _table(games, board, [lines[entry.key] for entry in board.entries])
    yield "</section>"


def _table(games: Games, board: Board, lines: Sequence[Line]) -> str:
    scores = games.scores
    facts = {one.name: one for one in scores.metrics}
    layouts, more = list(scores.settings.play.layouts), list(scores.settings.report.headlines[1:])
    words = ("status", "kind", "observation", "human data")
    heads = [_head("entry", "entry", True), _head("group", "group", True)]
    heads += [_head("score", f"{_title(scores, facts)} [95 %]")]
    heads += [_head(f"on-{i}", name, of=name) for i, name in enumerate(layouts)]
    heads += [_head(name, f"{title_of(facts[name]) if name in facts else name} [95 %]") for name in more]
    heads += [_head("scenarios", "scenarios passed [95 %]"), *(_head(name, name, True) for name in words)]
    heads += [_head(name, name) for name in ("training seeds", "joint steps", "partner runs")]
    heads += [_head("remark", "remark", True)] * (board.table == "unranked")
    headline = facts.get(scores.headline)
    rows = [_row(line, place, layouts, more, facts, headline, board.table) for place, line in enumerate(lines)]
    label = escape(f"{games.title}: {TABLES[board.table]}")
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{label}"><table class="board">'
        f"<thead><tr>{''.join(heads)}</tr></thead><tbody>\n" + "\n".join(rows) + "\n</tbody></table></div>"
    )


def _title(scores: Scores, facts: dict[str, MetricFacts]) -> str:
    return title_of(facts[scores.headline]) if scores.headline in facts else scores.headline


def _head(key: str, text: str, words: bool = False, of: str = "") -> str:
    marks = (' class="left" data-words' if words else "") + (f' data-layout="{escape(of)}" hidden' if of else "")
    button = f'<button type="button" class="sort">{escape(text)}</button>'
    return f'<th scope="col" data-key="{escape(key)}"{marks}>{button}</th>'


def _row(
    line: Line,
    place: int,
    layouts: Sequence[str],
    more: Sequence[str],
    facts: dict[str, MetricFacts],
    headline: MetricFacts | None,
    table: str,
) -> str:
    human = {None: "", True: "yes", False: "no"}[line.human_data]
    steps = "" if line.joint_steps is None else str(line.joint_steps)
    marks = {
        "name": line.name.lower(),
        "place": str(place),
        "status": line.status,
        "kind": line.kind,
        "observation": line.observation or "",
        "human": human,
        "steps": steps,
    }
    cells = [
        f'<td class="left"><a href="{escape(line.page)}">{escape(line.name)}</a></td>',
        f'<td class="left">{escape(line.group)}</td>',
        _number(line.score, headline, "score"),
        *(_number(line.layouts.get(name), headline, of=name) for name in layouts),
        *(_number(line.more.get(name), facts.get(name)) for name in more),
        _number(line.scenarios, _SHARE),
        *(f'<td class="left">{escape(text)}</td>' for text in (line.status, line.kind, line.observation or "", human)),
        *(_count(count) for count in (line.training_seeds, line.joint_steps, line.partner_runs)),
    ]
    cells += [f'<td class="remark">{escape(line.remark)}</td>'] * (table == "unranked")
    said = "".join(f' data-{key}="{escape(value)}"' for key, value in marks.items())
    return f"<tr{said}>{''.join(cells)}</tr>"


def _number(estimate: Estimate | None, facts: MetricFacts | None, kind: str = "", of: str = "") -> str:
    marks = (f' class="{kind}"' if kind else "") + (f' data-layout="{escape(of)}" hidden' if of else "")
    if estimate is None or facts is None:
        return f"<td{marks}>{NONE}</td>"
    shown = figure(estimate, facts, True)
    ends = f" <small>{escape(shown.interval)}</small>" if shown.interval else ""
    return f'<td{marks} data-v="{estimate.value:.6g}">{escape(shown.value)}{ends}</td>'


def _count(count: int | None) -> str:
    return f"<td>{NONE}</td>" if count is None else f'<td data-v="{count}">{count:,}</td>'


def _refused(refused: Sequence[Refused]) -> Iterator[str]:
    if refused:
        table = Table(["folder", Column("reason", left=True)], [[one.name, one.reason] for one in refused])
        yield "<h2>Refused</h2>"
        yield note("Folders of the results that are no entries, and why.")
        yield table.html().replace('<div class="wide">', '<div class="wide refused" role="region" tabindex="0">', 1)

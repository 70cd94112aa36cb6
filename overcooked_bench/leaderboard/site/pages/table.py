"""The table of a board, in HTML: sorted and filtered by `board.js`."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.tables import NONE, figure
from overcooked_bench.leaderboard.site.board import TABLES, Board, Games
from overcooked_bench.leaderboard.site.groups import MOST_LETTERS
from overcooked_bench.leaderboard.site.lines import Line, line_of
from overcooked_bench.leaderboard.site.pages.look import choice
from overcooked_bench.rendering.page import note

_SHARE: Final = MetricFacts(name="scenarios", label="scenarios passed", unit="share", digits=0)
_EXPLAINED: Final = {
    "main": "Five training seeds or more that say they never saw the pool; status says what was played again.",
    "agents": "One training run, or rules. Intervals and groups say nothing about training it once more.",
    "open": "Training or selection saw the partners that score it: no evidence on cooperation with strangers.",
    "unranked": "The column remark says why. Of what is reported only, nobody could play the same games again.",
}


def filters(lines: Sequence[Line], layouts: Sequence[str]) -> str:
    """Returns the form that filters the tables of a page, as HTML."""

    def some(values: set[str]) -> list[tuple[str, str]]:
        return [(value, value) for value in sorted(values)]

    fields = [
        '<label>name<input name="name" type="search" autocomplete="off"></label>',
        choice("layout", "layout", [(name, name) for name in layouts], "mean of layouts"),
        '<label>score at least<input name="least" type="number" step="any"></label>',
        choice("status", "status", some({line.status for line in lines})),
        choice("kind", "kind", some({line.kind for line in lines})),
        choice("observation", "observation", some({line.observation for line in lines if line.observation})),
        choice("human", "human data", [("yes", "used"), ("no", "not used")]),
        '<label>joint steps at most<input name="steps" type="number" min="0" step="any"></label>',
        '<label class="tick"><input name="more" type="checkbox" value="1">training columns</label>',
        '<button type="reset">Show all</button>',
    ]
    form = f'<form class="filters" aria-label="Filter the tables">{"".join(fields)}</form>'
    said = '<p class="note" id="said" role="status"></p>'
    return f'<details class="filters"><summary>Filter, and choose columns</summary>{form}</details>{said}'


def style(layouts: Sequence[str]) -> str:
    """Returns the CSS that shows the column of a chosen layout, which are hidden otherwise."""
    return "".join(f'table.board[data-on="{i}"] .on{i} {{ display: table-cell; }}\n' for i in range(len(layouts)))


def boards(games: Games, up: str = "") -> Iterator[str]:
    """Yields the tables of a protocol with their titles, as HTML."""
    for board in games.boards:
        yield f"<h3>{TABLES[board.table]}</h3>"
        yield note(_EXPLAINED[board.table])
        if said := _groups(board):
            yield note(said)
        yield _table(games, board, up)


def _groups(board: Board) -> str:
    """Says what the groups mean, or why there are none."""
    groups, count = board.groups, len(board.groups.marks)
    if count < 2:
        return ""
    agents = board.table == "agents"
    test = "a permutation test" if groups.permuted else "the paired t" if agents else "Welch's t"
    units = "the partners, which all met" if agents else "training seeds"
    said = f"{groups.separated:,} of {groups.pairs:,} pairs are separated, by {test} over {units}, "
    said += "adjusted by Holm for all pairs. "
    if not groups.permuted:
        means = "differences" if agents else "scores"
        said += f"A permutation test could not separate any two of so many; t assumes normally distributed {means}. "
    if count <= MOST_LETTERS:
        said += "Rows that share a letter of the column group are not separated. "
    return said + "Places: the highest and the lowest that a row can have, given what is separated."


def _table(games: Games, board: Board, up: str) -> str:
    scores, marks = games.scores, board.groups.marks
    lines = [line_of(entry, marks.get(entry.key)) for entry in board.entries]
    facts = {one.name: one for one in scores.metrics}
    layouts, more = list(scores.settings.play.layouts), list(scores.settings.report.headlines[1:])
    lettered, remarks = 0 < len(marks) <= MOST_LETTERS, any(line.remark for line in lines)
    heads = [_head("entry", "entry", "left", words=True)]
    heads += [_head("group", "group", "left", words=True)] * lettered + [_head("places", "places")] * bool(marks)
    heads += [_head("score", f"{_title(scores, facts)} [95\u00a0%]")]
    heads += [_head(f"on-{i}", f"on {name} [95\u00a0%]", f"on on{i}") for i, name in enumerate(layouts)]
    heads += [_head(name, f"{title_of(facts[name]) if name in facts else name} [95\u00a0%]") for name in more]
    heads += [_head("scenarios", "scenarios passed [95\u00a0%]")]
    heads += [_head(name, name, "left", words=True) for name in ("status", "kind")]
    heads += [_head(name, name, "left more", words=True) for name in ("observation", "human data")]
    heads += [_head(name, name, "more") for name in ("training seeds", "joint steps", "partner runs")]
    heads += [_head("remark", "remark", "left", words=True)] * remarks
    rows = []
    for line in lines:
        cells = [f'<td class="left"><a href="{up}{escape(line.page)}">{escape(line.name)}</a></td>']
        cells += [f'<td class="left">{line.group}</td>'] * lettered
        cells += [_places(line)] * bool(marks)
        cells += _numbers(line, layouts, more, facts, facts.get(scores.headline))
        cells += [f'<td class="left">{escape(text)}</td>' for text in (line.status, line.kind)]
        cells += [f'<td class="left more">{escape(text)}</td>' for text in (line.observation or "", _human(line))]
        cells += [_count(count) for count in (line.training_seeds, line.joint_steps, line.partner_runs)]
        cells += [f'<td class="remark">{escape(line.remark)}</td>'] * remarks
        rows.append(_marked(line, cells))
    label = escape(f"{games.title}: {TABLES[board.table]}")
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{label}"><table class="board few">'
        f"<thead><tr>{''.join(heads)}</tr></thead><tbody>\n" + "\n".join(rows) + "\n</tbody></table></div>"
    )


def _title(scores: Scores, facts: dict[str, MetricFacts]) -> str:
    return title_of(facts[scores.headline]) if scores.headline in facts else scores.headline


def _human(line: Line) -> str:
    return {None: "", True: "yes", False: "no"}[line.human_data]


def _head(key: str, text: str, kind: str = "", words: bool = False) -> str:
    marks = (f' class="{kind}"' if kind else "") + " data-words" * words
    button = f'<button type="button" class="sort">{escape(text)}</button>'
    return f'<th scope="col" data-key="{escape(key)}"{marks}>{button}</th>'


def _marked(line: Line, cells: Sequence[str]) -> str:
    steps = "" if line.joint_steps is None else str(line.joint_steps)
    observation, human = line.observation or "", _human(line)
    marks = {"status": line.status, "kind": line.kind, "observation": observation, "human": human, "steps": steps}
    said = "".join(f' data-{key}="{escape(value)}"' for key, value in marks.items())
    return f"<tr{said}>{''.join(cells)}</tr>"


def _places(line: Line) -> str:
    first = line.places.partition("-")[0]
    return f'<td data-v="{first}">{line.places}</td>' if first else "<td></td>"


def _numbers(
    line: Line,
    layouts: Sequence[str],
    more: Sequence[str],
    facts: dict[str, MetricFacts],
    headline: MetricFacts | None,
) -> Iterator[str]:
    yield _number(line.score, headline, "score")
    for index, name in enumerate(layouts):
        yield _number(line.layouts.get(name), headline, f"on on{index}")
    for name in more:
        yield _number(line.more.get(name), facts.get(name))
    yield _number(line.scenarios, _SHARE)


def _number(estimate: Estimate | None, facts: MetricFacts | None, kind: str = "") -> str:
    marks = f' class="{kind}"' if kind else ""
    if estimate is None or facts is None:
        return f"<td{marks}>{NONE}</td>"
    shown = figure(estimate, facts, True)
    ends = f" <small>{escape(shown.interval)}</small>" if shown.interval else ""
    return f'<td{marks} data-v="{estimate.value:.6g}">{escape(shown.value)}{ends}</td>'


def _count(count: int | None) -> str:
    return f'<td class="more">{NONE}</td>' if count is None else f'<td class="more" data-v="{count}">{count:,}</td>'

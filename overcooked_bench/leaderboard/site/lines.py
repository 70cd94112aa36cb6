"""`Line`: everything that a row says, from which the page, table.json, table.csv and feed.xml are written."""

import csv
from collections.abc import Iterator, Sequence
from html import escape
from io import StringIO
from typing import Any, Final

import msgspec

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.leaderboard.site.board import Games
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.errata import Erratum
from overcooked_bench.leaderboard.site.groups import Mark

SCHEMA: Final = 1
TABLE_JSON: Final = "table.json"
TABLE_CSV: Final = "table.csv"
FEED: Final = "feed.xml"


class Line(msgspec.Struct, frozen=True, kw_only=True):
    """A row. What only a submission says is null for a reference.

    Attributes:
        name: What it is called.
        page: Address of its page, from the index.
        protocol: Name of the protocol.
        protocol_sha256: Its hash.
        pool_sha256: Hash of the pool; null without one.
        table: "main" of methods, "agents", "open" or "unranked".
        status: "reproduced", "spot-checked", "reported", "withdrawn" or "reference".
        remark: Why it stands there; empty if nothing has to be said.
        date: The day of its audit.
        group: Letters; methods, or agents, that share one are not separated. Empty if there are very many of them.
        places: The highest and the lowest place that it can have among those of its table, such as "2-5".
        kind: "method", "runs" or "agent".
        training_seeds: Training runs.
        metric: What the scores are.
        score: Over all layouts, with its 95 % interval.
        layouts: Layout -> score.
        more: Further headlines over all layouts, by metric.
        scenarios: Share of the cooperation scenarios that were passed.
        observation: What its agents observe.
        human_data: Whether recorded games of people were used.
        joint_steps: Environment steps of one training run.
        partner_runs: Runs that produced its training partners.
        agent_sha256: Hash of the agent.
    """

    name: str
    page: str
    protocol: str
    protocol_sha256: str
    pool_sha256: str | None
    table: str
    status: str
    remark: str
    date: str | None
    group: str
    places: str
    kind: str
    training_seeds: int
    metric: str
    score: Estimate | None
    layouts: dict[str, Estimate]
    more: dict[str, Estimate]
    scenarios: Estimate | None
    observation: str | None
    human_data: bool | None
    joint_steps: int | None
    partner_runs: int | None
    agent_sha256: str


def lines_of(games: Sequence[Games]) -> list[Line]:
    """Lists all rows, table by table."""
    return [
        line_of(entry, board.groups.marks.get(entry.key))
        for one in games
        for board in one.boards
        for entry in board.entries
    ]


def line_of(entry: Entry, mark: Mark | None = None) -> Line:
    """Writes the row of an entry."""
    scores, manifest = entry.scores, entry.manifest
    by_layout = {
        layout: row.estimate
        for layout in scores.settings.play.layouts
        if (row := scores.find(scores.headline, layout=layout)) is not None
    }
    return Line(
        name=entry.name,
        page=f"entries/{entry.key}.html",
        protocol=scores.protocol.name,
        protocol_sha256=scores.protocol.sha256,
        pool_sha256=scores.pool.sha256 if scores.pool else None,
        table=entry.table,
        status=entry.status,
        remark=entry.remark,
        date=entry.audit.date if entry.audit else None,
        group=mark.letters if mark else "",
        places=mark.places if mark else "",
        kind=scores.kind,
        training_seeds=scores.training_seeds,
        metric=scores.headline,
        score=scores.overall,
        layouts=by_layout,
        more=_more(scores),
        scenarios=scores.scenarios.total.share if scores.scenarios else None,
        observation=manifest.observation if manifest else None,
        human_data=manifest.human_data if manifest else None,
        joint_steps=manifest.joint_steps if manifest else None,
        partner_runs=manifest.partner_runs if manifest else None,
        agent_sha256=scores.agent.sha256,
    )


def _more(scores: Scores) -> dict[str, Estimate]:
    names = scores.settings.report.headlines[1:]
    return {name: row.estimate for name in names if (row := scores.find(name)) is not None}


def as_json(lines: Sequence[Line]) -> str:
    """Writes table.json."""
    content = {"schema": SCHEMA, "entries": [msgspec.to_builtins(line) for line in lines]}
    return msgspec.json.format(msgspec.json.encode(content), indent=1).decode() + "\n"


def as_csv(lines: Sequence[Line]) -> str:
    """Writes table.csv: a number with an interval becomes three columns."""
    rows = [dict(_flat(msgspec.to_builtins(line))) for line in lines]
    heads = list(dict.fromkeys(key for row in rows for key in row))
    file = StringIO()
    writer = csv.DictWriter(file, heads, restval="")
    writer.writeheader()
    writer.writerows(rows)
    return file.getvalue()


def _flat(row: dict[str, Any], head: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in row.items():
        if isinstance(value, dict) and "value" in value:
            yield head + key, value["value"]
            yield from ((f"{head}{key} {end}", value[end]) for end in ("low", "high"))
        elif isinstance(value, dict):
            yield from _flat(value, f"{head}{key} ")
        else:
            yield head + key, _text(value) if isinstance(value, str) else value


def _text(text: str) -> str:
    """Returns a text that no spreadsheet takes for a formula."""
    return "'" + text if text[:1] in ("=", "+", "-", "@") else text


def as_feed(lines: Sequence[Line], errata: Sequence[Erratum]) -> str:
    """Writes feed.xml, RSS 2.0: what was audited, and errata, the latest first."""
    dated = [
        (
            line.date or "",
            f"{line.name}: {line.status}",
            line.page,
            f"{line.agent_sha256}-{line.protocol_sha256[:8]}-{line.status}",
            _said(line),
        )
        for line in lines
        if line.date
    ]
    dated += [(one.date, f"Erratum: {one.about}", "errata.html", f"{one.date} {one.about}", one.said) for one in errata]
    items = "".join(
        f"<item><title>{escape(title)}</title><link>{escape(page)}</link>"
        f'<guid isPermaLink="false">{escape(guid)}</guid>'
        f"<description>{escape(f'{date}; {said}')}</description></item>\n"
        for date, title, page, guid, said in sorted(dated, reverse=True)
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n<rss version="2.0"><channel>'
        "<title>overcooked-bench leaderboard</title>"
        f"<link>index.html</link><description>Audited entries and errata</description>\n{items}</channel></rss>\n"
    )


def _said(line: Line) -> str:
    score = f"{line.metric} {line.score.text(2)}" if line.score else "no overall score"
    return "; ".join(filter(None, (f"protocol {line.protocol}", score, line.remark)))

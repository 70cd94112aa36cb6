"""The page of an entry: its score, its partners, its scenarios, and the commands that give every number again."""

import shlex
from collections.abc import Iterator
from html import escape
from pathlib import Path
from urllib.parse import urlencode

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.card import card_table, columns_note
from overcooked_bench.evaluation.shown.sections import headline, partners, section
from overcooked_bench.evaluation.shown.sections.partners import partners_section
from overcooked_bench.evaluation.shown.sections.played import notes_section, played_section
from overcooked_bench.evaluation.shown.sections.scenarios import scenarios_section
from overcooked_bench.evaluation.shown.sections.section import Material
from overcooked_bench.leaderboard.site.board import TABLES, Games
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.look import whole
from overcooked_bench.rendering.page import contents, definitions, note
from overcooked_bench.rendering.page import section as titled
from overcooked_bench.rendering.table import Code, Column, Table

_WIDEST = 140
_SAID, _AUDIT = "What it says of itself", "Audit"
_SECTIONS = (partners_section, scenarios_section, notes_section, played_section)
_STYLE = section.STYLE + headline.STYLE + partners.STYLE


def entry_page(entry: Entry, games: Games, reference: Scores | None) -> str:
    """Writes the page of an entry.

    Args:
        entry: The entry.
        games: What it played.
        reference: Score of the protocol's reference agent in the same games; None if there is none.
    """
    scores = entry.scores
    beside = Beside(None if reference is None or reference.agent == scores.agent else reference)
    material = Material(scores, Path(entry.key), beside)
    shown = [made for make in _SECTIONS if (made := make(material)) is not None]
    score = [card_table(scores, beside, _WIDEST).html(), note(columns_note(scores))]
    link = urlencode(
        {"first": entry.key, "second": f"_{reference.agent.name}-{reference.protocol.name}"}
        if beside.reference and reference
        else {"first": entry.key}
    )
    score.append(
        f'<p><a href="../curves-{games.mark}.html#{escape(link)}">Ordered curve beside any other entry</a></p>'
    )
    said = {_SAID: bool(entry.manifest), _AUDIT: bool(entry.audit)}
    titles = ["Score", *(name for name, there in said.items() if there), *(one.title for one in shown), "Reproduce it"]
    body = [
        f"<h1>{escape(entry.name)}</h1>",
        note(f"{games.title}; {entry.status}; {TABLES[entry.table]}", "sub"),
        *([note(entry.remark, "warn")] if entry.remark else []),
        *(note(f"Fault: {fault}", "warn") for fault in scores.faults[:3]),
        contents(titles),
        *titled("Score", *score),
        *_said(entry),
        *(part for one in shown for part in titled(one.title, *one.parts)),
        *titled("Reproduce it", _commands(entry)),
    ]
    return whole(f"{entry.name}: overcooked-bench leaderboard", body, "../", _STYLE)


def _said(entry: Entry) -> Iterator[str]:
    """Yields what the submission says, and what its audit found."""
    manifest, audit = entry.manifest, entry.audit
    if manifest is not None:
        facts = [
            ("method", manifest.method),
            ("contact", manifest.contact),
            ("licence", manifest.licence),
            ("link", manifest.link or "none"),
            ("commit", manifest.commit or "the training code is not public"),
            ("budget", f"{manifest.joint_steps:,} joint steps a training seed, {manifest.partner_runs:,} partner runs"),
            ("human data", "used" if manifest.human_data else "not used"),
            ("trained with", ", ".join(manifest.training_pools) or "no public pool"),
            ("selected with", ", ".join(manifest.selection_pools) or "no public pool"),
            ("observation", manifest.observation),
        ]
        yield from titled(_SAID, definitions(facts))
    if audit is not None:
        checks = Table(
            ["check", Column("verdict", left=True), Column("what was compared", left=True)],
            [[check.name, check.verdict, "; ".join((check.said, *check.problems))] for check in audit.checks],
        )
        flags = "".join(note(f"Flag, {flag.kind}: {flag.said}") for flag in audit.flags)
        said = f"Audited on {audit.date}: {audit.played:,} of {audit.cells:,} cells played again."
        yield from titled(_AUDIT, note(said), checks.html(), flags)


def _commands(entry: Entry) -> str:
    scores = entry.scores
    agent = scores.agent.name if entry.manifest is None else f"{entry.manifest.name}/agent.py"
    words = ["overcooked-bench", "score", agent, "--protocol", scores.protocol.name, "--seed", str(scores.seed)]
    words += ["--salt", scores.salt] if scores.salt != scores.settings.play.salt else []
    words += ["--isolate"] if entry.manifest is not None else []
    return Table([Column("command", left=True)], [[Code(shlex.join(words))]]).html()

"""The page of an entry: its score, its partners, its scenarios, its worst games, and how to reproduce every number."""

import re
import shlex
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Final
from urllib.parse import urlencode

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE, read_explanation
from overcooked_bench.evaluation.scores import MEAN, Scores
from overcooked_bench.evaluation.shown.card import card_table, columns_note
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.sections import partners, section
from overcooked_bench.evaluation.shown.sections.conduct import conduct_section
from overcooked_bench.evaluation.shown.sections.failure import failure_section
from overcooked_bench.evaluation.shown.sections.partners import partners_section
from overcooked_bench.evaluation.shown.sections.played import notes_section, played_section
from overcooked_bench.evaluation.shown.sections.scenarios import scenarios_section
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.sections.worst import worst_section
from overcooked_bench.evaluation.shown.tables import NONE, figure
from overcooked_bench.files import shown
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.leaderboard.site.board import TABLES, Games
from overcooked_bench.leaderboard.site.entries import Entry, EntryError
from overcooked_bench.leaderboard.site.pages.curves import curves_part
from overcooked_bench.leaderboard.site.pages.look import link, outside, whole
from overcooked_bench.leaderboard.site.worst import worst_games
from overcooked_bench.rendering.page import contents, note
from overcooked_bench.rendering.page import section as titled
from overcooked_bench.rendering.table import Cell, Column, Table
from overcooked_bench.rendering.viewer.games import pack_game, player, script

_WIDEST: Final = 140
_SAID: Final = "What it says of itself"
_STYLE: Final = section.STYLE + partners.STYLE


def entry_page(entry: Entry, reference: Scores | None) -> str:
    """Writes the page of an entry.

    Args:
        entry: The entry.
        reference: Score of the protocol's reference agent in the same games; None if there is none.

    Raises:
        WrongUse: Its worst games or its explanation cannot be read, or are of another score.
    """
    scores, games = entry.scores, Games(entry.scores, False, ())
    beside = Beside(None if reference is None or reference.agent == scores.agent else reference)
    material = Material(scores, Path(_played_in(entry)), beside)
    made = [partners_section(material), scenarios_section(material), conduct_section(material), _failure(entry)]
    made += [_worst(entry, material), notes_section(material), played_section(material)]
    sections = [
        Section("Score", [card_table(scores, beside, _WIDEST).html(), *_below(scores)]),
        *_said(entry),
        *_audited(entry),
        Section("Ordered curves", [*_other_curves(entry, games), *curves_part(entry, beside.reference)]),
        *(one for one in made if one is not None),
        Section("Reproduce it", [_commands(entry)]),
    ]
    body = [
        f"<h1>{escape(entry.name)}</h1>",
        f'<p class="sub">{link(f"../{games.page}", games.title)}; {entry.status}; {escape(TABLES[entry.table])}</p>',
        *_standing(entry),
        contents(one.title for one in sections),
        *(part for one in sections for part in titled(one.title, *one.parts)),
    ]
    body += [script()] if any("data-kitchen" in part for part in body) else []
    return whole(f"{entry.name}: overcooked-bench leaderboard", body, "../", _STYLE)


def _standing(entry: Entry) -> Iterator[str]:
    """Yields why an entry is where it stands, and what its agent did wrong."""
    if entry.remark:
        own = entry.remark == shown(entry.scores.unranked or "", 300)
        yield note(f"{'Not ranked: ' * own}{entry.remark}", "warn")
    yield from (note(f"Fault: {fault}", "warn") for fault in entry.scores.faults[:3])


def _below(scores: Scores) -> Iterator[str]:
    """Yields what the columns of the card are, all their numbers with intervals, and links to the layouts."""
    yield note(columns_note(scores))
    known = {one.name: one for one in scores.metrics}
    names = [name for name in scores.settings.report.headlines if name in known]
    strata = list(dict.fromkeys(row.stratum for row in scores.rows if row.stratum is not None and row.partner is None))
    columns: list[tuple[str, str, dict[str, str]]] = [(title_of(known[name]), name, {}) for name in (*names, MEAN)]
    columns += [(f"{title_of(known[names[0]])} with {one}", names[0], {"stratum": one}) for one in strata if names]
    rows: list[list[Cell]] = []
    for layout in (*(one.layout for one in scores.layouts), None):
        found = [(scores.find(name, layout=layout, **about), known[name]) for _, name, about in columns]
        cells: list[Cell] = [NONE if row is None else figure(row.estimate, facts, True) for row, facts in found]
        rows.append([layout or "mean of layouts", *cells])
    table = Table(["layout", *(f"{title} [95 %]" for title, *_ in columns)], rows)
    yield f"<details><summary>With all intervals</summary>{table.html()}</details>"
    yield from _layouts(scores)


def _layouts(scores: Scores) -> Iterator[str]:
    names = [name for name in scores.settings.play.layouts if name in layout_names()]
    links = "".join(link(f"../layouts/{name}.html", name) for name in names)
    yield f'<nav aria-label="Layouts">Layouts: {links}</nav>'


def _said(entry: Entry) -> Iterator[Section]:
    """Yields what the submission says; addresses of https are links."""
    if entry.manifest is None:
        return
    said = entry.manifest
    facts = {
        "method": escape(said.method),
        "contact": outside(said.contact),
        "licence": escape(said.licence),
        "link": outside(said.link or "none"),
        "commit": escape(said.commit or "the training code is not public"),
        "budget": f"{said.joint_steps:,} joint steps per training seed, {said.partner_runs:,} partner runs",
        "human data": "used" if said.human_data else "not used",
        "trained with": escape(", ".join(said.training_pools) or "no public pool"),
        "selected with": escape(", ".join(said.selection_pools) or "no public pool"),
        "observation": escape(said.observation),
        "training seeds": f"{said.training_seeds}",
    }
    if entry.shipped:
        facts = {name: text for name, text in facts.items() if name not in ("contact", "link", "commit")}
    yield Section(
        _SAID, ["<dl>" + "".join(f"<dt>{name}</dt><dd>{text}</dd>" for name, text in facts.items()) + "</dl>"]
    )


def _audited(entry: Entry) -> Iterator[Section]:
    audit = entry.audit
    if audit is None:
        return
    checks = Table(
        ["check", Column("verdict", left=True), Column("what was compared", left=True)],
        [[check.name, check.verdict, "; ".join((check.said, *check.problems))] for check in audit.checks],
    )
    flags = "".join(note(f"Flag, {flag.kind}: {flag.said}") for flag in audit.flags)
    said = f"Audited on {audit.date}: {audit.played:,} of {audit.cells:,} cells were played again."
    yield Section("Audit", [note(said), checks.html(), flags])


def _other_curves(entry: Entry, games: Games) -> Iterator[str]:
    chosen = urlencode({"first": entry.key})
    yield f'<p class="note">{link(f"../{games.curves}#{chosen}", "Beside any other entry of the protocol")}</p>'


def _failure(entry: Entry) -> Section | None:
    """Shows the explanation of exactly this score; None if there is none.

    Raises:
        WrongUse: It cannot be read, or is of another score.
    """
    scores, folder = entry.scores, entry.folder
    if folder is None or not (folder / EXPLAIN_FILE).is_file():
        return None
    found = read_explanation(folder)
    if (found.agent, found.pool, found.protocol) != (scores.agent, scores.pool, scores.protocol):
        raise EntryError(f"{EXPLAIN_FILE} is of another score; explain it again")
    return failure_section(Material(scores, Path(_played_in(entry)), explanation=found))


def _worst(entry: Entry, material: Material) -> Section | None:
    """Lists the worst cells, and plays their games if they were kept."""
    made = worst_section(material)
    if made is None:
        return None
    games = [
        f"<details{' open' * (number == 0)}><summary>{escape(one.title)}</summary>"
        f"{player(pack_game(one.layout, one.frames(), one.names, one.title))}</details>"
        for number, one in enumerate(worst_games(entry.scores, entry.folder))
    ]
    return Section("Worst cells", [*games, *made.parts])


def _played_in(entry: Entry) -> str:
    """Returns the folder that the commands of the page play into."""
    return f"scores/{entry.name}-{entry.scores.protocol.name}"


def _commands(entry: Entry) -> str:
    """Writes the commands that give the score again, from installing to auditing."""
    scores = entry.scores
    version = str(scores.run.get("versions", {}).get("overcooked-bench", ""))
    exact = f"=={version}" if re.fullmatch(r"[0-9][0-9A-Za-z.+-]{0,30}", version) else ""
    agent = scores.agent.name if entry.shipped else entry.name
    folder = _played_in(entry)
    played = ["score", agent, "--protocol", scores.protocol.name, "--seed", str(scores.seed)]
    played += ["--salt", scores.salt] if scores.salt != scores.settings.play.salt else []
    played += [] if entry.shipped else ["--isolate"]
    commands = [
        ("install the version that played it", ["pip", "install", f"overcooked-bench{exact}"]),
        ("play all games", ["overcooked-bench", *played, "--output", folder]),
        ("watch its worst game", ["overcooked-bench", "replay", folder, "--worst"]),
    ]
    if not entry.shipped:
        audit = ["overcooked-bench", "leaderboard", "audit", folder, "--agent", agent, "--all"]
        commands.append(("compare with every number", audit))
    shown = "".join(f"<dt>{what}</dt><dd><code>{escape(shlex.join(words))}</code></dd>" for what, words in commands)
    return f"<dl>{shown}</dl>"

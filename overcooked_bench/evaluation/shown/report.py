"""A score as one HTML page that needs nothing else: tables, the ordered curve, the pairs that went worst."""

import shlex
from collections.abc import Iterable
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import CategoryScore, Cell, LayoutScore, ScenarioScore, Scores
from overcooked_bench.evaluation.shown.plots import draw_curve
from overcooked_bench.evaluation.shown.tables import count_text, interval_text, notes

MOST_WORST: Final = 10
"""Pairs that are listed as the worst."""

_STYLE: Final = """
:root { color-scheme: light dark; --line: #8884; --dim: #777; --warm: #d55e00; --cool: #0072b2; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 68rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .5rem; }
p.sub, p.note, td small { color: var(--dim); } p.note { margin: .2rem 0; font-size: .9rem; }
div.wide { overflow-x: auto; } table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .8rem .25rem 0; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child, td.left, th.left { text-align: left; } tr.sum td { font-weight: 600; }
th { font-weight: 600; font-size: .9rem; } code { font-size: .85rem; user-select: all; }
td:has(> code), table:has(code) th:last-child { text-align: left; white-space: normal; padding-left: 1rem; }
figure { margin: 0; background: #fff; border-radius: .4rem; } figure svg { width: 100%; height: auto; display: block; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; font-size: .9rem; }
dt { color: var(--dim); } dd { margin: 0; overflow-wrap: anywhere; }
summary { cursor: pointer; margin: .4rem 0; }
"""


def write_report(scores: Scores, file: str | Path) -> None:
    """Writes the page.

    Args:
        scores: What to show.
        file: Where to; the commands on the page name its folder.
    """
    folder = Path(file).parent
    body = [
        f"<h1>{escape(scores.agent.name)}</h1>",
        f'<p class="sub">{escape(_subtitle(scores))}</p>',
        *_section("Scores", _score_table(scores), *(f'<p class="note">{escape(note)}</p>' for note in notes(scores))),
        *_section("Ordered curve", f"<figure>{_curve(scores)}</figure>", _curve_note(scores)),
        *_section("Worst pairs", _worst_table(scores, folder)),
        *_section("Cooperation scenarios", _scenario_table(scores.scenarios) if scores.scenarios else ""),
        *_section("Every partner", *(_partner_table(layout, scores) for layout in scores.layouts)),
        *_section("What was played", _facts(scores)),
    ]
    title = escape(f"{scores.agent.name}: overcooked-bench score")
    page = (
        f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{title}</title>\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<style>{_STYLE}</style></head>\n'
        "<body>\n" + "\n".join(body) + "\n</body></html>\n"
    )
    Path(file).write_text(page, "utf-8")


def _subtitle(scores: Scores) -> str:
    pool = f", pool {scores.pool.name}" if scores.pool else ""
    seeds = f"{scores.training_seeds} training seed" + "s" * (scores.training_seeds > 1)
    return f"protocol {scores.protocol.name} version {scores.settings.version}{pool}, {seeds}"


def _section(title: str, *parts: str) -> list[str]:
    return [f"<h2>{escape(title)}</h2>", *parts] if any(parts) else []


def _table(head: Iterable[str], rows: Iterable[Iterable[str]], last: Iterable[str] = ()) -> str:
    """Lays cells out; they are HTML already."""
    lines = ["<tr>" + "".join(f"<th>{cell}</th>" for cell in head) + "</tr>"]
    lines += ["<tr>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>" for row in rows]
    foot = "".join(f"<td>{cell}</td>" for cell in last)
    return (
        '<div class="wide"><table>\n'
        + "\n".join(lines)
        + (f'<tr class="sum">{foot}</tr>' if foot else "")
        + "</table></div>"
    )


def _score_table(scores: Scores) -> str:
    levels = scores.settings.report.thresholds
    seats = [f"seat {seat}" for seat in scores.settings.play.seats]
    head = ["layout", "mean [95 %]", *seats, *(f"≥ {soups:g}" for soups in levels), "worst 15 %", "worst", "best"]
    rows = [
        [
            escape(layout.layout),
            _number(layout.mean),
            *(f"{seat.value:.1f}" for seat in layout.seats),
            *(f"{t.reached.value:g} of {layout.partners}" for t in layout.thresholds),
            _number(layout.tail_mean),
            _name(layout.worst),
            _name(layout.best),
        ]
        for layout in scores.layouts
    ]
    last = ["mean of layouts", _number(scores.overall)] if scores.overall and len(rows) > 1 else []
    return _table(head, rows, last) if rows else ""


def _worst_table(scores: Scores, folder: Path) -> str:
    pairs = sorted(
        ((layout.layout, cell) for layout in scores.layouts for cell in layout.cells),
        key=lambda pair: (pair[1].mean.value, pair[0], pair[1].partner),
    )[:MOST_WORST]
    rows = [
        [
            escape(layout),
            _name(cell),
            _number(cell.mean),
            f"<code>{escape(_replay_command(folder, layout, cell))}</code>",
        ]
        for layout, cell in pairs
    ]
    return _table(["layout", "partner", "mean [95 %]", "watch its worst episode"], rows) if rows else ""


def _scenario_table(scenarios: ScenarioScore) -> str:
    def row(one: CategoryScore) -> list[str]:
        passed = f"{count_text(one.passed)} of {one.items}"
        missing = count_text(one.not_attempted) if one.not_attempted else "-"
        return [escape(one.category), passed, _number(one.share, 2), str(one.families), missing]

    head = ["category", "passed", "mean of families [95 %]", "families", "not attempted"]
    return _table(head, map(row, scenarios.categories), row(scenarios.total))


def _replay_command(folder: Path, layout: str, cell: Cell) -> str:
    words = ["overcooked-bench", "replay", str(folder), "--layout", layout, "--partner", cell.partner, "--worst"]
    return shlex.join(words)


def _partner_table(layout: LayoutScore, scores: Scores) -> str:
    seats = [f"seat {seat}" for seat in scores.settings.play.seats]
    head = ["partner", "kind", "mean [95 %]", *seats, "own soups", "partner's soups", "SHA-256"]
    rows = [
        [
            _name(cell),
            cell.kind,
            _number(cell.mean),
            *(f"{seat.value:.1f}" for seat in cell.seats),
            f"{cell.ego_soups:.2f}",
            f"{cell.partner_soups:.2f}",
            f"<small>{cell.sha256[:12]}</small>",
        ]
        for cell in (*layout.cells, *layout.floors)
    ]
    return f"<details><summary>{escape(layout.layout)}</summary>{_table(head, rows)}</details>"


def _curve(scores: Scores) -> str:
    if not scores.layouts:
        return ""
    buffer = BytesIO()
    draw_curve(scores, buffer, "svg")
    text = buffer.getvalue().decode()
    return text[text.index("<svg") :]


def _curve_note(scores: Scores) -> str:
    said = "Partners in ascending order of their mean, sorted anew for each training seed."
    if scores.training_seeds < 2:
        said += " One training run: no bands."
    return f'<p class="note">{said}</p>'


def _facts(scores: Scores) -> str:
    s, suite = scores.settings.play, scores.scenarios and scores.scenarios.suite
    facts = {
        "agent": f"{scores.agent.name}, SHA-256 {scores.agent.sha256}",
        "protocol": f"{scores.protocol.name}, version {scores.settings.version}, SHA-256 {scores.protocol.sha256}",
        "pool": f"{scores.pool.name}, SHA-256 {scores.pool.sha256}" if scores.pool else "none",
        "episodes": f"{s.episodes} start states per partner, {s.horizon} steps, cooking {s.cooking}, start {s.start}",
        "frozen policies": f"mode {s.mode}",
        "seed": str(scores.seed),
        "salt": scores.salt,
        "run": ", ".join(f"{key} {value}" for key, value in scores.run.items() if not isinstance(value, dict)),
        "scenarios": f"{suite.name}, SHA-256 {suite.sha256}" if suite else "not played",
        "versions": ", ".join(f"{key} {value}" for key, value in scores.run.get("versions", {}).items()),
    }
    return "<dl>" + "".join(f"<dt>{escape(k)}</dt><dd>{escape(v)}</dd>" for k, v in facts.items()) + "</dl>"


def _name(cell: Cell) -> str:
    return escape(cell.partner + "*" * cell.is_ego)


def _number(estimate: Estimate, digits: int = 1) -> str:
    value, _, interval = interval_text(estimate, digits).partition(" ")
    return f"{value} <small>{interval}</small>" if interval else value

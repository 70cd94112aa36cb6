"""The heat map: how well the agent cooperates with each partner on each layout, by stratum of partners."""

from collections.abc import Iterator, Sequence
from functools import cache, partial
from html import escape
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, Row, Scores
from overcooked_bench.evaluation.shown.card import STRATA
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.figures import DIM, Plot, short_name
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.tables import NONE, figure, name_of
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.table import Cell, Column, Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE: Final = """
table.heat { font-size: .85rem; border-collapse: separate; border-spacing: 2px; }
table.heat th, table.heat td { padding: .15rem .4rem; border: 0; }
table.heat thead th { writing-mode: vertical-rl; transform: rotate(180deg); text-align: left; font-size: .85rem; }
table.heat thead th:first-child { writing-mode: horizontal-tb; transform: none; }
table.heat tbody th { font-weight: 400; text-align: left; font-size: .85rem; }
table.heat tr.stratum > * { font-weight: 600; padding-top: .7rem; vertical-align: top; line-height: 1.2; }
table.heat tr > :first-child { padding-left: 0; }
table.heat td { border-radius: 3px; min-width: 2.4rem; }
@media (max-width: 40rem) { table.heat, table.heat thead th, table.heat tbody th { font-size: .75rem; }
  table.heat { border-spacing: 1px; } table.heat td { min-width: 2rem; }
  table.heat th, table.heat td { padding: .1rem .2rem; } }
p.scale i { display: inline-block; width: 9rem; height: .7rem; margin: 0 .5rem; border-radius: 3px; }
"""

_MAP: Final = "cividis"


class _Line(NamedTuple):
    """A row of the map: a partner, and its number on each layout; None where it does not play."""

    stratum: str
    name: str
    rows: tuple[Row | None, ...]

    @property
    def mean(self) -> float:
        return float(np.mean([row.value for row in self.rows if row is not None]))


def partners_section(material: Material) -> Section | None:
    """Draws the heat map, of the headline if it is known for single partners, else of the mean return."""
    scores, facts = material.scores, material.by_partner
    lines = _lines(scores, facts) if facts else []
    if facts is None or not lines:
        return None
    top = 1.0 if facts.name != MEAN else max(20.0, *(row.value for line in lines for row in line.rows if row))
    plot = Plot(
        partial(_paint, scores=scores, facts=facts, lines=lines, top=top), _size(scores, lines), title_of(facts)
    )
    parts = [_html(material, facts, lines, top), _scale(facts, top), note(_note(material, facts, lines))]
    return Section("Partners", parts, {"partners": _table(scores, facts, lines)}, {"partners": plot})


def _lines(scores: Scores, facts: MetricFacts) -> list[_Line]:
    """Returns the partners that count, by stratum, the worst first."""
    found: dict[tuple[str, str], list[Row | None]] = {}
    for index, layout in enumerate(scores.layouts):
        for label in layout.partners:
            row = scores.find(facts.name, layout=layout.layout, partner=label.name)
            if label.counts and row is not None:
                found.setdefault((label.stratum, name_of(label)), [None] * len(scores.layouts))[index] = row
    lines = [_Line(stratum, name, tuple(rows)) for (stratum, name), rows in found.items()]
    order = {name: place for place, name in enumerate(STRATA)}
    return sorted(lines, key=lambda line: (order.get(line.stratum, len(order)), line.stratum, line.mean, line.name))


def _note(material: Material, facts: MetricFacts, lines: Sequence[_Line]) -> str:
    said = (
        f"{title_of(facts)} with each partner, one stratum after the other, the worst partner first; empty where a "
        "partner does not play."
    )
    if material.reference is not None:
        said += f" Beside the name of a stratum: its own, and below that of {material.reference.agent.name}."
    known = [STRATA[name] for name in dict.fromkeys(line.stratum for line in lines) if name in STRATA]
    return said + (f" Strata: {'; '.join(known)}." if known else "")


def _html(material: Material, facts: MetricFacts, lines: Sequence[_Line], top: float) -> str:
    layouts = [layout.layout for layout in material.scores.layouts]
    heads = "".join(f'<th scope="col">{escape(layout)}</th>' for layout in layouts)
    return (
        f'<div class="wide"><table class="heat"><thead><tr><th scope="col">partner</th>{heads}</tr></thead><tbody>'
        + "".join(_html_rows(material, facts, lines, top))
        + "</tbody></table></div>"
    )


def _html_rows(material: Material, facts: MetricFacts, lines: Sequence[_Line], top: float) -> Iterator[str]:
    layouts, before = [layout.layout for layout in material.scores.layouts], None
    for line in lines:
        if line.stratum != before:
            before = line.stratum
            cells = "".join(_stratum_cell(material, facts, layout, before) for layout in layouts)
            yield f'<tr class="stratum"><th scope="row">{escape(before)}</th>{cells}</tr>'
        cells = "".join(
            "<td></td>" if row is None else _cell(row, facts, top, f"{line.name} on {layout}")
            for row, layout in zip(line.rows, layouts, strict=True)
        )
        yield f'<tr><th scope="row">{escape(line.name)}</th>{cells}</tr>'


def _stratum_cell(material: Material, facts: MetricFacts, layout: str, stratum: str) -> str:
    about = {"layout": layout, "stratum": stratum}
    own, other = (
        material.scores.find(facts.name, **about),
        material.reference and material.reference.find(facts.name, **about),
    )
    if own is None:
        return "<td></td>"
    beside = f"<br><small>{figure(other.estimate, facts, False)}</small>" if other else ""
    return f"<td>{figure(own.estimate, facts, False)}{beside}</td>"


def _cell(row: Row, facts: MetricFacts, top: float, about: str) -> str:
    ground, ink = _colours(row.value / top)
    text, whole = figure(row.estimate, facts, False), figure(row.estimate, facts, True)
    return f'<td style="background: {ground}; color: {ink}" title="{escape(f"{about}: {whole}")}">{text}</td>'


def _colours(share: float) -> tuple[str, str]:
    """Returns the colours of a cell's ground and text."""
    share = min(1.0, max(0.0, share))
    return _grounds()[min(255, int(share * 256))], "#000000" if share > 0.55 else "#ffffff"


@cache
def _grounds() -> list[str]:
    """Returns the 256 colours of the map, which looks each of them up slowly."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [to_hex(colour) for colour in colormaps[_MAP](range(256))]


def _scale(facts: MetricFacts, top: float) -> str:
    stops = ", ".join(_colours(step / 8)[0] for step in range(9))
    least, most = f"{0:.{min(1, facts.digits)}f}", f"{top:.{min(1, facts.digits)}f}"
    return (
        f'<p class="note scale">{least} or less<i style="background: linear-gradient(to right, {stops})"></i>'
        f"{most}{' or more' * (top == 1.0)}</p>"
    )


def _table(scores: Scores, facts: MetricFacts, lines: Sequence[_Line]) -> Table:
    heads = [Column("stratum", left=True), Column("partner", left=True)]
    rows: list[list[Cell]] = [
        [line.stratum, line.name, *(NONE if row is None else figure(row.estimate, facts, True) for row in line.rows)]
        for line in lines
    ]
    return Table([*heads, *(layout.layout for layout in scores.layouts)], rows)


def _size(scores: Scores, lines: Sequence[_Line]) -> tuple[float, float]:
    return 2.6 + 0.62 * len(scores.layouts), 1.7 + 0.17 * (len(lines) + len({line.stratum for line in lines}))


def _paint(painted: "Figure", scores: Scores, facts: MetricFacts, lines: Sequence[_Line], top: float) -> None:
    axes = painted.subplots()
    values = np.array([[np.nan if row is None else row.value for row in line.rows] for line in lines])
    axes.imshow(values, cmap=_MAP, vmin=0, vmax=top, aspect="auto")
    for (y, x), value in np.ndenumerate(values):
        row = lines[y].rows[x]
        if row is not None:
            text, ink = str(figure(row.estimate, facts, False)), _colours(value / top)[1]
            axes.text(x, y, text, ha="center", va="center", fontsize=6, color=ink)
    axes.set_yticks(range(len(lines)), [line.name for line in lines], fontsize=7)
    axes.set_xticks(
        range(len(scores.layouts)), [short_name(layout.layout) for layout in scores.layouts], rotation=40, ha="left"
    )
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    for stratum in dict.fromkeys(line.stratum for line in lines):
        places = [place for place, line in enumerate(lines) if line.stratum == stratum]
        if places[0]:
            axes.axhline(places[0] - 0.5, color="#ffffff", linewidth=3)
        middle = ((places[0] + places[-1]) / 2, stratum)
        axes.annotate(
            *(middle[1], (1.02, middle[0])),
            xycoords=("axes fraction", "data"),
            rotation=-90,
            va="center",
            fontsize=7,
            color=DIM,
        )
    axes.set_xlabel(f"{title_of(facts)} of {scores.agent.name}")

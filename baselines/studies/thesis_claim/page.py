"""The result page: result.md, in the words of the plan."""

import textwrap
from collections.abc import Sequence
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.shown.comparison import p_text
from overcooked_bench.evaluation.shown.ordered_tables import label
from overcooked_bench.rendering.table import Column, Table

from .analysis import SMALLEST
from .result import ArmMeans, Other, Result, Test
from .view import View

DIFFERENCES: Final = "differences.png"
BLOCKS: Final = "blocks.png"

_HEAD: Final = """# The thesis's claim: does a diverse population cooperate with more strangers?

`python -m overcooked_bench.baselines.studies.thesis_claim report` makes this page, its pictures and `result.json` from
the records in this folder. [The plan](../plan.md) was registered before anything was trained: plan {plan}, recipe
{recipe}, code {code}. Played: {play}, with the pool {pool}. {code_note}

Blocks: {blocks}. N: 0 as the better of `stay` and `random` with a partner, 1 as the best known responder. Home:
partners that the trainer of these agents made; away: other trainers, people and scripts, a third each. Differences are
paired within blocks; intervals are Student's t over blocks."""

_PRIMARY: Final = """## The answer

{verdicts}

The thesis's claim is judged by *home*: its strangers were self-play agents of its own trainer. *Away* says whether it
extends to others. Intervals agree with Holm's procedure for the two comparisons together; the smallest difference of
interest is {smallest:g}."""

_SECONDARY: Final = """## Secondary comparisons

Intervals are 95 % for each by itself. The last column is p, adjusted for all of them by Holm's procedure: these
comparisons qualify the answer and do not change it."""

_NULL: Final = """## Null control

Two self-play agents of the same block, which differ in their training seed alone: what the same comparison says where
there is no difference."""

_ARMS: Final = """## Every arm

Means over blocks. `sp`: self-play; `sp-long`, `sa`: self-play and state-augmented self-play for as many steps as a
final agent; `pp`: final agent with five self-play agents; `nd`, `l0`: final agent of a population without and with
diversity bonus. Failed runs count as 0."""

_ROWS: Final = """## The other rows of Table 7.2

Descriptive: the thesis's other settings, less `{beside}` of the same blocks; 95 % for each by itself, unadjusted."""

_VIEW: Final = """## The thesis's view

Descriptive. Its formula (0.15 quantile over rows of the ordered curve, as a part of the best pair of self-play agents),
but as many rows for all and no final agent chosen. Partners are the self-play agents `sp` of the other blocks. "any 3"
and "3 x better of 2" are the same self-play agents, reported as the thesis reports a population: what its way of
reporting does alone."""

_OTHERS: Final = """## With other pools

The registered pool decides. The same comparisons with pools that came later:"""


def written(result: Result, beside: str) -> str:
    """Writes the page in Markdown.

    Args:
        result: Everything.
        beside: What the arms that decide nothing are held against.
    """
    parts: list[str | Table] = [_head(result), _answer(result), _tests(result.primary, level=True)]
    parts += [
        f"![Differences with their intervals]({DIFFERENCES})",
        f"![Each block's difference, L0 less self-play of the same length]({BLOCKS})",
        *(_NULL, _tests(result.null)),
        *(_SECONDARY, _tests(result.secondary)),
        *(_ARMS, _arms(result.arms)),
    ]
    if result.rows:
        parts += [_ROWS.format(beside=beside), _tests(result.rows)]
    if result.views:
        parts.append(_VIEW)
        for view in result.views:
            parts += [f"![Ordered curves on {view.layout}](view-{view.layout}.png)", _view(view)]
    if result.others:
        parts += [_OTHERS, *(part for other in result.others for part in _other(other))]
    parts += ["## Cost", _hours(result), "## Deviations from the plan", result.deviations or "None."]
    texts = [_wrapped(part) if isinstance(part, str) else part.markdown() for part in parts]
    return "\n\n".join(texts) + "\n"


def _head(result: Result) -> str:
    known = result.registered
    counted = [f"{done} of {planned} planned on {layout}" for layout, (done, planned) in result.blocks.items()]
    changed = ", ".join(f"`{file}`" for file in result.changed)
    return _HEAD.format(
        plan=f"`{known.plan[:16]}`",
        recipe=f"`{known.recipe[:16]}`",
        code=f"`{known.code_sha256[:16]}`",
        play=f"`{result.play[:16]}`",
        pool=f"`{result.pool[:16]}`",
        code_note=f"Changed since: {changed}." if changed else "The code is what was registered.",
        blocks=", ".join(counted),
    )


def _answer(result: Result) -> str:
    lines = [f"- **{test.measure} ({test.layout}): {test.wording}**" for test in result.primary]
    return _PRIMARY.format(verdicts="\n".join(lines), smallest=SMALLEST)


def _tests(tests: Sequence[Test], level: bool = False) -> Table:
    """Lays out comparisons; with their level where it differs."""
    heads = ["layout", "measure", "comparison", "blocks", "means", "difference", "p", "adjusted"]
    rows = []
    for test in tests:
        found = test.found
        text = Estimate(found.value, found.low, found.high).text(3)
        rows.append(
            [
                test.layout,
                test.measure,
                f"{test.first} - {test.second}",
                f"{found.blocks}",
                " / ".join(f"{mean:.3f}" for mean in test.means),
                f"{text} ({100 * found.level:g} %)" if level else text,
                p_text(found.p),
                p_text(found.adjusted),
            ]
        )
    return Table([Column(head, left=index < 3) for index, head in enumerate(heads)], rows)


def _arms(arms: Sequence[ArmMeans]) -> Table:
    strata = list(dict.fromkeys(stratum for one in arms for stratum in one.n))
    heads = [
        "layout",
        "arm",
        "blocks",
        "failed",
        "home",
        "away",
        *strata,
        "H50 home",
        "H50 away",
        "self-play",
        "M steps",
    ]
    rows = [
        [
            one.layout,
            one.arm,
            f"{one.blocks}",
            f"{one.failed}",
            *(f"{one.measures[side]:.3f}" for side in ("home", "away")),
            *(f"{one.n[stratum]:.3f}" if stratum in one.n else "-" for stratum in strata),
            *(f"{100 * one.measures[side]:.0f} %" for side in ("h50 home", "h50 away")),
            f"{one.self_play:.0f}",
            f"{one.steps / 1e6:.1f}" if one.seconds is not None else "-",
        ]
        for one in arms
    ]
    return Table([Column(head, left=index < 2) for index, head in enumerate(heads)], rows)


def _view(view: View) -> Table:
    heads = ["line", "rows", *(f"{100 * share:.0f} %" for share in view.rule.positions), "average"]
    rows = [
        [label(one), f"{one.rows}", *(f"{value:.3f}" for value in one.values), f"{one.average:.3f}"]
        for one in view.figure.lines
    ]
    return Table(heads, rows)


def _other(other: Other) -> list[str | Table]:
    said = "\n".join(f"- {test.measure}: {test.wording}" for test in other.primary)
    return [f"Pool `{other.pool[:16]}`, played `{other.play[:16]}`:", said, _tests(other.primary, level=True)]


def _hours(result: Result) -> str:
    spent = ", ".join(f"{part} {hours:.1f}" for part, hours in result.hours.items())
    seconds = "; ".join(
        f"{layout}: "
        + ", ".join(f"{a.arm} {a.seconds:.0f}" for a in result.arms if a.layout == layout and a.seconds is not None)
        for layout in result.blocks
    )
    return (
        f"Core-hours of training and scoring: {spent}. CPU seconds of training per arm, beyond the arms before it "
        f"(`pp` trains three of the five self-play agents): {seconds}."
    )


def _wrapped(text: str) -> str:
    """Breaks the lines of paragraphs and list items; headings and pictures keep to themselves."""

    def fill(item: str) -> str:
        return textwrap.fill(item, 120, subsequent_indent="  " * item.startswith("- "), break_on_hyphens=False)

    blocks = text.split("\n\n")
    return "\n\n".join(
        "\n".join(map(fill, block.split("\n"))) if block.startswith("- ") else fill(block) for block in blocks
    )

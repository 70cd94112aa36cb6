"""The page of the entries, and the table for the README; both from the records alone."""

import textwrap
from collections.abc import Iterator
from typing import Final

from overcooked_bench.evaluation.estimators import FEWEST_RUNS
from overcooked_bench.evaluation.shown.tables import NONE
from overcooked_bench.rendering.table import Cell, Column, Table

from .augmented import AUGMENTED, PLAIN, claims, claims_table, readings
from .records import EntryRecord, Standings
from .separated import Pair, fewest_seeds, letters, pairs
from .tables import (
    costs_table,
    cross_play_table,
    heading,
    headline_table,
    layouts_table,
    number,
    pairs_table,
    seeds_range_table,
    share,
    strata_of,
    strata_table,
    thesis_table,
)

COMMAND: Final = "python -m overcooked_bench.baselines.v1_entries"
WIDTH: Final = 120


def written(found: Standings) -> str:
    """Writes the page up to what is written by hand."""
    return "\n\n".join(_parts(found)) + "\n"


def _parts(found: Standings) -> Iterator[str]:
    compared = pairs(found.entries)
    thesis, strangers = found.thesis
    yield f"# Entries scored with {found.protocol.name}"
    yield _text(
        f"`{COMMAND}` plays what has not been played, from the weights in `baselines/entries`, and writes this page "
        f"and the JSON file beside it, which has every number. Protocol {found.protocol.name} "
        f"({found.protocol.sha256[:8]}), pool {found.pool.name} ({found.pool.sha256[:8]}); "
        "[docs/scoring.md](../../docs/scoring.md) says what the numbers mean."
    )
    yield headline_table(found, compared).markdown()
    yield _text(
        f"Intervals are 95 %: over training seeds, and for `{found.reference}`, a single agent, over partners and "
        f"start states. Entries that share a letter are not separated by the data; with fewer than {FEWEST_RUNS} seeds "
        "an entry is in no group, and neither is an agent. Points, the return with itself, the return with "
        f"the partners of `{found.criterion}` and the scenarios rank nothing."
    )
    yield from _separation(compared)
    yield "## Who the partners are"
    yield strata_table(found).markdown()
    yield _text(
        "A quarter of N is from each origin of partners. An entry is at home with partners of the code that trained it "
        "and of the people that it was trained with."
    )
    yield "## Layouts"
    yield layouts_table(found, "N", lambda one: number(one.n, 2)).markdown()
    yield layouts_table(found, "H50", lambda one: share(one.h50)).markdown()
    yield layouts_table(found, "points with itself", lambda one: number(one.self_play, 1)).markdown()
    yield seeds_range_table(found).markdown()
    yield _text(
        "Every training run counts, those that failed too. No interval sees a failure that is not among its seeds."
    )
    yield f"## Under the protocol `{thesis.name}`"
    yield thesis_table(found).markdown()
    yield _text(
        f"Entrants with the self-play agents of {strangers.name}, each agent's partners in ascending order: the "
        f"{found.quantile:g} quantile over agents at a share of the partners, as a part of what the best pair of "
        "self-play agents reaches, mean of the protocol's layouts; the average by layout is on the right. With fewer "
        "than 19 rows the quantile is descriptive, and fewer rows make it higher. An entry that was trained with all "
        "of these partners has no line."
    )
    yield "## Training seeds with one another"
    yield cross_play_table(found).markdown()
    yield _text(
        "Points per episode of each run with a copy of itself, and of every two runs of the entry; in brackets the "
        "second by the first. A ratio has an interval from ten runs on."
    )
    if rows := claims(found):
        yield f"### {AUGMENTED} beside {PLAIN}"
        yield claims_table(rows).markdown()
        yield "\n".join(_item(sentence) for sentence in readings(rows))
    yield "## What the training cost"
    yield costs_table(found).markdown()
    yield _text(
        "Core-hours are the wall-clock of training processes on one core each. Joint steps are those of all runs of "
        "the entry, of partners that were trained for it, too; partner runs count these partners."
    )


def _separation(compared: list[Pair]) -> Iterator[str]:
    if not compared:
        return
    yield pairs_table(compared).markdown()
    yield _text(
        "Permutation tests over training seeds, of which both have equal numbers: the first ones of an entry that has "
        f"more. Holm: p adjusted for {len(compared)} pairs; separated are those of .05 or less. With so many pairs the "
        f"surest one needs {fewest_seeds(len(compared))} seeds of each to be separated, however far apart they are."
    )


def readme_table(found: Standings) -> Table:
    """Lays out the compact table: a row per entry, the reference agent below."""
    groups, strata = letters(found.entries, pairs(found.entries)), strata_of(found)

    def cells(one: EntryRecord) -> list[Cell]:
        by_origin = (f"{one.strata[name].value:.2f}" if name in one.strata else NONE for name in strata)
        h50 = f"{100 * one.h50.value:.0f} %" if one.h50 else NONE
        marks = [groups.get(one.name, NONE)] * bool(groups)
        return [f"`{one.name}`", str(one.training_seeds), number(one.n, 2), *marks, h50, *by_origin]

    heads: list[str | Column] = ["entry", "seeds", "N [95 %]", *[Column("group", left=True)] * bool(groups), "H50"]
    rows, last = (
        [one for one in found.entries if (one.name == found.reference) is is_last] for is_last in (False, True)
    )
    return Table(
        [*heads, *(heading(name) for name in strata)],
        [cells(one) for one in rows],
        [cells(one) for one in last],
    )


def _text(sentences: str) -> str:
    return textwrap.fill(sentences, WIDTH, break_long_words=False, break_on_hyphens=False)


def _item(sentence: str) -> str:
    return textwrap.fill(f"- {sentence}", WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)

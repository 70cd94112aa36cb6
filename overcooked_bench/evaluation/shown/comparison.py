"""A comparison of two scores as a table."""

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.compare import Comparison, Difference
from overcooked_bench.evaluation.scores import ABOUT
from overcooked_bench.evaluation.shown.tables import figure
from overcooked_bench.rendering.table import Cell, Column, Table


def comparison_table(found: Comparison) -> Table:
    """Lays out one row per layout, and the mean over all layouts below."""
    heads = ["layout", found.first.name, found.second.name, "difference [95 %]"]
    if many := any(one.params for one in found.differences):
        heads.insert(1, "of")
    facts = found.metric

    def cells(one: Difference) -> list[Cell]:
        of = [facts.heading(one.params)] if many else []
        pair = (figure(Estimate(value), facts) for value in (one.first, one.second))
        return [one.layout or "mean of layouts", *of, *pair, figure(one.difference, facts, interval=True)]

    parts = [name for name in ABOUT if name != "layout"]
    chosen = [one for one in found.differences if all(getattr(one, name) is None for name in parts)]
    return Table(
        [heads[0], *(Column(head, wrap=False) for head in heads[1:])],
        [cells(one) for one in chosen if one.layout],
        [cells(one) for one in chosen if not one.layout],
    )

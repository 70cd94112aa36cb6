"""The difference of one number of two scores, with its interval and its test: of two methods, or of two agents."""

from collections.abc import Iterator, Sequence
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.cells import PartnerLabel
from overcooked_bench.evaluation.comparing.permutation import improvement, over_seeds, over_units
from overcooked_bench.evaluation.estimators import Figure, Group, over_partners, over_repetitions
from overcooked_bench.evaluation.metric import Metric
from overcooked_bench.evaluation.pools.normalised import partner_shares
from overcooked_bench.evaluation.scores import ABOUT, Row, Scores

_UNTESTED: Final = ("seat", "side", "partner")
"""Numbers that are about one of these are too many to be tested one by one."""


class Difference(msgspec.Struct, frozen=True, omit_defaults=True):
    """One number of the first score, the same of the second, and their difference.

    Attributes:
        first: The number in the first score.
        second: The number in the second score.
        difference: First minus second.
        better: Probability that a training seed of the first beats one of the second, ties counting half; for two
            agents the share of partners with whom the first one reaches more. None if it was not tested.
        p: Two-sided p of the permutation test; None if it was not tested.
        adjusted: The same by Holm over all pairs of scores that are compared; None for two scores.
        layout: As for `Row`.
        seat: As for `Row`.
        side: As for `Row`.
        stratum: As for `Row`.
        partner: As for `Row`.
        params: As for `Row`.
    """

    first: float
    second: float
    difference: Estimate
    better: float | None = None
    p: float | None = None
    adjusted: float | None = None
    layout: str | None = None
    seat: int | None = None
    side: int | None = None
    stratum: str | None = None
    partner: str | None = None
    params: dict[str, float] = {}


def differences(first: Scores, second: Scores, name: str, metric: Metric | None) -> Iterator[Difference]:
    """Yields the differences of every number of a metric that both scores have.

    Numbers at home and away are left out: agents of different origin are at home with different partners.

    Args:
        first: A score.
        second: Another one, with as many training seeds.
        name: Of the metric.
        metric: How it is computed; None if this version does not know it, and partners then cannot be paired.
    """
    theirs = {row.about: row for row in second.select(name, home=None)}
    pairs = [(mine, theirs[mine.about]) for mine in first.select(name, home=None) if mine.about in theirs]
    partners = {row.about: (row.value, theirs[row.about].value) for row, _ in pairs if row.partner is not None}
    alone = max((sum(label.counts for label in facts.partners) for facts in first.layouts), default=1) == 1
    most = np.inf if metric is None else metric.highest - metric.lowest
    for mine, other in pairs:
        if first.training_seeds > 1:
            found = _of_methods(mine, other, first.training_seeds, most)
        else:
            groups = _groups(first, mine, partners, metric) if metric else None
            found = _of_agents(mine, other, groups, metric is not None and metric.counts, most, alone)
        where: dict[str, Any] = {key: getattr(mine, key) for key in (*ABOUT, "params") if key != "home"}
        yield Difference(mine.value, other.value, *found, **where)


_Found = tuple[Estimate, float | None, float | None]
"""The difference, and if it was tested the probability of improvement and p."""


def _of_methods(mine: Row, other: Row, seeds: int, most: float) -> _Found:
    """Compares two methods over their training seeds; the difference is `most` at most.

    The interval is Welch's, from the standard errors of both scores, so that what repairs these repairs it, too.
    """
    runs = mine.per_repetition or (), other.per_repetition or ()
    if len(runs[0]) != seeds or len(runs[1]) != seeds or None in (mine.low, other.low):  # copies of a run
        return Estimate(mine.value - other.value), None, None
    variances = [_variance(row) for row in (mine, other)]
    total, squares = sum(variances), sum(variance**2 for variance in variances)
    freedom = total**2 / squares * (seeds - 1) if squares else 2 * (seeds - 1)
    found = Figure(mine.value - other.value, total**0.5, freedom).estimate(-most, most)
    if any(getattr(mine, name) is not None for name in _UNTESTED):
        return found, None, None
    return found, improvement(*runs), over_seeds(*runs)


def _variance(row: Row) -> float:
    """Returns the variance of a method's number; scores before schema 3 do not hold its error."""
    error = over_repetitions(row.per_repetition or ()).error if row.error is None else row.error
    return (error or 0.0) ** 2


def _of_agents(mine: Row, other: Row, groups: Sequence[Group] | None, counts: bool, most: float, alone: bool) -> _Found:
    """Compares two agents over the partners that both met; over start states if there is one, or no mean over them.

    By seat or side, some means over partners are not known for each partner; then there is no interval.
    """
    runs = mine.per_repetition or (), other.per_repetition or ()
    if groups is not None and all(len(group.values) > 1 for group in groups):
        least = sum(map(_one_more, groups)) if counts else 0.0
        found = over_partners(groups, least).estimate(-most, most)
        parts: NDArray[Any] = np.concatenate([group.shares * group.values for group in groups])
        shares: NDArray[Any] = np.concatenate([group.shares for group in groups])
    elif mine.partner is None and (alone or {mine.seat, mine.side} == {None}) and len(runs[0]) == len(runs[1]) > 1:
        parts = np.subtract(*runs)
        shares, found = np.full(len(parts), 1 / len(parts)), t_interval(parts, -most, most)
    else:
        return Estimate(mine.value - other.value), None, None
    if any(getattr(mine, name) is not None for name in _UNTESTED):
        return found, None, None
    return found, float(shares @ ((parts > 0) + 0.5 * (parts == 0))), over_units(parts)


def _one_more(group: Group) -> float:
    """Returns the variance of a difference of counts if one partner more were reached by only one of the two agents.

    Where both reach the same partners the differences have no spread, although the next partner need not agree.

    Source: Agresti and Min 2005, "Simple improved confidence intervals for comparing matched proportions".
    """
    return float((group.shares**2).sum()) / len(group.values)


_Partners = dict[tuple[Any, ...], tuple[float, float]]
"""What a row is about -> the numbers of both agents with that partner."""


def _groups(scores: Scores, row: Row, partners: _Partners, metric: Metric) -> list[Group] | None:
    """Returns what each partner adds to a row's difference, layout by layout; None if the scores do not hold it."""
    if row.partner is not None:
        return None
    chosen = [facts for facts in scores.layouts if row.layout in (None, facts.layout)]
    groups = []
    for facts in chosen:
        labels = [one for one in facts.partners if one.counts and row.stratum in (None, one.stratum)]
        found = [partners.get(_about(row, facts.layout, one)) for one in labels]
        known = [values for values in found if values is not None]
        if not known or len(known) < len(labels):
            return None
        shares = partner_shares(labels) if metric.weighted else np.full(len(labels), 1 / len(labels))
        values = np.array([mine - other for mine, other in known])
        groups.append(Group(values, shares / len(chosen), [one.stratum for one in labels]))
    return groups


def _about(row: Row, layout: str, label: PartnerLabel) -> tuple[Any, ...]:
    """Returns what the row of a partner is about that belongs to this row."""
    return msgspec.structs.replace(row, layout=layout, partner=label.name, stratum=None).about

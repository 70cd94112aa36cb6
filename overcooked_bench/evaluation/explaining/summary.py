"""Sums moments up: shares of reasons and mean soups, with intervals."""

from collections.abc import Sequence

from overcooked_bench.evaluation.explaining.reasons import FAILURES, PAIRINGS, REASONS
from overcooked_bench.evaluation.explaining.records import AxisShares, Moment, Shares
from overcooked_bench.evaluation.explaining.shares import mean_interval, share_interval

Placed = tuple[str, Moment]
"""A layout and a moment there."""


def sum_up(moments: Sequence[Placed]) -> Shares:
    """Computes the shares of some moments, of any layouts.

    What moments have in common is their partner and their training seed. Partners of different layouts are different
    agents; a training seed is one unit on all layouts, as in scores.
    """
    counted = [(layout, moment) for layout, moment in moments if moment.reason != "nothing"]
    partners = [(layout, moment.partner) for layout, moment in counted]
    seeds = [moment.training_seed for _, moment in counted]
    if not counted:
        return Shares(moments=0, nothing=len(moments), fails=None, reasons={}, soups={})
    return Shares(
        moments=len(counted),
        nothing=len(moments) - len(counted),
        fails=share_interval([moment.reason in FAILURES for _, moment in counted], partners, seeds),
        reasons={
            reason: share_interval([moment.reason == reason for _, moment in counted], partners, seeds)
            for reason in REASONS
            if reason != "nothing"
        },
        soups={
            pairing: mean_interval([moment.soups.mean(pairing) for _, moment in counted], partners, seeds)
            for pairing in PAIRINGS
        },
    )


def by_axis(layout: str, axes: Sequence[str], moments: Sequence[Moment]) -> tuple[AxisShares, ...]:
    """Computes the shares where conventions differ and where they agree, for each axis of a layout that says so."""
    found = []
    for axis in axes:
        for differ in (True, False):
            some = [(layout, one) for one in moments if axis in (one.differ if differ else one.agree)]
            if some:
                found.append(AxisShares(axis=axis, differ=differ, shares=sum_up(some)))
    return tuple(found)

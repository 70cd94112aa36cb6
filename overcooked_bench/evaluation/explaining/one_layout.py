"""Explains one layout: plays on from its moments, and says what came of it."""

from typing import NamedTuple

from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.evaluation.explaining.casting import Played, Task, play_pairings
from overcooked_bench.evaluation.explaining.conventions import Habits, habits
from overcooked_bench.evaluation.explaining.reasons import reason_for
from overcooked_bench.evaluation.explaining.records import LayoutExplanation, Moment
from overcooked_bench.evaluation.explaining.summary import by_axis, sum_up
from overcooked_bench.evaluation.explaining.worst import worst_moments
from overcooked_bench.evaluation.games.roster import pool_as_hashed, roster
from overcooked_bench.evaluation.pools.axes import AXES
from overcooked_bench.evaluation.pools.conventions import read_convention, write_convention


class Found(NamedTuple):
    """What came of a layout.

    Attributes:
        explanation: The record.
        scenarios: File name -> content of the scenario of each of the worst moments.
    """

    explanation: LayoutExplanation
    scenarios: dict[str, str]


def explain_layout(task: Task) -> Found:
    """Explains a layout; the result depends on the task alone.

    Raises:
        WrongUse: As `play_pairings`.
        SeatedFault: The agent broke the contract.
    """
    played, axes = play_pairings(task), [axis.name for axis in AXES.get(task.layout, ())]
    entries = {one.name: one.entry for one in roster(pool_as_hashed(task.pool, task.pool_sha256), task.layout)}
    conventions = habits(played, {name: read_convention(entry.convention) for name, entry in entries.items()})
    moments = _moments(played, conventions, entries)
    kept = list(worst_moments(played, moments, conventions))
    own = {moment.training_seed: habit.agent for moment, habit in zip(moments, conventions, strict=True)}
    explanation = LayoutExplanation(
        layout=task.layout,
        shares=sum_up([(task.layout, moment) for moment in moments]),
        axes=by_axis(task.layout, axes, moments),
        conventions={str(seed): write_convention(own[seed]) for seed in sorted(own)} if axes else {},
        moments=tuple(moments),
        worst=tuple(worst for worst, _ in kept),
    )
    return Found(explanation, {worst.scenario: text for worst, text in kept if worst.scenario and text})


def _moments(played: Played, conventions: list[Habits], entries: dict[str, Entry]) -> list[Moment]:
    found = []
    for index, ((episode, step), habit) in enumerate(zip(played.task.moments, conventions, strict=True)):
        soups = played.soups(index)
        found.append(
            Moment(
                training_seed=episode.training_seed,
                episode=episode.episode,
                partner=episode.partner,
                stratum=entries[episode.partner].stratum,
                seat=episode.seat,
                step=step,
                soups=soups,
                reason=reason_for(soups),
                differ=habit.on("differ"),
                agree=habit.on("agree"),
            )
        )
    return found

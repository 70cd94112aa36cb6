"""Compares two scores of the same protocol: the difference of every number of a metric, with its interval."""

from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import Estimate, t_interval, welch_interval
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import ABOUT, MEAN, Row, Scores, Source, read_scores

_PAIRED: Final = (
    "95 % t intervals over {n} episode blocks that both agents played with the same partners, start states and random "
    "streams: the difference is computed block by block. They say nothing about retraining."
)
_WELCH: Final = (
    "95 % Welch intervals over {n} and {m} training seeds, for this pool of partners and given these start states and "
    "random streams, which both agents share."
)
_NONE: Final = "No intervals: {why}."


class CompareError(WrongUse):
    """Two scores cannot be compared; the message says why."""


class Difference(msgspec.Struct, frozen=True, omit_defaults=True):
    """One number of the first score, the same of the second, and their difference.

    Attributes:
        first: The number in the first score.
        second: The number in the second score.
        difference: First minus second.
        layout: As for `Row`.
        seat: As for `Row`.
        side: As for `Row`.
        stratum: As for `Row`.
        home: As for `Row`.
        partner: As for `Row`.
        params: As for `Row`.
    """

    first: float
    second: float
    difference: Estimate
    layout: str | None = None
    seat: int | None = None
    side: int | None = None
    stratum: str | None = None
    home: bool | None = None
    partner: str | None = None
    params: dict[str, float] = {}


class Comparison(msgspec.Struct, frozen=True):
    """The result of `compare`.

    Attributes:
        metric: How to show the numbers.
        first: The first agent.
        second: The second one.
        interval: What the intervals cover.
        differences: One for each number that both scores have; the mean over all layouts first.
    """

    metric: MetricFacts
    first: Source
    second: Source
    interval: str
    differences: tuple[Difference, ...]


def compare(first: Scores | str | Path, second: Scores | str | Path, metric: str = MEAN) -> Comparison:
    """Compares two scores.

    Two agents with one training run each are compared episode block by episode block: both met the same partners from
    the same start states. Training runs of two agents have nothing in common, so several of them are compared by
    Welch's interval.

    Args:
        first: A score, its folder, or its score.json.
        second: Another one.
        metric: Name of a metric that both have.

    Raises:
        CompareError: They played different games, or do not have this metric.
        ScoresError: A score.json cannot be read.

    Example:
        ```python
        from overcooked_bench import compare, score

        mine = score("my_agent.py").scores
        print(compare(mine, "scores/greedy-dev", "tail_mean").differences[0].difference)
        ```
    """
    pair = [given if isinstance(given, Scores) else read_scores(given) for given in (first, second)]
    one, other = pair
    _check_same_games(one, other)
    known = [{facts.name: facts for facts in scores.metrics} for scores in pair]
    if metric not in known[0] or metric not in known[1]:
        both = ", ".join(name for name in known[0] if name in known[1])
        raise CompareError(f"no metric {metric!r} in both scores; they have {both}")
    theirs = {row.about: row for row in other.select(metric)}
    found = [(row, theirs[row.about]) for row in one.select(metric) if row.about in theirs]
    return Comparison(
        metric=known[0][metric],
        first=one.agent,
        second=other.agent,
        interval=_describe(one, other, found),
        differences=tuple(
            _difference(mine, theirs, one.training_seeds, other.training_seeds) for mine, theirs in found
        ),
    )


def _check_same_games(one: Scores, other: Scores) -> None:
    for what, mine, theirs in (
        ("protocol", one.protocol.sha256, other.protocol.sha256),
        ("pool", one.pool and one.pool.sha256, other.pool and other.pool.sha256),
        ("seed", one.seed, other.seed),
        ("salt", one.salt, other.salt),
    ):
        if mine != theirs:
            short = [str(value)[:12] for value in (mine, theirs)]
            raise CompareError(
                f"{one.agent.name} and {other.agent.name} were scored with a different {what} "
                f"({short[0]} and {short[1]}); score both under the same protocol, pool, seed and salt"
            )


def _difference(mine: Row, theirs: Row, seeds: int, other_seeds: int) -> Difference:
    values = mine.per_repetition or (), theirs.per_repetition or ()
    if seeds > 1 and other_seeds > 1 and all(values):
        difference = welch_interval(*values)
    elif seeds == other_seeds == 1 and len(values[0]) == len(values[1]) > 1:
        difference = t_interval(np.subtract(*values))
    else:
        difference = Estimate(mine.value - theirs.value)
    where = {key: getattr(mine, key) for key in (*ABOUT, "params")}
    return Difference(mine.value, theirs.value, difference, **where)


def _describe(one: Scores, other: Scores, rows: list[tuple[Row, Row]]) -> str:
    seeds = one.training_seeds, other.training_seeds
    if not any(mine.per_repetition and theirs.per_repetition for mine, theirs in rows):
        return _NONE.format(why="one of the scores was written by a version that stored no values per repetition")
    if min(seeds) > 1:
        return _WELCH.format(n=seeds[0], m=seeds[1])
    if max(seeds) > 1:
        return _NONE.format(why="one agent has several training seeds and the other a single one")
    longest = max(len(mine.per_repetition or ()) for mine, _ in rows)
    return _PAIRED.format(n=longest) if longest > 1 else _NONE.format(why="a single number per agent")

"""Compares scores of the same games: the difference of every number of a metric, with its interval and a test.

What is compared is like with like: methods by five training runs or so each, of which there are equal numbers, or
agents, one artefact each. All met the same partners from the same start states, so what these are worth cancels.
"""

from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.comparing.differences import Difference, differences
from overcooked_bench.evaluation.comparing.permutation import holm, smallest_p
from overcooked_bench.evaluation.comparing.seeing import Sight, sights
from overcooked_bench.evaluation.metric import MetricFacts, find_metrics
from overcooked_bench.evaluation.scores import EPISODES_FILE, MEAN, SCORES_FILE, Scores, Source, read_scores
from overcooked_bench.evaluation.summary import recompute

_SEEDS: Final = (
    "Differences: first minus second, with 95 % t intervals over {n} training seeds of each (Welch), for this pool of "
    "partners and given these start states and random streams, which all of them share."
)
_PARTNERS: Final = (
    "Differences: first minus second, with 95 % t intervals over the partners of each stratum and their start states, "
    "which both agents met; with a single partner, and of numbers that are no mean over partners, over start states. "
    "They are of one artefact each, and say nothing about retraining."
)
_TEST_OF_SEEDS: Final = (
    "Better: probability that a training seed of the first beats one of the second. p: permutation test over training "
    "seeds; with {n} of each it is at least {least:.2g}."
)
_TEST_OF_PARTNERS: Final = (
    "Better: share of the partners with whom the first reaches more. p: permutation test, signs flipped by partner."
)
_HOLM: Final = " Holm: p adjusted for {pairs} pairs."
_TOO_FEW: Final = " No difference can have p of .05 or less then; that takes {needed} training seeds of each."
_TOO_MANY: Final = " No difference can have p of .05 or less then; compare fewer scores at a time."


class CompareError(WrongUse):
    """Scores cannot be compared; the message says why."""


class Entrant(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A score that is compared.

    Attributes:
        name: The agent's name, with a part of its hash where two have the same.
        sha256: The agent's hash.
        training_seeds: Training runs.
        computed_again: Whether it was reported differently and computed again from its episodes.
    """

    name: str
    sha256: str
    training_seeds: int
    computed_again: bool = False


class Pair(msgspec.Struct, frozen=True):
    """Two entrants, and how they differ in one metric.

    Attributes:
        first: Index of the first one.
        second: Index of the second one.
        differences: One for each number that both scores have; the mean over all layouts first.
    """

    first: int
    second: int
    differences: tuple[Difference, ...]


class Compared(msgspec.Struct, frozen=True):
    """One metric.

    Attributes:
        metric: How to show the numbers.
        pairs: Every pair of entrants.
        sights: What the training seeds let one see, over all layouts first; none for agents.
    """

    metric: MetricFacts
    pairs: tuple[Pair, ...]
    sights: tuple[Sight, ...]


class Comparison(msgspec.Struct, frozen=True):
    """The result of `compare`.

    Attributes:
        protocol: What all of them played.
        pool: And with whom; None for protocols that named scripted partners alone.
        kind: Whether methods are compared, or agents of one artefact each.
        entrants: What is compared, in the order given.
        interval: What the intervals cover.
        test: What the test is; None if nothing was tested.
        metrics: The protocol's headlines, or the one that was asked for.
    """

    protocol: Source
    pool: Source | None
    kind: Literal["methods", "agents"]
    entrants: tuple[Entrant, ...]
    interval: str
    test: str | None
    metrics: tuple[Compared, ...]


def compare(*scores: Scores | str | Path, metric: str | None = None) -> Comparison:
    """Compares two scores or more, each with each.

    Methods are compared over training seeds, of which all have equal numbers: with unequal ones the permutation test
    loses its level, and what only large samples show, such as a failing run, is more often seen on one side. Agents,
    one artefact each, are compared over partners and start states. A method is never compared with an agent: the one
    varies with training, the other is a single draw of it.

    Args:
        *scores: Scores, their folders, or their score.json. One whose protocol reports the same games in another way
            than the first one's is computed again from its episodes.
        metric: Name of a metric that all have; by default the headlines of the protocol.

    Raises:
        CompareError: They played different games, are of different kinds or sizes, or do not have this metric.
        ScoresError: A score.json cannot be read.
        StoreError: A score has to be computed again, and its episodes are not there.

    Example:
        ```python
        from overcooked_bench import compare, score

        mine = score("my_agent.py").scores
        found = compare(mine, "scores/greedy-v1", metric="mean")
        print(found.metrics[0].pairs[0].differences[0].difference)
        ```
    """
    if len(scores) < 2:
        raise CompareError(f"{len(scores)} score given; give two at least, such as scores/mine-v1 scores/theirs-v1")
    read = [given if isinstance(given, Scores) else read_scores(given) for given in scores]
    names = _names(read)
    for (one, mine), (other, theirs) in pairwise(zip(names, read, strict=True)):
        check_same_games(one, mine, other, theirs)
    _check_same_kind(names, read)
    alike = [_as_reported(read[0], one, given) for one, given in zip(read, scores, strict=True)]
    chosen = _metrics(alike, names, metric)
    known = {one.facts.name: one for one in find_metrics()}
    pairs = list(combinations(range(len(alike)), 2))
    compared = []
    for facts in chosen:
        found = [list(differences(alike[i], alike[j], facts.name, known.get(facts.name))) for i, j in pairs]
        seen = sights(alike, facts) if alike[0].training_seeds > 1 else ()
        told = zip(pairs, _adjusted(found), strict=True)
        compared.append(Compared(facts, tuple(Pair(i, j, tuple(some)) for (i, j), some in told), tuple(seen)))
    return Comparison(
        protocol=read[0].protocol,
        pool=read[0].pool,
        kind="agents" if read[0].training_seeds == 1 else "methods",
        entrants=tuple(
            Entrant(
                name=name, sha256=one.agent.sha256, training_seeds=one.training_seeds, computed_again=again is not one
            )
            for name, one, again in zip(names, read, alike, strict=True)
        ),
        interval=_interval(alike, compared),
        test=_test(read[0].training_seeds, compared),
        metrics=tuple(compared),
    )


def _names(scores: Sequence[Scores]) -> list[str]:
    """Returns the agents' names, with a part of the hash where two have the same."""
    names = [one.agent.name for one in scores]
    return [
        f"{name} ({one.agent.sha256[:8]})" if names.count(name) > 1 else name
        for name, one in zip(names, scores, strict=True)
    ]


def check_same_games(one: str, mine: Scores, other: str, theirs: Scores) -> None:
    """Checks that two scores, which are called `one` and `other`, are of the same games.

    Raises:
        CompareError: Protocol, pool, seed or salt differ; says how.
    """
    for what, ours, their in (
        ("protocol", mine.protocol.sha256, theirs.protocol.sha256),
        ("protocol", mine.settings.sha256, theirs.settings.sha256),  # what it is, not what the file says that it is
        ("pool", mine.pool and mine.pool.sha256, theirs.pool and theirs.pool.sha256),
        ("seed", mine.seed, theirs.seed),
        ("salt", mine.salt, theirs.salt),
    ):
        if ours != their:
            short = [str(value)[:12] for value in (ours, their)]
            changed = f": {', '.join(_changed(mine, theirs))}" if what == "protocol" else ""
            raise CompareError(
                f"{one} and {other} were scored with a different {what} ({short[0]} and {short[1]}){changed}; score "
                "both under the same protocol, pool, seed and salt"
            )


def _changed(mine: Scores, theirs: Scores) -> Iterator[str]:
    """Yields the keys in which two protocols play differently."""
    ours, their = (msgspec.to_builtins(one.settings.play) for one in (mine, theirs))
    for key in {**ours, **their}:
        values = [str(one.get(key, "none"))[:60] for one in (ours, their)]
        if values[0] != values[1]:
            yield f"{key} {values[0]} and {values[1]}"


def _check_same_kind(names: Sequence[str], scores: Sequence[Scores]) -> None:
    """Checks that all are methods of as many training seeds, or all are agents."""
    seeds = [one.training_seeds for one in scores]
    if len(set(seeds)) == 1:
        return
    given = ", ".join(f"{name} {n}" for name, n in zip(names, seeds, strict=True))
    fewest, most = min(seeds), max(seeds)
    if fewest == 1:
        raise CompareError(
            f"training seeds: {given}. A method is not compared with an agent of one training run, which is a single "
            f"draw of its own method; score {most} runs of each (TRAINING_SEEDS = {most}), or one artefact of each"
        )
    raise CompareError(
        f"training seeds: {given}. Methods are compared by equal numbers of them; train more runs and score "
        f"TRAINING_SEEDS = {most} of each, or score all with TRAINING_SEEDS = {fewest}, chosen before looking"
    )


def _as_reported(first: Scores, one: Scores, given: Scores | str | Path) -> Scores:
    """Returns a score as the first one's protocol reports it."""
    report = first.settings.report
    if one.settings.report.sha256 == report.sha256:
        return one
    if isinstance(given, Scores):
        raise CompareError(
            f"{one.agent.name} was reported differently than {first.agent.name}; give its folder, so that it can be "
            f"computed again from {EPISODES_FILE}"
        )
    path = Path(given)
    again = recompute(path.parent if path.name == SCORES_FILE else path, report)
    check_same_games(first.agent.name, first, f"the store of {one.agent.name}", again)
    return msgspec.structs.replace(again, agent=one.agent)


def _metrics(scores: Sequence[Scores], names: Sequence[str], wanted: str | None) -> list[MetricFacts]:
    """Returns the metric that is wanted, or the protocol's headlines."""
    common = [facts for facts in scores[0].metrics if all(any(one.select(facts.name)) for one in scores)]
    known = {facts.name: facts for facts in common}
    headlines = [name for name in scores[0].settings.report.headlines or (MEAN,) if name in known]
    found = [wanted] if wanted is not None else headlines
    if not found or found[0] not in known:
        what = f"metric {wanted!r}" if wanted is not None else "headline"
        raise CompareError(f"no {what} in the scores of all of {', '.join(names)}; they have {', '.join(known)}")
    return [known[name] for name in found]


def _adjusted(found: Sequence[Sequence[Difference]]) -> list[list[Difference]]:
    """Adjusts the p of the same number of several pairs by Holm's method."""
    changed = [list(some) for some in found]
    if len(found) < 2:
        return changed
    places: dict[tuple[Any, ...], list[tuple[int, int]]] = {}
    for pair, some in enumerate(found):
        for index, one in enumerate(some):
            if one.p is not None:
                key = one.layout, one.stratum, tuple(sorted(one.params.items()))
                places.setdefault(key, []).append((pair, index))
    for at in places.values():
        for (pair, index), p in zip(at, holm([found[i][j].p or 0.0 for i, j in at]), strict=True):
            changed[pair][index] = msgspec.structs.replace(found[pair][index], adjusted=p)
    return changed


def _interval(scores: Sequence[Scores], compared: Sequence[Compared]) -> str:
    if not any(one.difference.interval for some in compared for pair in some.pairs for one in pair.differences):
        return (
            "No intervals: the scores hold no values per repetition of this metric, a single one, or those of training "
            "runs that are copies."
        )
    seeds = scores[0].training_seeds
    return _SEEDS.format(n=seeds) if seeds > 1 else _PARTNERS


def _test(seeds: int, compared: Sequence[Compared]) -> str | None:
    if all(one.p is None for some in compared for pair in some.pairs for one in pair.differences):
        return None
    pairs = len(compared[0].pairs)
    several = _HOLM.format(pairs=pairs) * (pairs > 1)
    if seeds == 1:
        return _TEST_OF_PARTNERS + several
    if smallest_p(seeds) * pairs > 0.05:
        needed = next((n for n in range(seeds, 100) if smallest_p(n) * pairs <= 0.05), None)
        several += _TOO_MANY if needed is None else _TOO_FEW.format(needed=needed)
    return _TEST_OF_SEEDS.format(n=seeds, least=smallest_p(seeds)) + several

"""Analyses the records as plan.md says."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from .analysis import difference, family, paired, verdict, wording
from .gathered import Whole, whole_blocks
from .means import H50, SIDES, arm_means
from .records import BlockRecord
from .registered import Registered, deviations
from .result import Other, Result, Test
from .study import MAIN, Study, StudyError
from .view import read_view

HOME_LAYOUT: Final = "forced_coordination"
"""The layout of the primary endpoints."""
PRIMARY: Final = ("l0", "sp-long")
SECONDARY: Final = (("l0", "nd"), ("nd", "pp"), ("pp", "sp-long"), ("sa", "sp-long"))
NULL: Final = ("sp", "sp-2")
BESIDE: Final = "sp-long"
"""What the arms that decide nothing are held against."""


def make_result(study: Study, home: Path, known: Registered, changed: Sequence[str], ended: bool = False) -> Result:
    """Analyses the study.

    Args:
        study: The recipe.
        home: The study's folder.
        known: What was registered.
        changed: Files of the code that have changed since.
        ended: Whether no further blocks will be run: those that are there are analysed.

    Raises:
        StudyError: Main blocks are missing and `ended` is not given, there are fewer than two on the layout of the
            primary comparisons, or a record is not as it should be.
    """
    planned, there = study.part(MAIN).blocks, whole_blocks(study, MAIN, home, known)
    for layout, records in there.items():
        if len(records) < planned[layout] and not ended:
            raise StudyError(
                f"{layout}: {len(records)} of {planned[layout]} blocks are there, and nothing is looked at before all "
                "are; run the rest, or give --ended if compute has ended"
            )
        if len(records) < 2 and layout == HOME_LAYOUT:
            raise StudyError(f"{layout}: {len(records)} blocks are there; two are the least that has an interval")
    main = {layout: records for layout, records in there.items() if len(records) > 1}
    parts = {name: whole_blocks(study, name, home, known) for name in study.parts}
    play = study.play_sha256
    _check_pool(study, main)
    return Result(
        registered=known,
        changed=tuple(changed),
        play=play,
        pool=study.pool_sha256,
        blocks={layout: (len(records), planned[layout]) for layout, records in there.items()},
        primary=tuple(_primary(main, play)),
        secondary=tuple(_secondary(main, play)),
        null=tuple(_test(main, layout, NULL, measure, play) for layout in main for measure in SIDES),
        rows=tuple(_rows(study, main, parts, play)),
        arms=tuple(arm_means(study, parts, play)),
        others=tuple(_others(main, play)),
        views=tuple(view for layout in main if (view := read_view(home, layout))),
        hours={name: _hours(some) for name, some in parts.items()},
        deviations=deviations(home),
    )


def _check_pool(study: Study, main: Whole) -> None:
    for records in main.values():
        for record in records:
            for one in record.arms:
                score = one.scores.get(study.play_sha256)
                if score is not None and score.pool != study.pool_sha256:
                    raise StudyError(
                        f"{record.name}: {one.arm} was scored with the pool {score.pool[:12]}, and "
                        f"{study.pool_sha256[:12]} is registered; score it with that"
                    )


def _values(records: Sequence[BlockRecord], arm: str, measure: str, play: str) -> list[float]:
    """Returns a measure of an arm in each block.

    Raises:
        StudyError: An agent has no such score.
    """
    try:
        return [record.by_arm[arm].value(measure, play) for record in records]
    except StudyError as error:
        raise StudyError(f"{records[0].part} on {records[0].layout}: {error}") from None


def _test(whole: Whole, layout: str, arms: tuple[str, str], measure: str, play: str) -> Test:
    first, second = (_values(whole[layout], arm, measure, play) for arm in arms)
    return Test(
        layout=layout,
        measure=measure,
        first=arms[0],
        second=arms[1],
        means=(float(np.mean(first)), float(np.mean(second))),
        found=difference(paired(first, second)),
    )


def _families(whole: Whole, wanted: Sequence[tuple[str, tuple[str, str], str]], play: str) -> list[Test]:
    """Compares arms as one family: (layout, arms, measure) each."""
    tests = [_test(whole, *one, play) for one in wanted]
    together = family(
        [paired(*(_values(whole[layout], arm, measure, play) for arm in arms)) for layout, arms, measure in wanted]
    )
    return [msgspec.structs.replace(test, found=found) for test, found in zip(tests, together, strict=True)]


def _primary(main: Whole, play: str) -> Iterator[Test]:
    for test in _families(main, [(HOME_LAYOUT, PRIMARY, side) for side in SIDES], play):
        yield msgspec.structs.replace(test, verdict=verdict(test.found), wording=wording(test.found))


def _secondary(main: Whole, play: str) -> list[Test]:
    """Compares in one family; intervals keep the level of one test, and p is adjusted."""
    wanted = [
        (layout, arms, side)
        for layout in main
        for arms in (PRIMARY, *SECONDARY)
        for side in SIDES
        if (layout, arms) != (HOME_LAYOUT, PRIMARY)
    ]
    wanted += [(layout, PRIMARY, measure) for layout in main for measure in H50]
    found = []
    for one, adjusted in zip(wanted, _families(main, wanted, play), strict=True):
        plain = _test(main, *one, play)
        p = msgspec.structs.replace(plain.found, adjusted=adjusted.found.adjusted)
        found.append(msgspec.structs.replace(plain, found=p))
    return found


def _rows(study: Study, main: Whole, parts: Mapping[str, Whole], play: str) -> Iterator[Test]:
    """Yields the arms of other parts of the main blocks, held against self-play of the same blocks."""
    for name, whole in parts.items():
        if name == MAIN or study.part(name).set != study.part(MAIN).set:
            continue
        for layout, records in whole.items():
            count = min(len(records), len(main.get(layout, [])))
            if count < 2:
                continue
            for arm in study.part(name).arms:
                for side in SIDES:
                    first = _values(records[:count], arm, side, play)
                    second = _values(main[layout][:count], BESIDE, side, play)
                    yield Test(
                        layout=layout,
                        measure=side,
                        first=arm,
                        second=BESIDE,
                        means=(float(np.mean(first)), float(np.mean(second))),
                        found=difference(paired(first, second)),
                    )


def _others(main: Whole, play: str) -> Iterator[Other]:
    """Yields the primary comparisons under other protocols that all blocks were scored under, too."""
    records = main[HOME_LAYOUT]
    for other in sorted(set.intersection(*(record.plays for record in records)) - {play}):
        pools = {one.scores[other].pool for record in records for one in record.arms if not one.failed}
        yield Other(play=other, pool=", ".join(sorted(pools)), primary=tuple(_primary(main, other)))


def _hours(whole: Whole) -> float:
    seconds = [
        record.scoring_seconds + sum(one.seconds for one in record.arms)
        for records in whole.values()
        for record in records
    ]
    return round(sum(seconds) / 3600, 2)

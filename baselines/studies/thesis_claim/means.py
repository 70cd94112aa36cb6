"""Means of every arm over blocks."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.scores import ScoresError, read_scores

from .gathered import Whole
from .records import OWN, ArmRecord
from .result import ArmMeans
from .study import MAIN, PILOT, Study

SIDES: Final = ("home", "away")
H50: Final = ("h50 home", "h50 away")
REFERENCE: Final = "greedy"


def arm_means(study: Study, parts: Mapping[str, Whole], play: str) -> Iterator[ArmMeans]:
    """Yields the means of all arms but the pilot's, and those of the reference agent, layout by layout.

    Args:
        study: The recipe.
        parts: By name, their records.
        play: Hash of what was played.
    """
    for layout in study.part(MAIN).blocks:
        for name, whole in parts.items():
            records = [record for record in whole.get(layout, []) if play in record.plays]
            if not records or name == PILOT:
                continue
            for arm in study.part(name).arms:
                yield _means(layout, arm, [record.by_arm[arm] for record in records], play)
        yield from _reference(layout, play)


def _means(layout: str, arm: str, found: Sequence[ArmRecord], play: str) -> ArmMeans:
    strata = next((list(one.scores[play].n) for one in found if not one.failed), [OWN])
    trained = [one for one in found if not one.failed]
    return ArmMeans(
        layout=layout,
        arm=arm,
        blocks=len(found),
        failed=len(found) - len(trained),
        n={
            stratum: float(np.mean([0.0 if one.failed else one.scores[play].n[stratum] for one in found]))
            for stratum in strata
        },
        measures={measure: float(np.mean([one.value(measure, play) for one in found])) for measure in (*SIDES, *H50)},
        self_play=float(np.mean([one.self_play for one in trained])) if trained else 0.0,
        steps=float(np.mean([one.steps for one in trained])) if trained else 0.0,
        seconds=float(np.mean([one.seconds for one in found])),
    )


def _reference(layout: str, play: str) -> Iterator[ArmMeans]:
    """Yields what the shipped score of `greedy` says, if it is of the same games."""
    for file in sorted(REFERENCES.glob("*.json")):
        try:
            scores = read_scores(file)
        except ScoresError:
            continue
        if (scores.protocol.sha256, scores.agent.name) != (play, REFERENCE):
            continue
        about = {"layout": layout, "seat": None, "side": None, "home": None, "partner": None}
        n, h50 = ({r.stratum: r.value for r in scores.select(m, **about) if r.stratum} for m in ("n", "h50"))
        away = [stratum for stratum in n if stratum != OWN]
        measures = {
            f"{prefix}{side}": float(np.mean([values[stratum] for stratum in chosen]))
            for prefix, values in (("", n), ("h50 ", h50))
            for side, chosen in (("home", [OWN]), ("away", away))
        }
        own = scores.find("self_play", layout=layout)
        yield ArmMeans(
            layout=layout,
            arm=REFERENCE,
            blocks=1,
            failed=0,
            n=n,
            measures=measures,
            self_play=own.value if own else 0.0,
            steps=0.0,
            seconds=None,
        )

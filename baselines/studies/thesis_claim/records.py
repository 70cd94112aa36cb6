"""What is kept of each block: a file per block, from which the report is made without weights or games."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from overcooked_bench.documents import read_json
from overcooked_bench.files import write_whole

from .study import Block, StudyError

RESULTS: Final = "results"
"""The folder of the records and of the report, in the study's own."""
OWN: Final = "own"
"""The stratum of partners that the code of this project trained: an agent of the study is at home with them."""
_MOST_BYTES: Final = 16_000_000


class Score(msgspec.Struct, frozen=True, kw_only=True):
    """What an agent reaches with a pool.

    Attributes:
        pool: Hash of the pool.
        n: Stratum -> N.
        h50: Stratum -> share of partners, by their weights, with whom N is 0.5 or more.
        partners: Partner -> N.
    """

    pool: str
    n: dict[str, float]
    h50: dict[str, float]
    partners: dict[str, float]


class ArmRecord(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One agent of a block.

    Attributes:
        arm: Its name in the recipe.
        seed: Training seed.
        weights: SHA-256 of its weights; "" if training failed.
        steps: Joint steps that this agent was trained for.
        total_steps: Joint steps of it and of all agents that it was made from.
        seconds: CPU seconds that its training took beyond that of the arms before it.
        self_play: Points per episode with itself.
        failed: Why it could not be trained to its end; "" if it could.
        scores: Hash of what was played -> its score.
    """

    arm: str
    seed: int
    weights: str = ""
    steps: int = 0
    total_steps: int = 0
    seconds: float = 0.0
    self_play: float = 0.0
    failed: str = ""
    scores: dict[str, Score] = {}

    def value(self, measure: str, play: str) -> float:
        """Returns a measure; 0 for an agent that could not be trained.

        Args:
            measure: "home", "away", "h50 home" or "h50 away": N, or H50. Away is the mean of all strata but the own
                one, each with the same weight.
            play: Hash of what was played.

        Raises:
            StudyError: It was not scored so.
        """
        if self.failed:
            return 0.0
        if play not in self.scores:
            raise StudyError(f"arm {self.arm} has no score under the protocol {play[:8]}; run the block again")
        score = self.scores[play]
        values = score.h50 if measure.startswith("h50") else score.n
        if measure.endswith("home"):
            return values[OWN]
        return float(np.mean([value for stratum, value in values.items() if stratum != OWN]))


class BlockRecord(msgspec.Struct, frozen=True, kw_only=True):
    """What became of one block.

    Attributes:
        part: Part of the study.
        layout: Where.
        index: Its number there.
        plan: Hash of the plan that it was trained under.
        recipe: Hash of the recipe.
        versions: What it was trained with.
        scoring_seconds: CPU seconds of scoring all agents.
        arms: Its agents.
    """

    part: str
    layout: str
    index: int
    plan: str
    recipe: str
    versions: dict[str, str]
    scoring_seconds: float
    arms: tuple[ArmRecord, ...]

    @property
    def name(self) -> str:
        """What messages call it."""
        return f"{self.part}-{self.layout}-{self.index:02}"

    @property
    def by_arm(self) -> Mapping[str, ArmRecord]:
        """Its agents by arm."""
        return {one.arm: one for one in self.arms}

    @property
    def plays(self) -> set[str]:
        """Hashes of what all agents that could be trained were scored under."""
        scored = [set(one.scores) for one in self.arms if not one.failed]
        return set.intersection(*scored) if scored else set()


def record_file(block: Block, home: Path) -> Path:
    """Returns where a block's record is."""
    return home / RESULTS / f"{block.name}.json"


def write_record(record: BlockRecord, file: Path) -> None:
    """Writes a record."""
    file.parent.mkdir(parents=True, exist_ok=True)
    write_whole(file, msgspec.json.format(msgspec.json.encode(record), indent=1) + b"\n")


def read_record(file: Path) -> BlockRecord:
    """Reads a record.

    Raises:
        StudyError: It is missing or damaged.
    """
    return read_json(file, _MOST_BYTES, BlockRecord, StudyError)


def joined(before: BlockRecord, now: BlockRecord) -> BlockRecord:
    """Returns a record with the scores of an earlier one, too.

    Raises:
        StudyError: The earlier one is of other agents.
    """
    known = before.by_arm
    arms = []
    for one in now.arms:
        old = known.get(one.arm, one)
        if (old.weights, bool(old.failed)) != (one.weights, bool(one.failed)):
            raise StudyError(
                f"{now.name}: the record has another {one.arm} ({old.weights[:8]}) than the runs ({one.weights[:8]}); "
                "give the --runs that the record was made from"
            )
        arms.append(msgspec.structs.replace(one, scores={**old.scores, **one.scores}))
    return msgspec.structs.replace(now, arms=tuple(arms))

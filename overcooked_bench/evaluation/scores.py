"""`Scores`: what score.json says."""

from pathlib import Path
from typing import Any, Final

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.protocol import Protocol, upgrade
from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.layout import DEFAULT_SOUP_REWARD

SCHEMA: Final = 1


class ScoresError(WrongUse):
    """A score.json cannot be read; the message names the file and the entry."""


class Cell(msgspec.Struct, frozen=True):
    """The scored agent with one partner on one layout.

    Attributes:
        partner: The partner's name.
        kind: "trained", "scripted" or "floor".
        sha256: Hash of what the partner is.
        mean: Points an episode, averaged over seats.
        seats: The same with the scored agent on each of the protocol's seats.
        ego_soups: Soups an episode that the scored agent delivered.
        partner_soups: Soups an episode that the partner delivered.
        is_ego: Whether the partner is the scored agent itself.
    """

    partner: str
    kind: str
    sha256: str
    mean: Estimate
    seats: tuple[Estimate, ...]
    ego_soups: float
    partner_soups: float
    is_ego: bool


class ThresholdScore(msgspec.Struct, frozen=True):
    """How many partners reach a number of soups.

    Attributes:
        soups: The level.
        reached: Partners with a mean of at least that, of `LayoutScore.partners`.
        share: The same as a share.
        undecided: Partners whose mean lies within two standard errors of the level; they count where their mean is.
            Null where no error is known: a single episode of a single training run.
    """

    soups: float
    reached: Estimate
    share: float
    undecided: int | None


class CurvePoint(msgspec.Struct, frozen=True):
    """One point of the ordered curve.

    Attributes:
        rank: 1 for the worst partner, whoever that is for each training seed.
        mean: Points an episode; the interval is pointwise, and there is none for a single training run.
        low_quantile: Type-7 0.15-quantile over training seeds; null for a single one.
    """

    rank: int
    mean: Estimate
    low_quantile: float | None


class LayoutScore(msgspec.Struct, frozen=True):
    """The scores on one layout.

    Attributes:
        layout: Its name.
        adapted: Whether the agent was given the mirror image, because it knows the layout only that way round.
        partners: Partners that count.
        mean: Points an episode, averaged over partners and seats.
        seats: The same with the scored agent on each of the protocol's seats.
        thresholds: One for each of the protocol's levels.
        tail_quantile: 0.15-quantile over partners, averaged over training seeds, points.
        tail_mean: Mean over the worst 15 % of the partners, averaged over training seeds, points.
        low_quantile: What is known about the 0.15-quantile over training seeds, in words; null for a single one.
        curve: Partners in ascending order.
        cells: The partners that count, in the order of their means; equals by name.
        floors: The partners that do not, by name.
        soup_points: Points of one soup here, the unit of `thresholds`.
    """

    layout: str
    adapted: bool
    partners: int
    mean: Estimate
    seats: tuple[Estimate, ...]
    thresholds: tuple[ThresholdScore, ...]
    tail_quantile: Estimate
    tail_mean: Estimate
    low_quantile: str | None
    curve: tuple[CurvePoint, ...]
    cells: tuple[Cell, ...]
    floors: tuple[Cell, ...]
    soup_points: float = float(DEFAULT_SOUP_REWARD)

    @property
    def worst(self) -> Cell:
        """The partner with the lowest mean."""
        return self.cells[0]

    @property
    def best(self) -> Cell:
        """The partner with the highest mean."""
        return self.cells[-1]


class Source(msgspec.Struct, frozen=True):
    """Something that took part.

    Attributes:
        name: What it is called.
        sha256: Hash of what it is.
    """

    name: str
    sha256: str


class CategoryScore(msgspec.Struct, frozen=True):
    """The scenarios of a category; counts are means over training seeds.

    Attributes:
        category: Its name.
        items: Scenarios from both seats in both mirrors; a pair counts once.
        passed: Of them.
        not_attempted: In kitchens that the agent says it cannot play; failed.
        families: Families of scenarios.
        share: Mean over families of the share passed; the interval is Wilson's for so many families, or with several
            training seeds t over them.
    """

    category: str
    items: int
    passed: float
    not_attempted: float
    families: int
    share: Estimate


class ScenarioScore(msgspec.Struct, frozen=True):
    """How the agent did in the cooperation scenarios.

    Attributes:
        suite: What was played.
        repeats: Runs of each situation.
        categories: One by one.
        total: All of them together, as the category "total".
    """

    suite: Source
    repeats: int
    categories: tuple[CategoryScore, ...]
    total: CategoryScore


class Scores(msgspec.Struct, frozen=True):
    """A score.json.

    Attributes:
        schema: Version of this form.
        protocol: What was played.
        settings: The protocol in full.
        agent: Who was scored.
        pool: Who was met; null in scores of protocols that named scripted partners alone.
        seed: 0 for scores that are to be compared.
        salt: The run's: the protocol's public one in scores that are to be compared, a fresh one in official runs.
        training_seeds: Independent training runs of the agent, S.
        interval: What the intervals are about, and what not.
        overall: Equal-weight mean over the attempted layouts, points an episode; null where none was attempted. Its
            interval is over training seeds, or the episode blocks of a single one, each averaged over the layouts.
        layouts: In the protocol's order.
        not_attempted: Layouts that the agent says it cannot play.
        run: Times, versions and everything else that may differ between two runs of the same score.
        scenarios: The cooperation scenarios; null where they were not played.
    """

    schema: int
    protocol: Source
    settings: Protocol
    agent: Source
    pool: Source | None
    seed: int
    salt: str
    training_seeds: int
    interval: str
    overall: Estimate | None
    layouts: tuple[LayoutScore, ...]
    not_attempted: tuple[str, ...]
    run: dict[str, Any]
    scenarios: ScenarioScore | None = None

    def write(self, file: str | Path) -> None:
        """Writes score.json, all or nothing."""
        data = msgspec.json.format(msgspec.json.encode(self), indent=2) + b"\n"
        write_whole(file, data)


def read_scores(file: str | Path) -> Scores:
    """Reads a score.json.

    Raises:
        ScoresError: It is missing, not a score.json, or of another schema.
    """
    try:
        content = msgspec.json.decode(Path(file).read_bytes())
        content["settings"] = settings = upgrade(content["settings"])
        content.setdefault("salt", settings["play"]["salt"])
        scores = msgspec.convert(content, Scores)
    except (OSError, msgspec.DecodeError, ValueError, LookupError, TypeError) as error:
        raise ScoresError(f"{file}: not a score.json of this version ({error})") from error
    if scores.schema != SCHEMA:
        raise ScoresError(f"{file}: its schema is {scores.schema}; this version reads {SCHEMA}")
    return scores

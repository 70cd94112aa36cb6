"""`Scores`: what score.json says, and how older ones are read."""

import os
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import msgspec
from msgspec import Meta

from overcooked_bench.agents.submissions.loading import MOST_TRAINING_SEEDS
from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.cells import PartnerLabel
from overcooked_bench.evaluation.estimators import FEWEST_RUNS
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.score_upgrades import from_1, from_2
from overcooked_bench.files import write_whole

SCHEMA: Final = 3

EPISODES_FILE: Final = "episodes.sqlite"
SCORES_FILE: Final = "score.json"
CURVE_FILE: Final = "curve.png"
REPORT_FILE: Final = "report.html"
SCENARIOS_FILE: Final = "scenarios.json"

MEAN: Final = "mean"
"""The mean return, which partners are sorted by, and scores of protocols without headlines ranked by."""

UPGRADES: Final[dict[int, Callable[[dict[str, Any]], dict[str, Any]]]] = {1: from_1, 2: from_2}
"""Schema -> the function that upgrades a score.json to the next schema."""

_MOST_BYTES: Final = 64_000_000

LARGEST: Final = 1e9
"""No number in a row is so large; plots of much larger ones overflow."""
Bounded = Annotated[float, Meta(ge=-LARGEST, le=LARGEST)]

_NEEDS: Final = {"curve": "rank", "curve_quantile": "rank", "undecided": "soups"}
"""Metric -> the parameter that plots and notes read from its rows."""

ABOUT: Final = ("layout", "seat", "side", "stratum", "home", "partner")
"""Entries of a row that say what it is about."""


class ScoresError(WrongUse):
    """A score.json cannot be read; the message names the file and the entry."""


class Row(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One number: a metric, what it is about, and its interval. Keys that are left out are null.

    Attributes:
        metric: Its name; `Scores.metrics` says how to show it.
        params: What it was computed with, such as `{"soups": 3}`.
        layout: The layout; null for the mean over all layouts of the protocol.
        seat: The scored agent's seat; null for all seats.
        side: The region that the scored agent starts in; null for all.
        stratum: The partners' stratum; null for all that count.
        home: Whether the scored agent is at home with the partners; null for all that count.
        partner: The partner; null for all that count.
        value: The number.
        low: Lower end of its 95 % interval, null if the data give none; `Scores.interval` says what it covers.
        high: Upper end.
        error: Its standard error; null if the data give none, and in scores before schema 3.
        per_repetition: The number of each independent repetition, which are the training seeds or, of a single one, the
            episode blocks; null in scores of schema 1.
    """

    metric: str
    params: dict[str, Bounded] = {}
    layout: str | None = None
    seat: int | None = None
    side: int | None = None
    stratum: str | None = None
    home: bool | None = None
    partner: str | None = None
    value: Bounded
    low: Bounded | None = None
    high: Bounded | None = None
    error: Bounded | None = None
    per_repetition: tuple[Bounded, ...] | None = None

    @property
    def estimate(self) -> Estimate:
        """The number with its interval."""
        return Estimate(self.value, self.low, self.high)

    @property
    def about(self) -> tuple[Any, ...]:
        """What the number is about: equal for rows of two scores that can be compared."""
        entries = (getattr(self, name) for name in ABOUT)
        return self.metric, tuple(sorted(self.params.items())), *entries


class LayoutFacts(msgspec.Struct, frozen=True):
    """What was played on one layout.

    Attributes:
        layout: Its name.
        adapted: Whether the agent was given the mirror image, because it knows the layout only that way round.
        soup_points: Points of one soup there, the unit of thresholds.
        partners: Those that count, then the floors.
        remark: What is known about the 0.15-quantile over training seeds, in words; null for a single one.
    """

    layout: str
    adapted: bool
    soup_points: Annotated[float, Meta(gt=0, le=LARGEST)]
    partners: tuple[PartnerLabel, ...]
    remark: str | None = None


class Source(msgspec.Struct, frozen=True):
    """A protocol, agent, pool or suite of a score.

    Attributes:
        name: Its name.
        sha256: Hash of its content.
    """

    name: str
    sha256: str


class Declined(msgspec.Struct, frozen=True):
    """A layout that the agent does not play.

    Attributes:
        layout: Its name.
        reason: The reason that the agent gives.
    """

    layout: str
    reason: str


class ScenarioResult(msgspec.Struct, frozen=True):
    """One cooperation scenario, or a pair that counts together.

    Attributes:
        scenario: Its id.
        category: Its category.
        share: Share of its situations that were passed, from each seat and in the mirror image, mean over training
            seeds; null if none was attempted.
    """

    scenario: str
    category: str
    share: float | None


class CategoryScore(msgspec.Struct, frozen=True):
    """The scenarios of a category; numbers are means over training seeds.

    Attributes:
        category: Its name.
        attempted: Scenarios that the agent attempted: it plays their kitchen.
        passed: How many of them it passed; one of which it passes a part of the situations counts in part.
        not_attempted: Scenarios in kitchens that it declines.
        share: Share of the attempted ones that were passed; null if none was. With several training seeds t over those
            that attempted some; one training run has no interval. Before schema 3 it is the mean over families.
    """

    category: str
    attempted: float
    passed: float
    not_attempted: float
    share: Estimate | None


class ScenarioScore(msgspec.Struct, frozen=True, omit_defaults=True):
    """How the agent did in the cooperation scenarios: a profile, which enters no score.

    Attributes:
        suite: What was played.
        repeats: Runs of each situation.
        categories: One by one.
        total: All of them together, as the category "total".
        scenarios: Each scenario; none in scores before schema 3.
        counted: "scenarios", or "situations" in scores before schema 3, which counted each seat and mirror image.
    """

    suite: Source
    repeats: int
    categories: tuple[CategoryScore, ...]
    total: CategoryScore
    scenarios: tuple[ScenarioResult, ...] = ()
    counted: Literal["scenarios", "situations"] = "scenarios"


class Scores(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """A score.json.

    Attributes:
        schema: Version of this form.
        protocol: What was played; the hash is that of `settings.play`.
        settings: The protocol in full.
        agent: The scored agent.
        pool: The pool of partners; null in scores of protocols that named scripted partners alone.
        seed: 0 for scores that are to be compared.
        salt: The run's: the protocol's public one in scores that are to be compared, a fresh one in official runs.
        training_seeds: Number of independent training runs of the agent, S.
        interval: What the intervals cover, and what they do not.
        overall: The first headline over all layouts of the protocol, each with equal weight: N under protocols that
            have it, else the mean return; null unless all layouts were played.
        unranked: Why the score is not to be ranked with others of its `kind`; null if it is.
        layouts: Those that were played to the end, in the protocol's order.
        declined: Those that the agent does not play.
        faults: What the agent did wrong, each at a named cell or scenario.
        metrics: How to show each metric of `rows`.
        rows: All numbers.
        scenarios: The cooperation scenarios; null if they were not played, or not to the end.
        run: Times, versions and everything else that may differ between two runs of the same score.
    """

    schema: int
    protocol: Source
    settings: Protocol
    agent: Source
    pool: Source | None
    seed: int
    salt: str
    training_seeds: Annotated[int, Meta(ge=1, le=MOST_TRAINING_SEEDS)]
    interval: str
    overall: Estimate | None
    unranked: str | None
    layouts: tuple[LayoutFacts, ...]
    declined: tuple[Declined, ...]
    faults: tuple[str, ...]
    metrics: tuple[MetricFacts, ...]
    rows: tuple[Row, ...]
    scenarios: ScenarioScore | None
    run: dict[str, Any]

    @property
    def headline(self) -> str:
        """The metric that scores of this protocol are ranked by."""
        return self.settings.report.headline

    @property
    def kind(self) -> Literal["method", "runs", "agent"]:
        """What was scored: a method by five training runs or more, a few runs of one, or a single agent."""
        if self.training_seeds >= FEWEST_RUNS:
            return "method"
        return "runs" if self.training_seeds > 1 else "agent"

    def select(self, metric: str | None = None, **about: Any) -> Iterator[Row]:
        """Yields the rows of a metric, or of all, with the given entries: `select("mean", layout="cramped_room")`."""
        for row in self.rows:
            if metric in (None, row.metric) and all(getattr(row, key) == value for key, value in about.items()):
                yield row

    def find(self, metric: str = MEAN, **about: Any) -> Row | None:
        """Returns the row of a metric that is about exactly this; other entries are null.

        Args:
            metric: Its name.
            **about: `params`, and entries of `ABOUT`.
        """
        params: dict[str, float] | None = about.get("params")
        wanted = None if params is None else tuple(sorted(params.items()))
        return self._first.get((metric, wanted, *(about.get(name) for name in ABOUT)))

    @cached_property
    def _first(self) -> dict[tuple[Any, ...], Row]:
        """The first row by metric, parameters or None for any, and what it is about; a page looks up thousands."""
        found: dict[tuple[Any, ...], Row] = {}
        for row in self.rows:
            about = tuple(getattr(row, name) for name in ABOUT)
            for params in (None, tuple(sorted(row.params.items()))):
                found.setdefault((row.metric, params, *about), row)
        return found

    def with_partners(self, layout: LayoutFacts) -> list[tuple[PartnerLabel, Row]]:
        """Lists a layout's partners that count with their mean returns, worst first; ties are sorted by name."""
        means = {row.partner: row for row in self.select(MEAN, layout=layout.layout, seat=None) if row.partner}
        pairs = [(label, means[label.name]) for label in layout.partners if label.counts]
        return sorted(pairs, key=lambda pair: (pair[1].value, pair[0].name))

    def write(self, file: str | Path) -> None:
        """Writes score.json, all or nothing."""
        write_whole(file, self.to_json())

    def to_json(self) -> str:
        """Returns the content of score.json."""
        return msgspec.json.format(msgspec.json.encode(self), indent=2).decode() + "\n"


def in_folder(source: str | Path, name: str) -> Path:
    """Returns a file of a score: the one with this name if `source` is the score's folder, else `source` itself."""
    path = Path(source)
    return path / name if os.path.isdir(path) else path


def read_scores(file: str | Path) -> Scores:
    """Reads a score.json of this version or an older one.

    Args:
        file: The file, or the folder of a score.

    Raises:
        ScoresError: It is missing or damaged, not a score.json, of a newer schema, or its entries do not fit together.
    """
    path = in_folder(file, SCORES_FILE)
    content: dict[str, Any] = read_json(path, _MOST_BYTES, dict, ScoresError)
    schema = content.get("schema")
    try:
        while schema in UPGRADES:
            content = UPGRADES[schema](content)
            schema = content.get("schema")
        if schema != SCHEMA:
            raise ScoresError(f"{path}: its schema is {schema!r}; this version reads {SCHEMA} and {list(UPGRADES)}")
        scores = msgspec.convert(content, Scores)
        _check(scores)
    except ScoresError:
        raise
    except (ValueError, LookupError, TypeError, AttributeError, ArithmeticError) as error:
        raise ScoresError(f"{path}: not a score.json of schema {content.get('schema')!r} ({error})") from error
    return scores


def _check(scores: Scores) -> None:
    """Checks that a score can be shown and compared.

    Raises:
        ValueError: It cannot; says which entry is wrong.
    """
    if not isinstance(scores.run.get("versions", {}), dict):
        raise ValueError("run.versions is not an object")
    known = {facts.name: facts for facts in scores.metrics}
    if scores.layouts and MEAN not in known:
        raise ValueError(f"metrics do not list {MEAN!r}")
    for metric, params in dict.fromkeys((row.metric, tuple(row.params.items())) for row in scores.rows):
        if metric not in known:
            raise ValueError(f"metrics do not list {metric!r}, which has a row")
        if _NEEDS.get(metric) not in (None, *dict(params)):
            raise ValueError(f"a row of {metric!r} has no parameter {_NEEDS[metric]!r}")
        known[metric].heading(dict(params))
    if MEAN in known:
        known[MEAN].heading({})
    for layout in scores.layouts:
        there = {row.partner for row in scores.select(MEAN, layout=layout.layout, seat=None)}
        for label in layout.partners:
            if label.counts and (label.name not in there or not label.name):
                raise ValueError(f"no row has the {MEAN} with {label.name!r} on {layout.layout!r}")

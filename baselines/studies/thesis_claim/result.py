"""The content of result.json: every number of the result page."""

import msgspec

from .analysis import Difference, Verdict
from .registered import Registered
from .view import View


class Test(msgspec.Struct, frozen=True, kw_only=True):
    """One comparison.

    Attributes:
        layout: Where.
        measure: "home", "away", "h50 home" or "h50 away".
        first: The arm that the difference is of.
        second: The arm that is subtracted.
        means: Of both.
        found: The difference.
        verdict: By the rule of the plan; None for comparisons that decide nothing.
        wording: The plan's sentence for it; "" likewise.
    """

    layout: str
    measure: str
    first: str
    second: str
    means: tuple[float, float]
    found: Difference
    verdict: Verdict | None = None
    wording: str = ""


class ArmMeans(msgspec.Struct, frozen=True, kw_only=True):
    """An arm on one layout; means over blocks.

    Attributes:
        layout: Where.
        arm: Which; or the reference agent, which is not trained.
        blocks: How many.
        failed: How many of these could not be trained, and count as 0.
        n: Stratum -> N.
        measures: The measures of `Test` -> mean.
        self_play: Points per episode with itself.
        steps: Joint steps of the agent.
        seconds: CPU seconds that it took beyond the arms before it; None if it is not trained.
    """

    layout: str
    arm: str
    blocks: int
    failed: int
    n: dict[str, float]
    measures: dict[str, float]
    self_play: float
    steps: float
    seconds: float | None


class Other(msgspec.Struct, frozen=True, kw_only=True):
    """The primary comparisons under another protocol, such as that of a pool that was mended.

    Attributes:
        play: Hash of what was played.
        pool: Hash of the pool.
        primary: The comparisons.
    """

    play: str
    pool: str
    primary: tuple[Test, ...]


class Result(msgspec.Struct, frozen=True, kw_only=True):
    """The content of result.json.

    Attributes:
        registered: Hashes of the plan, the recipe and the code.
        changed: Files of the code that have changed since.
        play: Hash of what was played.
        pool: Hash of the pool.
        blocks: Layout -> main blocks that count, and how many were planned.
        primary: The two comparisons that decide.
        secondary: One family, adjusted together.
        null: Self-play against other self-play of the same block.
        rows: The other rows of the thesis's Table 7.2, and the convolutions; they decide nothing.
        arms: All arms.
        others: The primary comparisons under other protocols.
        views: The thesis's view by layout, where it was played.
        hours: Part of the study -> core-hours so far, the pilot's too.
        deviations: What was done otherwise than planned.
    """

    registered: Registered
    changed: tuple[str, ...]
    play: str
    pool: str
    blocks: dict[str, tuple[int, int]]
    primary: tuple[Test, ...]
    secondary: tuple[Test, ...]
    null: tuple[Test, ...]
    rows: tuple[Test, ...]
    arms: tuple[ArmMeans, ...]
    others: tuple[Other, ...]
    views: tuple[View, ...]
    hours: dict[str, float]
    deviations: str

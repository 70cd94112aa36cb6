"""`Explanation`: what explain.json says."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import msgspec
from msgspec import Meta

from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.explaining.reasons import PAIRINGS, REASONS, Pairing, Reason, Soups
from overcooked_bench.evaluation.scores import Source, in_folder
from overcooked_bench.files import shown, write_whole
from overcooked_bench.kitchen.codes import ACTION_LETTERS
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.rendering.replay import Frame, frames_of

SCHEMA: Final = 1
EXPLAIN_FILE: Final = "explain.json"
MOMENTS_FOLDER: Final = "moments"
"""Folder of the worst moments, in the folder of a score."""

PREFIX: Final = "moment-"
"""The names of kept moments, and of their scenarios, begin with it."""

_MOST_BYTES: Final = 64_000_000

Letters = Annotated[str, Meta(pattern=rf"^[{ACTION_LETTERS}]*\Z", max_length=10_000)]
Count = Annotated[int, Meta(ge=0)]


class ExplanationError(WrongUse):
    """An explain.json cannot be read; the message names the file and the entry."""


class _Record(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    pass


class Moment(_Record, frozen=True, kw_only=True):
    """A moment, and what was played from it on.

    Attributes:
        training_seed: Of the scored agent.
        episode: Index of the start state.
        partner: The partner's name.
        stratum: The partner's origin.
        seat: The scored agent's seat.
        step: Joint actions that were played before.
        soups: What was delivered from there.
        reason: Why the pair failed, or that it did not.
        differ: Axes on which the conventions of the two differ.
        agree: Axes on which they agree. An axis on which one of them is not known or does all of it is in neither.
    """

    training_seed: Count
    episode: Count
    partner: str
    stratum: str
    seat: Annotated[int, Meta(ge=0, le=1)]
    step: Count
    soups: Soups
    reason: Reason
    differ: tuple[str, ...]
    agree: tuple[str, ...]


class Game(_Record, frozen=True, kw_only=True):
    """One game from a moment on: of a pairing's repeats the one whose soups are nearest to their mean.

    Attributes:
        repeat: Which it is.
        soups: What was delivered in it.
        actions: Both chefs' actions, one letter per step: U D R L S I (up, down, right, left, stay, interact).
    """

    repeat: Count
    soups: float
    actions: tuple[Letters, Letters]

    def __post_init__(self) -> None:
        if len(set(map(len, self.actions))) > 1:
            raise ValueError(f"one chef has {len(self.actions[0])} actions, the other {len(self.actions[1])}")


class Worst(_Record, frozen=True, kw_only=True):
    """One of the worst moments, kept to be watched and played.

    Attributes:
        name: Its name, and that of its scenario.
        moment: Index into the layout's moments.
        conventions: Those of the scored agent and of the partner, axis -> value.
        state: The state in overcooked_ai's JSON form, as pages draw it.
        games: Pairing -> the game that is shown.
        scenario: The scenario's file, in the folder of the moments; null if the scenario language cannot say it, or if
            not even `greedy` solves it.
    """

    name: str
    moment: Count
    conventions: tuple[dict[str, str], dict[str, str]]
    state: dict[str, Any]
    games: dict[Pairing, Game]
    scenario: str | None

    def __post_init__(self) -> None:
        if set(self.games) != set(PAIRINGS):
            raise ValueError(f"{self.name} has not all games")

    def frames(self, layout: str, pairing: Pairing, cooking: str) -> Iterator[Frame]:
        """Plays a game again: the states that a page shows, and the points earned until then.

        Args:
            layout: The layout's name.
            pairing: Which of the games.
            cooking: The cooking mode.

        Raises:
            ValueError: The state is not one of the layout.
        """
        letters = self.games[pairing].actions
        joint = [[ACTION_LETTERS.index(action) for action in pair] for pair in zip(*letters, strict=True)]
        start = KitchenState.from_dict(self.state)
        return frames_of(layout, start, joint, cooking=cooking, horizon=start.timestep + len(joint))


class Shares(_Record, frozen=True, kw_only=True):
    """What holds for some moments.

    Attributes:
        moments: How many there are from which a soup can be delivered; the shares are of these.
        nothing: How many there are besides.
        fails: Share from which the pair fails.
        reasons: Share of each reason; those of `FAILURES` sum to `fails`. Null if there are no moments.
        soups: Mean soups of each pairing.
    """

    moments: Count
    nothing: Count
    fails: Estimate | None
    reasons: dict[Reason, Estimate]
    soups: dict[Pairing, Estimate]

    def __post_init__(self) -> None:
        reasons: set[str] = {reason for reason in REASONS if reason != "nothing"}
        whole: tuple[set[str], set[str]] = (reasons, {*PAIRINGS})
        wanted = whole if self.moments else (set(), set())
        if (set(self.reasons), set(self.soups)) != wanted or (self.fails is None) == (self.moments > 0):
            raise ValueError(
                f"{self.moments} moments have shares of other reasons, or soups of other pairings, than these"
            )


class AxisShares(_Record, frozen=True, kw_only=True):
    """What holds for the moments of partners whose convention on an axis differs from the agent's, or agrees.

    Attributes:
        axis: Its name.
        differ: Whether they differ.
        shares: What holds for them.
    """

    axis: str
    differ: bool
    shares: Shares


class LayoutExplanation(_Record, frozen=True, kw_only=True):
    """What was found on one layout.

    Attributes:
        layout: Its name.
        shares: Of all its moments.
        axes: By axis, where conventions differ and where they agree.
        conventions: Training seed of the agent -> its conventions as a text, such as "onions=top, dishes=bottom".
        moments: One by one.
        worst: Those in which the pair missed most.
    """

    layout: str
    shares: Shares
    axes: tuple[AxisShares, ...]
    conventions: dict[str, str]
    moments: tuple[Moment, ...]
    worst: tuple[Worst, ...]


class Explanation(_Record, frozen=True, kw_only=True):
    """An explain.json.

    Attributes:
        schema: Version of this form.
        agent: The scored agent.
        pool: Its partners.
        protocol: What was played; the hash is that of its part `play`.
        cooking: The kitchens' cooking mode.
        steps: Steps that are played from each moment.
        repeats: Times that each pairing but `greedy` plays on from a moment.
        reasons: What each reason means.
        interval: What the intervals cover.
        layouts: Those of the score.
        strata: Stratum of partners -> what holds for its moments on all layouts.
        total: What holds for the moments of all layouts.
    """

    schema: Literal[1] = SCHEMA
    agent: Source
    pool: Source
    protocol: Source
    cooking: Literal["auto", "manual"]
    steps: Count
    repeats: Count
    reasons: dict[Reason, str]
    interval: str
    layouts: tuple[LayoutExplanation, ...]
    strata: dict[str, Shares]
    total: Shares

    def __post_init__(self) -> None:
        if set(self.reasons) != set(REASONS):
            raise ValueError(f"reasons explains {', '.join(self.reasons)}, not {', '.join(REASONS)}")

    def to_json(self) -> str:
        """Returns the content of explain.json."""
        return msgspec.json.format(msgspec.json.encode(self), indent=1).decode() + "\n"

    def write(self, file: str | Path) -> None:
        """Writes explain.json, all or nothing."""
        write_whole(file, self.to_json())


def read_explanation(source: str | Path) -> Explanation:
    """Reads an explain.json.

    Args:
        source: The file, or the folder of a score.

    Raises:
        ExplanationError: It is missing, damaged or of another schema, or what it says does not fit together.
    """
    path = in_folder(source, EXPLAIN_FILE)
    found = read_json(path, _MOST_BYTES, Explanation, ExplanationError)
    for layout in found.layouts:
        for worst in layout.worst:
            try:
                if worst.moment >= len(layout.moments):
                    raise ValueError("it is none of the moments")
                for pairing in PAIRINGS:
                    list(worst.frames(layout.layout, pairing, found.cooking))
            except (ValueError, WrongUse, LookupError, TypeError, ArithmeticError, RecursionError) as error:
                raise ExplanationError(
                    f"{path}: {shown(worst.name)} cannot be shown ({error}); run `overcooked-bench explain` again"
                ) from error
    return found

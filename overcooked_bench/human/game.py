"""`Game`: one recorded game, the line of a games file (format 1).

Axes: T steps.
"""

from functools import lru_cache
from typing import Annotated, Any, Final, Literal

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import NDArray

from overcooked_bench.documents import LONGEST
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import NAME
from overcooked_bench.kitchen.codes import ACTION_LETTERS
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Chef, KitchenState

FORMAT: Final = 1
MOST_STEPS: Final = 10_000
"""Steps of a game and of its kitchen's horizon at most: twenty minutes of a game at eight steps per second."""

_WRONG: Final = 255
_CODES: Final = np.full(256, _WRONG, np.uint8)
_CODES[np.frombuffer(ACTION_LETTERS.encode(), np.uint8)] = np.arange(len(ACTION_LETTERS))

Text = Annotated[str, Meta(max_length=2000)]
Step = Annotated[int, Meta(ge=0, lt=MOST_STEPS)]
Seat = Annotated[int, Meta(ge=0, le=1)]


class GamesError(WrongUse):
    """A recorded game cannot be used; the message names the file and the line where there is one."""


class Player(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Who sat on a seat.

    Attributes:
        kind: "human" or "agent".
        name: An agent's name, or a label that identifies no person.
        sha256: Hash of what an agent is, None if it is not known.
    """

    kind: Literal["human", "agent"]
    name: Annotated[str, Meta(min_length=1, max_length=300)]
    sha256: Annotated[str, Meta(pattern=r"^[0-9a-f]{64}\Z")] | None = None


class Game(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A recorded game; make one with `games.record`, which counts the soups.

    Attributes:
        format: 1.
        layout: A shipped layout's name, `<name>-mirrored`, or a grid's text.
        cooking: "auto" or "manual".
        horizon: Steps of an episode in the kitchen that it was played in; T if the game went on until it was over.
        start: The first state in overcooked_ai's JSON form (`KitchenState.to_dict`), its timestep 0; None for the
            layout's standard start.
        actions: T letters of U D R L S I (up, down, right, left, stay, interact) for each chef, at most `horizon`.
        seats: Who sat on seats 0 and 1.
        soups: [step, seat] of every delivery, in this order; the step is the index of the action that delivered it.
        source: Where the game comes from.
        group: A label of the people who played, which identifies no person: "2019-07"; None for agents.
        consent: What the people agreed to.
        licence: What others may do with the game.
        notes: Anything else.

    Raises:
        GamesError: The parts do not fit together; names the step.
    """

    format: Literal[1] = FORMAT
    layout: Annotated[str, Meta(max_length=LONGEST)]
    cooking: Literal["auto", "manual"]
    horizon: Annotated[int, Meta(ge=1, le=MOST_STEPS)]
    start: dict[str, Any] | None = None
    actions: tuple[Annotated[str, Meta(max_length=MOST_STEPS)], Annotated[str, Meta(max_length=MOST_STEPS)]]
    seats: tuple[Player, Player]
    soups: Annotated[tuple[tuple[Step, Seat], ...], Meta(max_length=2 * MOST_STEPS)]
    source: Text
    group: Annotated[str, Meta(pattern=rf"^{NAME}\Z")] | None = None
    consent: Text | None = None
    licence: Text | None = None
    notes: Text | None = None

    def __post_init__(self) -> None:
        """Checks that the parts fit together."""
        first, second = map(len, self.actions)
        if first != second:
            raise GamesError(f"chef 0 has {first} actions and chef 1 has {second}; write one letter per step for each")
        if not 1 <= first <= self.horizon:
            raise GamesError(f"{first} steps in a kitchen with a horizon of {self.horizon}; give 1 to {self.horizon}")
        for seat, letters in enumerate(self.actions):
            if strange := np.flatnonzero(_codes(letters) == _WRONG).tolist():
                step = strange[0]
                raise GamesError(
                    f"step {step}: the action {letters[step]!a} of chef {seat}; letters are "
                    f"{' '.join(ACTION_LETTERS)} (up, down, right, left, stay, interact)"
                )
        before = (-1, 0)
        for soup in self.soups:
            if soup <= before or soup[0] >= first:
                raise GamesError(
                    f"step {soup[0]}: the soup {list(soup)} is out of order or after the last of {first} steps; "
                    "list [step, seat] of every delivery once, ordered by step and seat"
                )
            before = soup

    @property
    def steps(self) -> int:
        """T."""
        return len(self.actions[0])

    @property
    def kitchen(self) -> Layout:
        """Where it was played.

        Raises:
            LayoutError: The layout is neither shipped nor a legal grid.
        """
        return _named(self.layout)

    def joint_actions(self) -> NDArray[np.uint8]:
        """Returns the (T, 2) joint actions, codes 0 to 5 of `kitchen.codes`."""
        return np.stack([_codes(letters) for letters in self.actions], axis=1)

    def first_state(self) -> KitchenState:
        """Returns the state that the game starts in.

        Raises:
            StateError: `start` is not a state.
            LayoutError: The layout is neither shipped nor a legal grid, or has no standard start and `start` is None.
        """
        if self.start is not None:
            return KitchenState.from_dict(self.start)
        layout = self.kitchen
        if not layout.start_cells:
            raise LayoutError(
                "the layout has no standard start, since no cells are marked 1 and 2; write a start state"
            )
        chefs = [Chef(cell) for cell in layout.start_cells]
        return KitchenState((chefs[0], chefs[1]), orders=layout.orders, bonus_orders=layout.bonus_orders)


def letters_of(actions: NDArray[np.integer[Any]]) -> tuple[str, str]:
    """Returns (T, 2) joint actions as the letters of both chefs.

    Raises:
        GamesError: Another shape, or a number that is no action.
    """
    if actions.ndim != 2 or actions.shape[1] != 2 or not np.isin(actions, np.arange(len(ACTION_LETTERS))).all():
        raise GamesError(f"joint actions of the shape {actions.shape}; give (T, 2) whole numbers from 0 to 5")
    first, second = ("".join(ACTION_LETTERS[action] for action in column) for column in actions.T.tolist())
    return first, second


@lru_cache(maxsize=64)
def _named(layout: str) -> Layout:
    """Reads a layout, which takes long if it is large, once for many games."""
    return Layout.named(layout)


def _codes(letters: str) -> NDArray[np.uint8]:
    return _CODES[np.frombuffer(letters.encode("ascii", "replace"), np.uint8)]

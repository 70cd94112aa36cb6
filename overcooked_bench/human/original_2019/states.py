"""Reads the texts that the recordings of 2019 consist of: states, joint actions and grids, as Python wrote them."""

from typing import Any, Final, Literal

import msgspec

from overcooked_bench.documents import parse_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown
from overcooked_bench.kitchen.codes import DIRECTIONS, INTERACT, MAX_INGREDIENTS, STAY, Position
from overcooked_bench.kitchen.state import FACINGS, Chef, Soup, Thing

COOK_TIME: Final = 20
"""Steps that a soup cooked."""

_LONGEST: Final = 5000  # characters
_JOINT = tuple[Position | Literal["INTERACT"], Position | Literal["INTERACT"]]


class RecordingError(WrongUse):
    """A recording of 2019 is not of the form that its authors published; the message names the game and the step."""


class _Object(msgspec.Struct, forbid_unknown_fields=True):
    position: Position
    name: Literal["onion", "dish", "soup"]
    state: tuple[Literal["onion"], int, int] | None = None  # of a soup: what is in it, how many, steps cooked

    def thing(self) -> Thing:
        """Returns the object; the clock of a soup went on when it was ready, which made no difference to the game."""
        if self.name != "soup":
            return self.name
        if self.state is None:
            raise ValueError("a soup without its state")
        _, onions, tick = self.state
        if not 1 <= onions <= MAX_INGREDIENTS or tick < 0:
            raise ValueError("a soup that cannot be")
        if onions < MAX_INGREDIENTS and tick == 0:
            return Soup((onions, 0))
        return Soup((onions, 0), min(tick, COOK_TIME), COOK_TIME)


class _Player(msgspec.Struct, forbid_unknown_fields=True):
    position: Position
    orientation: Position
    held_object: _Object | None = None

    def chef(self) -> Chef:
        held = self.held_object
        if held is not None and held.position != self.position:
            raise ValueError("what a chef holds is elsewhere")
        facing = FACINGS[DIRECTIONS.index(self.orientation)]
        return Chef(self.position, facing, None if held is None else held.thing())


class _State(msgspec.Struct, forbid_unknown_fields=True):
    players: tuple[_Player, _Player]
    objects: dict[str, _Object]
    order_list: tuple[Literal["onion"]]
    pot_explosion: bool


class Scene(msgspec.Struct, frozen=True):
    """What a recorded state says.

    Attributes:
        chefs: The chefs on seats 0 and 1.
        objects: (x, y) -> the object there.
    """

    chefs: tuple[Chef, Chef]
    objects: dict[Position, Thing]


def read_scene(text: str, where: str) -> Scene:
    """Reads a recorded state.

    Args:
        text: A dict as Python writes it.
        where: The game and the step, for messages.

    Raises:
        RecordingError: It is not a state of 2019, or one under other rules.
    """
    state: _State = _parse(text, where, _State)
    try:
        if state.pot_explosion:
            raise ValueError("soups that burn")
        objects = {thing.position: thing.thing() for thing in state.objects.values()}
        if state.objects.keys() != {f"{x},{y}" for x, y in objects}:
            raise ValueError("an object that is elsewhere")
        return Scene((state.players[0].chef(), state.players[1].chef()), objects)
    except ValueError as error:
        raise RecordingError(f"{where}: not a state of 2019: {error} in {shown(text)}") from None


def read_actions(text: str, where: str) -> tuple[int, int]:
    """Reads a recorded joint action, such as `[[0, -1], 'INTERACT']`, as codes 0 to 5.

    Raises:
        RecordingError: It is none.
    """

    def code(action: Position | str) -> int:
        if isinstance(action, str):
            return INTERACT
        return STAY if action == (0, 0) else DIRECTIONS.index(action)

    first, second = _parse(text, where, _JOINT)
    try:
        return code(first), code(second)
    except ValueError:
        raise RecordingError(f"{where}: {shown(text)} is not a joint action") from None


def read_rows(text: str, where: str) -> tuple[str, ...]:
    """Reads a recorded grid as its rows.

    Raises:
        RecordingError: It is none.
    """
    rows: tuple[str, ...] = _parse(text, where, tuple[str, ...])
    return rows


def _parse(text: str, where: str, kind: Any) -> Any:
    if len(text) > _LONGEST:
        raise RecordingError(f"{where}: a text of {len(text):,} characters; at most {_LONGEST:,} are read")
    # texts in them are plain names in single quotes, so this makes JSON of what is sound, and of nothing else
    json = text.replace("'", '"').replace("False", "false").replace("True", "true")
    return parse_json(json, where, kind, RecordingError)

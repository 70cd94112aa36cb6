"""Games files (`*.games.jsonl`): one recorded game per line, checked by replay when they are read."""

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from io import BytesIO
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from overcooked_bench.documents import parse_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import read_regular, shown, write_whole
from overcooked_bench.human.game import FORMAT, MOST_STEPS, Game, GamesError, Player, letters_of
from overcooked_bench.human.replay import replay
from overcooked_bench.kitchen.codes import SERVED
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState

SUFFIX: Final = ".games.jsonl"
MOST_BYTES: Final = 1 << 28
"""Of a games file: about 200,000 episodes of 400 steps."""

_MOST_LINE: Final = 1 << 20  # bytes
_MOST_FAULTS: Final = 100

Soups = tuple[tuple[int, int], ...]
OnProgress = Callable[[int, int], object]
"""Called with the steps that have been played and those of all games."""


class Checked(NamedTuple):
    """What a games file holds.

    Attributes:
        games: The games that replay as they say.
        faults: What is wrong with each of the others, with file, line and step.
    """

    games: list[Game]
    faults: list[str]


def read_games(path: str | Path) -> list[Game]:
    """Reads a games file.

    Raises:
        GamesError: It cannot be read, a line is not a game, or a game does not replay as it says; names the file, the
            line and, if it is one, the step.
    """
    games, faults = check_games(path)
    if faults:
        raise GamesError(faults[0])
    return games


def check_games(path: str | Path, on_progress: OnProgress = lambda done, of: None) -> Checked:
    """Reads a games file as far as it can be read, and says what is wrong with the rest.

    It stops at the hundredth line that is not a game.

    Args:
        path: The file.
        on_progress: Called while games are played.

    Raises:
        GamesError: The file cannot be read at all.
    """
    games: dict[int, Game] = {}
    faults: dict[int, str] = {}
    for number, line in enumerate(BytesIO(read_regular(path, MOST_BYTES, raises=GamesError)), start=1):
        if line.strip() and len(faults) < _MOST_FAULTS:
            try:
                games[number] = _parse(line, f"{shown(path)}:{number}")
            except WrongUse as error:
                faults[number] = str(error)
    played = deliveries(list(games.values()), on_progress)
    for number, game, soups in zip(games, games.values(), played, strict=True):
        if soups != game.soups:
            faults[number] = f"{shown(path)}:{number}: {_deviation(game, soups)}"
    sound = [game for number, game in games.items() if number not in faults]
    return Checked(sound, [faults[number] for number in sorted(faults)])


def write_games(path: str | Path, games: Iterable[Game]) -> None:
    """Writes a games file, whole or not at all.

    Raises:
        GamesError: It would be larger than what `read_games` reads.
    """
    data = b"".join(msgspec.json.encode(game) + b"\n" for game in games)
    if len(data) > MOST_BYTES:
        raise GamesError(f"{shown(path)}: {len(data):,} bytes of games; write several files of {MOST_BYTES:,} at most")
    write_whole(path, data)


def record(
    layout: str,
    actions: ArrayLike,
    *,
    seats: tuple[Player, Player],
    source: str,
    start: KitchenState | None = None,
    cooking: str = "auto",
    horizon: int | None = None,
    **more: Any,
) -> Game:
    """Makes a game from its joint actions; plays it to see which soups are delivered.

    Args:
        layout: A shipped layout's name, `<name>-mirrored`, or a grid's text.
        actions: (T, 2) joint actions, codes 0 to 5.
        seats: Who sat on seats 0 and 1.
        source: Where the game comes from.
        start: The first state; by default the layout's standard start.
        cooking: "auto" or "manual".
        horizon: Steps of an episode in the kitchen that it was played in; T by default.
        more: `group`, `consent`, `licence` and `notes` of a `Game`.

    Raises:
        GamesError: The game cannot be played, or is not of the form of a `Game`.
    """
    joint = np.asarray(actions)
    game = Game(
        layout=layout,
        cooking=cooking,  # type: ignore[arg-type]
        horizon=len(joint) if horizon is None else horizon,
        start=None if start is None else start.to_dict(),
        actions=letters_of(joint),
        seats=seats,
        soups=(),
        source=source,
        **more,
    )
    return record_all([game])[0]


def record_all(drafts: Sequence[Game], on_progress: OnProgress = lambda done, of: None) -> list[Game]:
    """Plays games and returns them with the soups that are delivered in them, whatever theirs were.

    Args:
        drafts: The games.
        on_progress: Called while they are played.

    Raises:
        GamesError: A game cannot be played, or is not of the form of a `Game`.
    """
    try:
        games = [_normal(msgspec.convert(msgspec.to_builtins(draft), Game)) for draft in drafts]
    except msgspec.ValidationError as error:
        raise GamesError(f"not a game: {error}") from None
    found = deliveries(games, on_progress)
    return [msgspec.structs.replace(game, soups=soups) for game, soups in zip(games, found, strict=True)]


def deliveries(games: Sequence[Game], on_progress: OnProgress = lambda done, of: None) -> list[Soups]:
    """Plays games again; returns the (step, seat) of every delivery in each of them, paid for or not."""
    soups: list[list[tuple[int, int]]] = [[] for _ in games]
    done, total = 0, sum(game.steps for game in games)
    for moment in replay(games):
        done += len(moment.games)
        on_progress(done, total)
        taken = moment.play().actions_taken
        assert taken is not None
        for row, seat in np.argwhere(taken & SERVED != 0).tolist():
            soups[moment.games[row]].append((int(moment.steps[row]), seat))
    return [tuple(each) for each in soups]


class _OfFormat(msgspec.Struct):
    """The one key that all formats have."""

    format: Any = FORMAT


def _parse(line: bytes, where: str) -> Game:
    if len(line) > _MOST_LINE:
        raise GamesError(f"{where}: {len(line):,} bytes; a game has {_MOST_LINE:,} at most")
    try:
        game = parse_json(line, where, Game, GamesError)
    except GamesError:
        try:
            given = parse_json(line, where, _OfFormat, GamesError).format
        except GamesError as error:
            raise GamesError(f"{error}; a games file is UTF-8 with one JSON object, one game, per line") from None
        if given != FORMAT:
            raise GamesError(
                f"{where}: a game of format {shown(given, 20)}; this version reads format {FORMAT}"
            ) from None
        raise
    try:
        return _normal(game)
    except WrongUse as error:
        raise GamesError(f"{where}: {error}") from None


def _normal(game: Game) -> Game:
    """Returns a game with its start state as this package writes it, and without one if it is the standard start.

    Raises:
        GamesError: The layout or the start state cannot be played.
    """
    try:
        kitchens = _scratch(game.kitchen, game.cooking)
        state = game.first_state()
        if state.timestep != 0:
            raise GamesError(f"the start state is that of step {state.timestep}; write the first state, of step 0")
        kitchens.set_state(0, state)
    except WrongUse as error:
        raise GamesError(f"the game on {shown(game.layout, 60)!r} cannot be played: {error}") from None
    if game.start is None:
        return game
    start = kitchens.state(0)
    standard = bool(game.kitchen.start_cells) and start == msgspec.structs.replace(game, start=None).first_state()
    return msgspec.structs.replace(game, start=None if standard else start.to_dict())


@lru_cache(maxsize=32)
def _scratch(layout: Layout, cooking: str) -> Kitchens:
    """A kitchen to try start states in."""
    return Kitchens(layout, 1, cooking=cooking, horizon=MOST_STEPS)


def _deviation(game: Game, played: Soups) -> str:
    step, seat = min(set(played) ^ set(game.soups))
    what = "the listed soup is not delivered" if (step, seat) in game.soups else "an unlisted soup is delivered"
    return (
        f"step {step}, chef {seat}: {what} when the game is replayed with cooking {game.cooking!r}; it was changed, or "
        "played under other rules"
    )

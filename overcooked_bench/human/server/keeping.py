"""What is kept of games that people play, if they agree: joint actions, points, and no names."""

import secrets
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.files import append_line, cut_unfinished_line, is_file
from overcooked_bench.human.game import Game, GamesError, Player
from overcooked_bench.human.games import MOST_BYTES, SUFFIX, record
from overcooked_bench.human.server.chefs import AgentChef, Chef
from overcooked_bench.human.server.live import LiveGame

LICENCE: Final = "CC0-1.0"
CONSENT: Final = (
    "The person agreed, before the first game, that the layout, every chef's actions and the points are kept and "
    "published under CC0-1.0. No names, addresses or times are kept."
)
"""Is in every game that is kept; the page says the same."""


def new_label() -> str:
    """Draws a label for a person's visit, which says nothing of the person."""
    return f"p{secrets.token_hex(4)}"


def recorded(game: LiveGame, labels: Sequence[str], pace: float, source: str, notes: str = "") -> Game:
    """Makes the record of a game, which replays to the same points.

    Args:
        game: As far as it was played, one step at least.
        labels: Of the people in it.
        pace: Seconds per step.
        source: Where the game comes from.
        notes: Anything else.
    """
    late = f"; the agent's answer came too late in {game.late} steps" if game.late else ""
    seats = [_player(chef) for chef in game.chefs]
    return record(
        game.layout.name,
        game.actions,
        seats=(seats[0], seats[1]),
        source=source,
        cooking=game.cooking,
        horizon=game.horizon,
        group="-".join(labels),
        consent=CONSENT,
        licence=LICENCE,
        notes=f"{1000 * pace:.0f} ms per step{late}" + (f"; {notes}" if notes else ""),
    )


class GamesFile:
    """A games file that grows by a line with every game; a line is on the disk before anything else happens.

    Args:
        path: The file; made with the first game. A line that a killed program left unfinished is cut off.

    Raises:
        GamesError: Its name does not end in `.games.jsonl`, or it cannot be written.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        if not self.path.name.endswith(SUFFIX):
            raise GamesError(f"{self.path}: the name of a games file ends in {SUFFIX}; write {self.path.stem}{SUFFIX}")
        self.path.parent.mkdir(parents=True, exist_ok=True)
        cut_unfinished_line(self.path)

    def add(self, game: Game) -> None:
        """Writes a game.

        Raises:
            GamesError: The file is as large as a games file may be.
        """
        line = msgspec.json.encode(game)
        if is_file(self.path) and self.path.stat().st_size + len(line) >= MOST_BYTES:
            raise GamesError(f"{self.path}: full; give another file")
        append_line(self.path, line)


def _player(chef: Chef) -> Player:
    if isinstance(chef, AgentChef):
        return Player("agent", chef.entrant.name, chef.entrant.sha256)
    return Player("human", "person")

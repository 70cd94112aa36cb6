"""`WatchedGame`: one game of a games file, ready to be watched."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from overcooked_bench.files import shown
from overcooked_bench.human.game import Game, GamesError
from overcooked_bench.human.games import read_games
from overcooked_bench.rendering.replay import Frame, frames_of, play_in_terminal, save_gif
from overcooked_bench.rendering.viewer.games import save_page


@dataclass(frozen=True)
class WatchedGame:
    """A game and its place in its file.

    Attributes:
        game: What was recorded.
        number: Its place, from 0.
    """

    game: Game
    number: int

    @property
    def names(self) -> tuple[str, str]:
        """Who sits on seats 0 and 1."""
        return shown(self.game.seats[0].name, 60), shown(self.game.seats[1].name, 60)

    @property
    def title(self) -> str:
        """Which game this is, in one line."""
        (first, second), game = self.names, self.game
        layout = game.kitchen.name.partition("\n")[0]
        length = f"{game.steps:,} steps, {len(game.soups)} soup{'s' * (len(game.soups) != 1)}"
        return f"game {self.number}, {layout}: {first} on seat 0 with {second}, {length}"

    def frames(self) -> Iterator[Frame]:
        """Plays the game again; points are those of a soup in the layout here."""
        game = self.game
        return frames_of(
            game.kitchen, game.first_state(), game.joint_actions(), cooking=game.cooking, horizon=game.horizon
        )

    def show(self, fps: float = 8, every: int = 1) -> None:
        """Shows the game in the terminal."""
        play_in_terminal(self.game.kitchen, self.frames(), fps=fps, every=every, names=self.names)

    def save_gif(self, file: str | Path, fps: float = 8, every: int = 1) -> None:
        """Writes the game as a GIF."""
        save_gif(file, self.game.kitchen, self.frames(), fps=fps, every=every, names=self.names)

    def save_page(self, file: str | Path) -> None:
        """Writes a page that plays the game."""
        save_page(file, self.game.kitchen, self.frames(), self.names, self.title)


def find_game(file: str | Path, number: int = 0) -> WatchedGame:
    """Finds a game of a games file by its place, from 0.

    Raises:
        GamesError: The file cannot be read, a game in it does not replay as it says, or it has no such game.
    """
    games = read_games(file)
    if not 0 <= number < len(games):
        there = f"games 0 to {len(games) - 1}" if games else "no games"
        raise GamesError(f"{shown(file)}: no game {number}; it has {there}")
    return WatchedGame(games[number], number)

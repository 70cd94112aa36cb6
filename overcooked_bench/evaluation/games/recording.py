"""`Recording`: one stored episode, ready to be watched."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.replayed import read_settings
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE, in_folder
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.replay import Frame, frames_of, play_in_terminal, save_gif
from overcooked_bench.rendering.viewer.games import save_page


@dataclass(frozen=True)
class Recording:
    """An episode and what is needed to play it again.

    Attributes:
        file: The store.
        episode: What was stored.
        protocol: What it was played under.
        agent: The scored agent's name.
    """

    file: Path
    episode: Episode
    protocol: Protocol
    agent: str

    @property
    def layout(self) -> Layout:
        """Where it was played."""
        return Layout.load(self.episode.layout)

    @property
    def names(self) -> tuple[str, str]:
        """Who sits on seats 0 and 1."""
        pair = self.agent, self.episode.partner
        return pair if self.episode.seat == 0 else (pair[1], pair[0])

    @property
    def title(self) -> str:
        """Which episode this is, in one line."""
        e = self.episode
        return (
            f"{e.layout}: {self.agent} on seat {e.seat} with {e.partner}, episode {e.episode}, "
            f"training seed {e.training_seed}: {e.soup_reward:g} points"
        )

    def frames(self) -> Iterator[Frame]:
        """Plays the episode again.

        Raises:
            StoreError: The start state or the joint actions cannot be played, or do not bring the points that were
                recorded.
        """
        rules, points = self.protocol.play, 0.0
        try:
            layout, start = self.layout, self.episode.first_state
            actions = self.episode.joint_actions(rules.horizon)
            for state, points in frames_of(layout, start, actions, cooking=rules.cooking, horizon=rules.horizon):
                yield state, points
        except (ValueError, LookupError, ArithmeticError, RecursionError) as error:
            raise StoreError(f"{self.file}: {self.episode.cell} cannot be replayed: {error}") from error
        if points != self.episode.soup_reward:
            raise StoreError(
                f"{self.file}: {self.title} were recorded, but the joint actions bring {points:g} here; "
                "the store was changed, or written by a version with other rules"
            )

    def show(self, fps: float = 8, every: int = 1) -> None:
        """Shows the episode in the terminal."""
        play_in_terminal(self.layout, self.frames(), fps=fps, every=every, names=self.names)

    def save_gif(self, file: str | Path, fps: float = 8, every: int = 1) -> None:
        """Writes the episode as a GIF."""
        save_gif(file, self.layout, self.frames(), fps=fps, every=every, names=self.names)

    def save_page(self, file: str | Path) -> None:
        """Writes a page that plays the episode."""
        save_page(file, self.layout, self.frames(), self.names, self.title)


def find_recording(
    source: str | Path,
    *,
    layout: str | None = None,
    partner: str | None = None,
    seat: int | None = None,
    episode: int | None = None,
    training_seed: int | None = None,
    worst: bool = False,
) -> Recording:
    """Finds a stored episode.

    Args:
        source: The folder of a score, or its episodes.sqlite.
        layout: Only on this layout.
        partner: Only with this partner.
        seat: Only with the scored agent on this seat.
        episode: Only this start state.
        training_seed: Only this training run.
        worst: The fewest points among those that fit, floors and the agent's copies left out; else the first of them.

    Raises:
        StoreError: No such store, or no episode fits; says what there is.
    """
    file = in_folder(source, EPISODES_FILE)
    given = {"layout": layout, "partner": partner, "seat": seat, "episode": episode, "training_seed": training_seed}
    where = {column: value for column, value in given.items() if value is not None}
    with Store(file) as store:
        found = store.find(where, worst)
        if found is None:
            raise StoreError(f"{file}: {_nothing(store, where)}")
        return Recording(file, found, read_settings(store), store.facts.get("agent_name", "the agent"))


def _nothing(store: Store, where: dict[str, str | int]) -> str:
    for column, value in where.items():
        present = store.values(column)
        if value not in present:
            return f"no episode with {column} {value!r}; there are {', '.join(map(str, present)) or 'none yet'}"
    said = ", ".join(f"{column} {value}" for column, value in where.items())
    return f"no episode with {said}" if said else "no episodes yet"

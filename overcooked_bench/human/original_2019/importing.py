"""Makes games of the recordings of 2019, and compares every state and reward with a replay.

Times, workers' numbers and everything else that is not needed to play a game again is dropped. Axes: T steps.

Source: Carroll et al. (2019), human-human games on the five classic layouts, from the package overcooked-ai 1.1.0.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.files import shown
from overcooked_bench.human.game import Game, Player, letters_of
from overcooked_bench.human.games import record_all
from overcooked_bench.human.original_2019.dataframe import read_columns
from overcooked_bench.human.original_2019.distribution import PACKAGE, member
from overcooked_bench.human.original_2019.inert import read_pickle
from overcooked_bench.human.original_2019.states import RecordingError, Scene, read_actions, read_rows, read_scene
from overcooked_bench.human.replay import Moment, replay
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState

SOUP_POINTS: Final = 5
"""What a soup paid."""

LAYOUTS: Final = {
    "cramped_room": "cramped_room",
    "asymmetric_advantages": "asymmetric_advantages",
    "coordination_ring": "coordination_ring",
    "random0": "forced_coordination",
    "random3": "counter_circuit",
}
"""Names of 2019 -> ours, in our order."""

_COLUMNS: Final = {
    **{"workerid_num": int, "cur_gameloop": float, "reward": float},
    **dict.fromkeys(("layout_name", "layout", "state", "next_state", "joint_action"), str),
}
"""What is read of a table; everything else stays unread."""


class Difference(OvercookedBenchError):
    """A recorded game does not replay; the message names the game and the step."""

    exit_code = 1


@dataclass(frozen=True)
class Imported:
    """The games of 2019.

    Attributes:
        games: By layout, then by pair; the pairs are numbered from 0 in the order in which they come up in the files.
        sets: For each of them, the set that its publishers put it in: "train" or "test".
    """

    games: list[Game]
    sets: list[str]


@dataclass(frozen=True)
class _Recording:
    """A game as it was recorded, in one of the publishers' sets.

    Attributes:
        name: For messages.
        pair: The number of the two people, in the recordings only.
        scenes: T + 1 texts, of the state before each step and after the last.
        actions: (T, 2) codes.
        rewards: T, the team's points.
    """

    name: str
    set: str
    layout: str
    pair: int
    scenes: list[str]
    actions: NDArray[np.uint8]
    rewards: list[float]


def import_games(pickles: Mapping[str, bytes], on_progress: Callable[[int, int], None] | None = None) -> Imported:
    """Reads the pickles of both sets, and replays every game.

    Args:
        pickles: By set.
        on_progress: Gets how many steps have been compared, and how many there are.

    Raises:
        PickleError: A pickle is damaged, or holds more than a table.
        TableError: A table is not of the form that was published, or lacks a column.
        RecordingError: The rows are not those of games; names the row, or the game and the step.
        Difference: A game does not replay; names the game and the step.
    """
    found = [
        recording
        for name, data in pickles.items()
        for recording in _recordings(name, read_columns(read_pickle(data, member(name)), _COLUMNS, member(name)))
    ]
    pairs = list(dict.fromkeys(recording.pair for recording in found))
    found.sort(key=lambda recording: (list(LAYOUTS.values()).index(recording.layout), pairs.index(recording.pair)))
    for one, other in pairwise(found):
        if (one.layout, one.pair) == (other.layout, other.pair):
            raise RecordingError(f"{one.name} and {other.name} are games of the same people on the same layout")
    games = record_all([_draft(recording, pairs.index(recording.pair)) for recording in found])
    _compare(games, found, on_progress or (lambda done, of: None))
    return Imported(games, [recording.set for recording in found])


def _recordings(name: str, columns: Mapping[str, Sequence[Any]]) -> Iterator[_Recording]:
    """Cuts a table into games: rows of the same people on the same layout, one after the other."""
    played: dict[str, tuple[int, int]] = {}

    def who_where(row: int) -> tuple[Any, Any]:
        return columns["workerid_num"][row], columns["layout_name"][row]

    for (pair, layout), rows in groupby(range(len(columns["state"])), key=who_where):
        first, *_ = chosen = list(rows)
        end = first + len(chosen)
        if layout not in LAYOUTS:
            raise RecordingError(
                f"set {name}, row {first}: a game on {shown(layout)}; layouts are {', '.join(LAYOUTS)}"
            )
        where = f"set {name}, {LAYOUTS[layout]}, rows {first} to {end - 1}"
        if columns["cur_gameloop"][first:end] != list(range(len(chosen))):
            raise RecordingError(f"{where}: the steps are not numbered from 0")
        ours = Layout.load(LAYOUTS[layout])
        grids = {read_rows(text, where) for text in set(columns["layout"][first:end])}
        if {tuple(row.replace("1", " ").replace("2", " ") for row in grid) for grid in grids} != {ours.rows}:
            raise RecordingError(f"{where}: not the grid of {ours.name}")
        states, after = columns["state"][first:end], columns["next_state"][first:end]
        for step, (next_state, state) in enumerate(zip(after[:-1], states[1:], strict=True)):
            if next_state != state:
                raise RecordingError(f"{where}: step {step + 1} does not begin where step {step} ended")
        for step, text in enumerate(columns["joint_action"][first:end]):
            if text not in played:
                played[text] = read_actions(text, f"{where}, step {step}")
        actions = np.array([played[text] for text in columns["joint_action"][first:end]], np.uint8)
        rewards = columns["reward"][first:end]
        yield _Recording(where, name, ours.name, pair, [*states, after[-1]], actions, list(rewards))


def _draft(recording: _Recording, pair: int) -> Game:
    """Makes a game of a recording, without its soups."""
    group = f"2019-{pair:02d}"
    scene = read_scene(recording.scenes[0], f"{recording.name}, step 0")
    person = Player("human", f"a person of pair {group}")
    return Game(
        layout=recording.layout,
        cooking="auto",
        horizon=len(recording.actions),
        start=KitchenState(scene.chefs, scene.objects).to_dict(),
        actions=letters_of(recording.actions),
        seats=(person, person),
        soups=(),
        source=f"overcooked_ai (Carroll et al. 2019), package {PACKAGE}, clean_{recording.set}_trials.pickle",
        group=group,
        consent="published by the authors of the study, without names, in the public repository overcooked_ai",
        licence="MIT",
    )


def _compare(games: list[Game], recordings: list[_Recording], tell: Callable[[int, int], None]) -> None:
    """Compares every state and reward with a replay.

    Raises:
        Difference: Names the game and the step.
    """
    done, of = 0, sum(game.steps for game in games)
    for moment in replay(games):
        _compare_scenes(moment, recordings, 0)
        points = moment.play().soup_reward.sum(axis=1) * (SOUP_POINTS / moment.kitchens.layout.soup_points)
        for index, step, earned in zip(moment.games.tolist(), moment.steps.tolist(), points.tolist(), strict=True):
            if earned != recordings[index].rewards[step]:
                recorded = recordings[index].rewards[step]
                raise _difference(recordings[index], step, f"{recorded:g} points", f"{earned:g}")
        ended = np.array([games[index].steps for index in moment.games]) == moment.steps + 1
        _compare_scenes(moment, recordings, 1, ended)
        done += len(moment.rows)
        tell(done, of)


def _compare_scenes(
    moment: Moment, recordings: list[_Recording], later: int, which: NDArray[np.bool_] | slice = slice(None)
) -> None:
    """Compares the states of games with those that were recorded `later` steps after the moment's."""
    for row, index, step in zip(
        moment.rows[which].tolist(), moment.games[which].tolist(), (moment.steps[which] + later).tolist(), strict=True
    ):
        recording, state = recordings[index], moment.kitchens.state(row)
        scene = read_scene(recording.scenes[step], f"{recording.name}, step {step}")
        if (state.chefs, state.objects) != (scene.chefs, scene.objects):
            raise _difference(recording, step, *_first_unlike(scene, state))


def _first_unlike(scene: Scene, state: KitchenState) -> tuple[str, str]:
    for seat, (recorded, replayed) in enumerate(zip(scene.chefs, state.chefs, strict=True)):
        if recorded != replayed:
            return f"{recorded} on seat {seat}", str(replayed)
    place = min({*scene.objects.items()} ^ {*state.objects.items()}, key=lambda entry: entry[0])[0]
    return f"{scene.objects.get(place)} at {place}", str(state.objects.get(place))


def _difference(recording: _Recording, step: int, recorded: str, replayed: str) -> Difference:
    return Difference(f"{recording.name}, step {step}: recorded is {recorded}, replayed {replayed}")

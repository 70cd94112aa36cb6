"""Games of different lengths are replayed in one batch exactly as each is alone."""

import numpy as np
import pytest

from overcooked_bench.errors import WrongUse
from overcooked_bench.human.replay import replay
from overcooked_bench.kitchen.kitchens import Kitchens
from tests.human.made import random_game

GAMES = [
    random_game("cramped_room", steps=50, seed=0),
    random_game("cramped_room", steps=12, seed=1, horizon=45),
    random_game("coordination_ring", steps=20, seed=2),
    random_game("cramped_room", steps=31, seed=3),
    random_game("cramped_room", steps=31, seed=4, cooking="manual"),
]


@pytest.mark.parametrize("name", ["lossless", "features", "stack_channels"])
def test_every_game_looks_as_it_did_when_it_was_played(name):
    seen: list[list[np.ndarray]] = [[] for _ in GAMES]
    brought: list[list[tuple]] = [[] for _ in GAMES]
    for moment in replay(GAMES, observations=(name,), events=True):
        before = moment.observe(name)
        result = moment.play()
        assert moment.play() is result
        for row, game in enumerate(moment.games):
            assert moment.steps[row] == len(seen[game])
            assert moment.actions[row].tolist() == GAMES[game].joint_actions()[moment.steps[row]].tolist()
            seen[game].append(before[row])
            brought[game].append(tuple(array[row] for array in result))
    for game, views, results in zip(GAMES, seen, brought, strict=True):
        assert len(views) == game.steps
        kitchens = Kitchens(
            *(game.layout, 1),
            cooking=game.cooking,
            horizon=game.horizon,
            history=3,
            events=True,
            actions_taken=True,
            autoreset=False,
        )
        kitchens.set_state(0, game.first_state())
        for joint, view, result in zip(game.joint_actions(), views, results, strict=True):
            np.testing.assert_array_equal(view, kitchens.observe(name)[0])
            for ours, alone in zip(result, kitchens.step(joint[None]), strict=True):
                np.testing.assert_array_equal(ours, alone[0])


def test_a_game_that_ends_before_its_horizon_is_over_there():
    lengths = {}
    for moment in replay(GAMES):
        for game, step in zip(moment.games.tolist(), moment.steps.tolist(), strict=True):
            lengths[game] = step + 1
    assert lengths == {index: game.steps for index, game in enumerate(GAMES)}


def test_steps_in_which_no_game_runs_are_not_played(monkeypatch):
    """Two short lines of a file could otherwise cost 10,000 steps."""
    played = []
    step = Kitchens.step
    monkeypatch.setattr(Kitchens, "step", lambda self, actions: (played.append(1), step(self, actions))[1])
    games = [random_game(steps=steps, horizon=horizon, seed=steps) for steps, horizon in ((3, 10_000), (4, 5))]
    del played[:]
    assert sum(len(moment.games) for moment in replay(games)) == len(played) == 7


def test_a_stack_has_to_be_asked_for():
    with pytest.raises(WrongUse, match="needs the past"):
        next(replay(GAMES)).observe("stack_channels")


def test_no_games_have_no_steps():
    assert list(replay([])) == []

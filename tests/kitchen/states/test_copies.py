"""A copied or pickled batch plays on by itself; `step_into` does in the caller's arrays what `step` does in its own."""

import copy
import pickle

import numpy as np
import pytest

from overcooked_bench import Kitchens
from overcooked_bench.kitchen.events import EVENTS

N, STEPS = 3, 60


def joint_actions(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 6, (STEPS, N, 2))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda kitchens: pickle.loads(pickle.dumps(kitchens))])
def test_a_copy_plays_the_same_game_and_leaves_the_first_alone(copied):
    kitchens = Kitchens("cramped_room", N, horizon=50, history=3)
    kitchens.reset(seed=1)
    for actions in joint_actions(0):
        kitchens.step(actions)
    before = [kitchens.state(i) for i in range(N)]
    twin = copied(kitchens)
    assert [twin.state(i) for i in range(N)] == before
    for actions in joint_actions(1):
        twin.step(actions)
    assert [kitchens.state(i) for i in range(N)] == before
    for actions in joint_actions(1):
        kitchens.step(actions)
    after = [kitchens.state(i) for i in range(N)]
    assert after != before
    assert [twin.state(i) for i in range(N)] == after
    for name in ("lossless26", "stack_channels", "features"):
        np.testing.assert_array_equal(twin.observe(name), kitchens.observe(name))
    twin.set_state(0, before[0])
    assert twin.state(0) == before[0]


def test_step_into_fills_the_callers_arrays_as_step_does():
    ours, theirs = (Kitchens("cramped_room", N, horizon=40, events=True, actions_taken=True) for _ in range(2))
    ours.reset(seed=2)
    theirs.reset(seed=2)
    rewards, truncated = np.full((2, N, 2), np.nan), np.zeros(N, np.bool_)
    ended = 0
    for actions in joint_actions(3):
        events = np.zeros((N, 2, len(EVENTS)), np.bool_)
        taken = np.full((N, 2), 77, np.uint16)
        over = ours.step_into(actions, rewards, truncated, events, taken)
        result = theirs.step(actions)
        assert over == truncated.sum()
        ended += over
        for mine, expected in zip((*rewards, truncated, events, taken), result, strict=True):
            np.testing.assert_array_equal(mine, expected)
    assert ended == N
    assert [ours.state(i) for i in range(N)] == [theirs.state(i) for i in range(N)]


def test_step_into_refuses_what_step_refuses():
    kitchens = Kitchens("cramped_room", N)
    before = [kitchens.state(i) for i in range(N)]
    with pytest.raises(ValueError, match="kitchen 1, chef 1: action 6"):
        kitchens.step_into(np.array([[0, 0], [0, 6], [0, 0]]), np.zeros((2, N, 2)), np.zeros(N, np.bool_))
    assert [kitchens.state(i) for i in range(N)] == before

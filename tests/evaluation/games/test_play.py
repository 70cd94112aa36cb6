import pickle

import numpy as np
import pytest

from overcooked_bench import UnknownLayout, load_agent, play_episodes
from overcooked_bench.agents import one_game_at_a_time
from overcooked_bench.agents.seated import SeatedFault

WHO = "agent 1 (Told)"


class Told:
    """Does what a test says."""

    observation = "lossless"

    def __init__(self, act):
        self.answer = act

    def reset(self, layout, seats, seeds):
        self.layout, self.seats, self.seeds = layout, seats, seeds

    def act(self, observations):
        self.seen = observations
        return self.answer(len(observations))


def waiting(rows):
    return np.full(rows, 4)


def pair(layout="cramped_room"):
    return load_agent("greedy", layout), load_agent("random", layout)


def test_it_gives_the_teams_soups_and_each_chefs_useful_steps():
    result = play_episodes("cramped_room", agents=pair(), episodes=3, horizon=200)
    assert result.soup_reward.shape == (3,)
    assert result.partial_reward.shape == (3, 2)
    assert (result.soup_reward % 20 == 0).all()
    assert result.soup_reward.sum() > 0
    assert result.partial_reward[:, 0].min() > 0


def test_the_same_seed_plays_the_same_games_and_another_does_not():
    first, again, other = (
        play_episodes("cramped_room", agents=pair(), episodes=4, seed=seed, horizon=100).partial_reward
        for seed in (1, 1, 2)
    )
    assert (first == again).all()
    assert (first != other).any()


def test_an_episode_does_not_depend_on_how_many_are_played():
    few, many = (play_episodes("cramped_room", agents=pair(), episodes=n, horizon=100).partial_reward for n in (2, 5))
    assert (few == many[:2]).all()


def test_agents_may_look_at_different_things():
    grid, state = Told(waiting), Told(waiting)
    grid.observation, state.observation = "stack_states", "state"
    play_episodes("cramped_room", agents=(grid, state), episodes=2, horizon=3)
    assert grid.seen.shape == (2, 4, 22, 4, 5)
    assert [kitchen.timestep for kitchen in state.seen] == [2, 2]
    assert (grid.seats.tolist(), state.seats.tolist()) == ([0, 0], [1, 1])
    assert len({*grid.seeds.tolist(), *state.seeds.tolist()}) == 4


def test_an_agent_cannot_change_what_the_other_sees():
    class Vandal(Told):
        def act(self, observations):
            observations[:] = 9
            return super().act(observations)

    other = Told(waiting)
    play_episodes("cramped_room", agents=(Vandal(waiting), other), episodes=1, horizon=2)
    assert other.seen[0, 0].sum() == 1  # where this chef stands


def test_the_same_object_twice_is_an_error():
    agent = Told(waiting)
    with pytest.raises(ValueError, match="the same object twice"):
        play_episodes("cramped_room", agents=(agent, agent), episodes=1)


def leave(rows):
    raise SystemExit(0)


def crash(rows):
    raise RuntimeError("out of flour")


@pytest.mark.parametrize(
    ("act", "row", "words"),
    [
        (leave, None, "act.. raised SystemExit: 0"),
        (crash, None, "act.. raised RuntimeError: out of flour"),
        (lambda rows: np.full(rows, 2.0), None, "float64"),
        (lambda rows: np.full((rows, 1), 2), None, "shape"),
        (lambda rows: None, None, "act returned"),
        (lambda rows: [[1], [1, 2]], None, "act returned no array"),
        (lambda rows: [4] * (rows - 1) + [6], 2, "action 6"),
        (lambda rows: np.array([4, -1, 4]), 1, "action -1"),
        (lambda rows: np.array([4, 4, 2**64 - 1], np.uint64), 2, "action"),
        (lambda rows: [True] * rows, None, "bool"),
    ],
)
def test_a_fault_names_the_agent_the_step_and_where_it_can_the_row(act, row, words):
    steps = iter(range(1000))

    def late(rows):
        return waiting(rows) if next(steps) < 5 else act(rows)

    with pytest.raises(SeatedFault, match=words) as fault:
        play_episodes("cramped_room", agents=(Told(waiting), Told(late)), episodes=3, horizon=20)
    assert (fault.value.who, fault.value.step, fault.value.row) == (WHO, 5, row)


def test_answers_may_be_lists_and_tensors():
    import torch

    for answer in (
        lambda rows: [4] * rows,
        lambda rows: torch.full((rows,), 4),
        lambda rows: np.full(rows, 4, np.uint8),
    ):
        games = play_episodes("cramped_room", agents=(Told(answer), Told(waiting)), episodes=2, horizon=2)
        assert games.soup_reward.tolist() == [0, 0]


def test_an_unknown_layout_stays_what_it_is():
    class Picky(Told):
        def reset(self, layout, seats, seeds):
            raise UnknownLayout(f"not {layout}")

    with pytest.raises(UnknownLayout, match="not cramped_room"):
        play_episodes("cramped_room", agents=(Picky(waiting), Told(waiting)), episodes=1)


@pytest.mark.parametrize("answer", ["4", 9, 2**70])
def test_of_agents_that_play_one_game_each_the_row_is_named(answer):
    class Plays:
        def reset(self, layout, seat, seed):
            Plays.last = self

        def act(self, seen):
            return answer if self is Plays.last else 4

    agent = one_game_at_a_time(Plays, observation="features")
    with pytest.raises(SeatedFault) as fault:
        play_episodes("cramped_room", agents=(Told(waiting), agent), episodes=3)
    assert (fault.value.who, fault.value.step, fault.value.row) == ("agent 1 (_OneGameAtATime)", 0, 2)
    copy = pickle.loads(pickle.dumps(fault.value))
    assert (str(copy), copy.row, copy.who) == (str(fault.value), 2, fault.value.who)


@pytest.mark.parametrize("observation", ["lossless", "stack_channels"])
def test_an_observation_that_the_kitchen_does_not_have_is_the_agents_fault(observation):
    blind, sees = Told(waiting), Told(waiting)
    blind.observation, sees.observation = observation, "lossless26"
    with pytest.raises(SeatedFault, match="no tomato channels") as fault:
        play_episodes("XXPXX\nT1 2O\nX   X\nXDXSX", agents=(sees, blind), episodes=1)
    assert (fault.value.who, fault.value.step) == (WHO, None)

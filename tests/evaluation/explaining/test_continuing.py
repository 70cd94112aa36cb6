"""Agents arrive at a moment as if they had lived through the episode: what they do next is what they did."""

import numpy as np
import pytest

from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import load_policy, save_policy
from overcooked_bench.agents.seated import Seated
from overcooked_bench.evaluation.explaining.continuing import play_on
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.kitchen.tracks.counts import count
from tests.agents.made import random_weights, small_cnn, small_lstm, small_mlp

LAYOUT, ROWS, HORIZON, STEPS = "cramped_room", 6, 160, 40
SEEDS = np.arange(2 * ROWS, dtype=np.uint64).reshape(ROWS, 2)


def policy(folder, architecture, scale, mode="sample"):
    files = save_policy(folder / "policy", architecture, random_weights(architecture, 1, scale))
    return NeuralAgent(load_policy(files.weights), mode)


AGENTS = {
    "lstm": lambda folder: policy(folder, small_lstm(), 2.0),
    "mlp": lambda folder: policy(folder, small_mlp(), 1.0),
    "stack": lambda folder: policy(folder, small_cnn("stack_states", shape=(4, 22, 4, 5)), 0.5),
    "random": lambda _: load_agent("random", LAYOUT),
    "hesitant": lambda _: load_agent("hesitant", LAYOUT),
    "clock": lambda _: load_agent({"does": "loop", "actions": ["up", "left*3", "interact", "down"]}, LAYOUT),
}


def parties(agent, partner):
    rows = np.arange(ROWS)
    seats = np.arange(ROWS) % 2
    return [Seated(agent, "agent", rows, seats), Seated(partner, "partner", rows, 1 - seats)]


@pytest.fixture(scope="module", params=AGENTS)
def lived(request, tmp_path_factory):
    """An agent, its partner, and the episodes that they played."""
    agent = AGENTS[request.param](tmp_path_factory.mktemp("agent"))
    seated = parties(agent, load_agent("greedy", LAYOUT))
    kitchens = make_kitchens(LAYOUT, ROWS, seated, horizon=HORIZON)
    kitchens.reset(seed=5)
    return request.param, seated, play(kitchens, seated, SEEDS)


def resume(seated, games, recorded, moments, starts=None):
    kitchens = make_kitchens(LAYOUT, ROWS, seated, horizon=HORIZON)
    kitchens.reset(seed=0)
    for row, state in enumerate(starts or games.starts):
        kitchens.set_state(row, state)
    return play_on(kitchens, seated, SEEDS, recorded, moments, STEPS)


def test_agents_arrive_at_their_moments_exactly(lived):
    _, seated, games = lived
    moments = np.array([0, 1, 50, 90, 119, 120])
    found = resume(seated, games, games.actions, moments)
    for row, moment in enumerate(moments.tolist()):
        assert np.array_equal(found.actions[:, row], games.actions[moment : moment + STEPS, row])
        assert found.states[row].timestep == moment
    whole = resume(seated, games, games.actions, np.full(ROWS, HORIZON - STEPS))
    assert (whole.points <= games.soup_reward.sum(axis=1)).all()


def test_only_what_came_before_the_moment_is_replayed(lived):
    _, seated, games = lived
    moments = np.full(ROWS, 70)
    other = games.actions.copy()
    other[70:] = 4
    found, again = (resume(seated, games, actions, moments) for actions in (games.actions, other[:70]))
    assert np.array_equal(found.actions, again.actions)


@pytest.mark.parametrize("architecture", [small_lstm, small_mlp])
def test_only_a_network_with_memory_depends_on_the_replay(architecture, tmp_path):
    """Likeliest actions depend on the state alone, and on what the network remembers; the partner goes in a circle."""
    circle = {"does": "loop", "actions": ["up", "left", "down", "right", "stay"]}  # five steps: it does not notice
    seated = parties(policy(tmp_path, architecture(), 2.0, "greedy"), load_agent(circle, LAYOUT))
    kitchens = make_kitchens(LAYOUT, ROWS, seated, horizon=HORIZON)
    kitchens.reset(seed=5)
    games = play(kitchens, seated, SEEDS)
    moments = np.full(ROWS, 70)
    replayed = resume(seated, games, games.actions, moments)
    begun = resume(seated, games, games.actions, np.zeros(ROWS, np.int64), replayed.states)
    assert np.array_equal(replayed.actions, games.actions[70 : 70 + STEPS])
    assert np.array_equal(begun.actions, replayed.actions) == (architecture is small_mlp)


def test_the_track_of_a_row_begins_at_its_moment(lived):
    _, seated, games = lived
    moments = np.array([0, 10, 20, 30, 40, 50])
    found = resume(seated, games, games.actions, moments)
    layout = make_kitchens(LAYOUT, 1, seated).layout
    for row, state in enumerate(found.states):
        track = found.track(row)
        for chef in range(2):
            x, y = state.chefs[chef].position
            assert track.cells[0, chef] == y * layout.width + x
        assert count(layout, track).points.sum() == found.points[row]

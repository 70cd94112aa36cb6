import json
import random
import re
from dataclasses import replace

import numpy as np
import pytest

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.games.asking import Answer, ask_block
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.rendering.replay import frames_of
from tests.evaluation.made import block, changed, protocol_text, write_agent


def by_pair(outcome):
    return {(episode.partner, episode.seat): episode for episode in outcome.episodes}


def test_a_block_is_every_partner_from_both_seats(protocol, pool_folder):
    outcome = play_block(block(protocol, pool=pool_folder, episodes=(1,)))
    assert outcome.block.keys == (("cramped_room", 0, 1),)
    names = [("greedy", "scripted"), ("random", "floor"), ("sp-0", "trained"), ("sp-1", "trained")]
    found = [(episode.partner, episode.kind, episode.seat) for episode in outcome.episodes]
    assert found == [(*who, seat) for who in names for seat in (0, 1)]
    assert all(episode.joint_actions(40).shape == (40, 2) for episode in outcome.episodes)


def test_the_same_block_is_the_same_to_the_byte(protocol, pool_folder):
    once, again = (play_block(block(protocol, pool=pool_folder)) for _ in range(2))
    assert once == again


@pytest.mark.parametrize("agent", ["random", "pool"])
def test_start_states_that_share_a_batch_are_played_as_if_each_were_alone(agent, protocol, pool_folder):
    name = f"{pool_folder}/cramped_room/sp-1" if agent == "pool" else agent
    alone = [play_block(block(protocol, name, pool=pool_folder, episodes=(e,))) for e in (1, 2, 4)]
    together = play_block(block(protocol, name, pool=pool_folder, episodes=(4, 1, 2)))
    assert together.episodes == tuple(episode for outcome in alone for episode in outcome.episodes)
    assert together.by_key == {key: list(one.episodes) for one in alone for key in one.block.keys}


def test_both_seats_of_a_partner_share_one_start_and_no_two_partners_do(protocol, pool_folder):
    pairs = by_pair(play_block(block(protocol, pool=pool_folder)))
    starts = {}
    for (partner, seat), episode in pairs.items():
        starts.setdefault(partner, {})[seat] = episode.start
    assert all(of[0] == of[1] for of in starts.values())
    assert len({of[0] for of in starts.values()}) == len(starts) == 4


def test_a_partner_plays_the_same_whoever_else_is_in_the_pool(protocol, pool_folder):
    """If the scored agent draws nothing: its seeds depend on the row, and rows on how many partners there are."""
    alone, together = (by_pair(play_block(block(protocol, "stay", pool=pool))) for pool in (None, pool_folder))
    assert {pair: together[pair] for pair in alone} == alone


def test_an_agent_meets_itself_in_the_starts_in_which_others_meet_themselves(protocol, pool_folder):
    rules = changed(protocol, self_play=True)
    agents = "greedy", f"{pool_folder}/cramped_room/sp-1"
    own = []
    for agent in agents:
        episodes = play_block(block(rules, agent, pool=pool_folder, episodes=(0, 1))).episodes
        own.append([episode for episode in episodes if episode.kind == "self"])
        assert [(one.partner, one.seat, one.episode) for one in own[-1]] == [
            ("itself", seat, episode) for episode in (0, 1) for seat in (0, 1)
        ]
        assert {one.partner_sha256 for one in own[-1]} == {find(agent).sha256}
    assert [one.start for one in own[0]] == [one.start for one in own[1]]
    assert not [one for one in play_block(block(protocol, pool=pool_folder)).episodes if one.kind == "self"]


def test_a_fault_of_the_copy_is_the_agents(protocol, tmp_path):
    reset = "if len(seats) < 4: raise ValueError('too few')"
    agent = write_agent(tmp_path / "agent.py", reset=reset)
    outcome = play_block(block(changed(protocol, self_play=True), agent))
    assert outcome.fault.startswith("cramped_room, training seed 0, episode 0, its copy that it plays with")
    assert "too few" in outcome.fault


@pytest.mark.parametrize("change", ["episodes", "seed", "salt", "protocol"])
def test_other_games_for_another(change, protocol):
    values = {"episodes": (1,), "salt": "sugar", "protocol": changed(protocol, salt="sugar")}
    other = replace(block(protocol), **{change: values.get(change, 1)})
    before, after = by_pair(play_block(block(protocol))), by_pair(play_block(other))
    assert all(before[pair].start != after[pair].start for pair in before)


def test_training_seeds_meet_the_same_starts(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", training_seeds=2)
    first, second = (by_pair(play_block(block(protocol, agent, training_seed=run))) for run in (0, 1))
    assert all(first[pair].start == second[pair].start for pair in first)


def test_joint_actions_replay_to_the_recorded_points():
    protocol = read_protocol(protocol_text(horizon=200), "longer.yaml")
    outcome = play_block(block(protocol))
    assert sum(episode.soup_reward for episode in outcome.episodes) > 0
    for episode in outcome.episodes:
        *_, (_, points) = frames_of("cramped_room", json.loads(episode.start), episode.joint_actions(200), horizon=200)
        assert points == episode.soup_reward == 20 * (episode.ego_soups + episode.partner_soups)


def test_rows_are_shuffled_anew_for_each_block(protocol, pool_folder, tmp_path):
    note = f"with open({str(tmp_path / 'seats')!r}, 'a') as f: print(seats.tolist(), file=f)"
    agent = write_agent(tmp_path / "agent.py", reset=note)
    for episode in range(4):
        play_block(block(protocol, agent, pool=pool_folder, episodes=(episode,)))
    orders = (tmp_path / "seats").read_text().splitlines()
    assert len(set(orders)) > 1
    assert all(sum(json.loads(order)) == 4 for order in orders)


def test_agents_that_draw_from_global_generators_are_reproducible_and_leave_them_alone(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act="return np.random.randint(0, 6, n)")
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002
    first = play_block(block(protocol, agent))
    here = random.random(), np.random.random()  # noqa: NPY002
    random.seed(1)
    np.random.seed(1)  # noqa: NPY002
    assert here == (random.random(), np.random.random())  # noqa: NPY002
    assert play_block(block(protocol, agent)) == first
    assert play_block(block(protocol, agent, episodes=(1,))).episodes[0].actions != first.episodes[0].actions


@pytest.mark.parametrize("observation", ["features", "stack_channels", "state"])
def test_the_agent_sees_what_it_asks_for(observation, protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", observation=observation)
    assert len(play_block(block(protocol, agent)).episodes) == 4


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ({"act": "raise KeyError('salt')"}, "partners greedy, random .*step 0: act.. raised KeyError: 'salt'"),
        ({"act": "return np.full(n, 9 if step == 7 else 4)"}, "partner (greedy|random), seat [01], step 7: .*action 9"),
        ({"act": "return np.full(n, 1.0)"}, "step 0: .*float64"),
        ({"reset": "raise OSError('no oven')"}, "at the reset: reset.. raised OSError: no oven"),
        ({"make": "return None"}, "training seed 0: .*make_agent"),
        ({"act": "return [4] * 7 + [9]"}, "seed 0, episode 1, partner (greedy|random), seat [01], step 0: .*action 9"),
        ({"act": "raise KeyError('salt')"}, "seed 0, episodes 0 to 1, partners greedy, random .*step 0"),
    ],
)
def test_a_fault_is_told_with_layout_partner_seat_and_step(fault, words, protocol, tmp_path):
    outcome = play_block(block(protocol, write_agent(tmp_path / "agent.py", **fault), episodes=(0, 1)))
    assert outcome.episodes == ()
    assert outcome.fault.startswith("cramped_room")
    assert re.search(words, outcome.fault)


def test_an_edited_submission_is_not_played_by_its_old_code(protocol, tmp_path):
    file = tmp_path / "agent.py"
    north = play_block(block(protocol, write_agent(file, act="return np.full(n, 0)")))
    before = block(protocol, file, episodes=(1,))
    south = play_block(block(protocol, write_agent(file, act="return np.full(n, 1)")))
    for outcome, action in ((north, 0), (south, 1)):
        assert all((episode.joint_actions(40)[:, episode.seat] == action).all() for episode in outcome.episodes)
    with pytest.raises(AgentError, match="changed while it was being played"):
        play_block(before)


def test_a_pool_that_was_changed_is_not_played(protocol, pool_folder):
    begun = replace(block(protocol, pool=pool_folder), pool_sha256="0" * 64)
    with pytest.raises(PoolError, match="changed while it was being played"):
        play_block(begun)


@pytest.mark.parametrize("where", ["make", "reset"])
def test_an_agent_that_is_asked_may_decline(where, protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", **{where: "raise UnknownLayout('never heard of ' + layout)"})
    assert ask_block(block(protocol, agent)) == Answer("cramped_room", declined="never heard of cramped_room")
    outcome = play_block(block(protocol, agent))
    assert "it declines (never heard of cramped_room), although" in outcome.fault


def test_other_faults_are_left_to_be_found_by_playing(protocol, tmp_path):
    for where, act in (("make", "return None"), ("reset", "raise SystemExit(3)")):
        agent = write_agent(tmp_path / "agent.py", **{where: act})
        assert ask_block(block(protocol, agent)) == Answer("cramped_room")


def test_in_a_mirrored_kitchen_an_agent_that_knows_the_plain_one_is_shown_its_image(protocol, pool_folder, tmp_path):
    refusal, mirror = "if layout != 'cramped_room': raise UnknownLayout(layout)", "cramped_room-mirrored"
    first = block(protocol, write_agent(tmp_path / "agent.py", make=refusal), layout=mirror, pool=pool_folder)
    assert ask_block(first) == Answer(mirror, adapted=True)
    assert len(play_block(replace(first, adapted=True)).episodes) == 8
    assert ask_block(block(protocol, write_agent(tmp_path / "b.py"), layout=mirror)) == Answer(mirror)
    never = write_agent(tmp_path / "c.py", make="raise UnknownLayout(layout)")
    assert ask_block(block(protocol, never, layout=mirror)) == Answer(mirror, declined="cramped_room")

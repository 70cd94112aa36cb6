"""One finder for every reference, whoever asks."""

import hashlib
import os
from dataclasses import replace

import gymnasium as gym
import numpy as np
import pytest

from overcooked_bench import UnknownLayout, load_agent, play_episodes, run_scenarios
from overcooked_bench.agents import entries
from overcooked_bench.agents.catalogue import find, find_unchanged
from overcooked_bench.agents.kinds import KINDS
from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.scripted import SCRIPTED, Scripted
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.baselines.learning.settings import Settings
from overcooked_bench.baselines.running.partners import load_partners, partner_names
from overcooked_bench.evaluation.protocol import read_protocol
from tests.agents.made import record, write_policy
from tests.evaluation.made import protocol_text, score

LAYOUT = "cramped_room"
NORTH = """
import numpy as np

class Always:
    observation = "features"
    def __init__(self, action):
        self.action = action
    def reset(self, layout, seats, seeds):
        self.rows = len(seats)
    def act(self, observations):
        return np.full(self.rows, self.action)

def make_agent(layout, training_seed):
    return Always(0)

def make_south(layout, training_seed):
    return Always(1)
"""


@pytest.fixture
def references(tmp_path, pool_folder, monkeypatch):
    """One reference of each kind, with the kind and the name for tables."""
    monkeypatch.setattr(entries, "_SHELF", replace(entries._SHELF, folder=str(tmp_path / "entries")))
    write_policy(tmp_path / "entries" / "lone" / LAYOUT / "lone-0", 7)
    write_manifest(tmp_path / "entries" / "lone", "lone", [record("lone-0")])
    (tmp_path / "north.py").write_text(NORTH)
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "agent.py").write_text(NORTH)
    policy = write_policy(tmp_path / "mine").weights
    return [
        ("greedy", "scripted", "greedy"),
        ("lone", "entry", "lone"),
        ("script:{does: onions, insist: true}", "script", "script-does-onions-insist-true"),
        ({"does": "carry"}, "script", "script-does-carry"),
        ("{does: carry, insist: true}", "script", "script-does-carry-insist-true"),
        (tmp_path / "north.py", "submission", "north"),
        (str(tmp_path / "folder"), "submission", "folder"),
        (f"{tmp_path / 'north.py'}:make_south", "function", "north-make_south"),
        (f"{tmp_path / 'folder'}:make_agent", "function", "folder"),
        (policy, "policy", None),
        (f"{pool_folder}/{LAYOUT}/sp-1", "pool agent", f"tiny-{LAYOUT}-sp-1"),
        (f"{pool_folder}/{{layout}}/sp-1", "pool agents", "tiny-sp-1"),
    ]


def test_every_kind_is_found_and_found_again_from_another_folder(references, tmp_path, monkeypatch):
    assert {kind for _, kind, _ in references} | {"behaviour"} == set(KINDS)
    for reference, kind, name in references:
        found = find(reference)
        assert (found.kind, found.name) == (kind, name or found.name)
        assert "/" not in found.name
        assert len(found.sha256) == 64
        (tmp_path / "elsewhere").mkdir(exist_ok=True)
        monkeypatch.chdir(tmp_path / "elsewhere")
        assert find(found.reference).sha256 == found.sha256
        assert find(found.reference).name == found.name
        play_episodes(LAYOUT, agents=(found.make(LAYOUT, 0), load_agent("stay", LAYOUT)), episodes=1, horizon=2)
    hashes = [find(reference).sha256 for reference, _, _ in references]
    assert len(set(hashes)) == len(hashes) - 1, "the folder's make_agent is the folder"


def test_references_are_found_relative_to_where_one_is(references, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for reference in ("north.py", "north.py:make_south", "folder", "mine.safetensors", "mine.json"):
        found = find(reference)
        assert os.path.isabs(found.reference)
    monkeypatch.chdir(tmp_path / "folder")
    assert find(".").name == "folder"


def test_a_scripted_agents_hash_is_that_of_its_own_version(monkeypatch):
    before = {name: find(name).sha256 for name in SCRIPTED}
    assert before["greedy"] == hashlib.sha256(b"scripted/greedy/1").hexdigest()
    monkeypatch.setitem(SCRIPTED, "greedy", SCRIPTED["greedy"]._replace(version=2))
    assert [name for name in SCRIPTED if find(name).sha256 != before[name]] == ["greedy"]


class West:
    """Always goes west."""

    observation = "lossless26"

    def __init__(self, layout):
        self.layout = layout

    def reset(self, layout, seats, seeds):
        self.rows = len(seats)

    def act(self, observations):
        return np.full(self.rows, 3)


def test_a_scripted_agent_is_a_class_and_a_row(monkeypatch):
    monkeypatch.setitem(SCRIPTED, "west", Scripted(West))
    assert find("west").kind == "scripted"
    assert load_agent("west", LAYOUT).layout == LAYOUT
    env = gym.make("Overcooked/CrampedRoom-v0", partner="west", seat=1)
    env.reset(seed=0)
    for _ in range(4):
        env.step(4)
    assert env.unwrapped.kitchens.state(0).chefs[0].facing == "west"
    assert run_scenarios("west", select="C04", repeats=2).agent == "west"


def test_a_pools_agents_play_their_own_layouts(pool_folder):
    found = find(f"{pool_folder}/{{layout}}/sp-1", mode="greedy")
    assert found.layout is None
    assert found.make(LAYOUT, 0).mode == "greedy"
    with pytest.raises(UnknownLayout, match="no agent 'sp-1' for 'bottleneck'"):
        found.make("bottleneck", 0)
    with pytest.raises(PoolError, match="did you mean 'sp-1'"):
        find(f"{pool_folder}/{{layout}}/sp_1")


def test_a_changed_agent_is_noticed():
    sha256 = find("script:onions").sha256
    assert find_unchanged("script:onions", sha256, "sample").make(LAYOUT, 0).observation == "state"
    with pytest.raises(AgentError, match="changed while it was being played"):
        find_unchanged("script:onions", "0" * 64, "sample")


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        ("gredy", "did you mean 'greedy'"),
        ("dev-v9/cramped_room/sp-0", "did you mean 'dev-v"),
        ("dev-v1", "is a pool, not an agent"),
        ("script:fly", "'fly' is no behaviour"),
        ({"does": "fly"}, "'fly' is no behaviour"),
        ({"does": {1, 2}}, "is no behaviour"),
        ("{does: carry", "not YAML"),
        ("x" * 300, "no agent named"),
        ("a\0b", "no agent named"),
        ("", "no agent named"),
    ],
)
def test_what_is_not_found_is_answered_with_a_guess(reference, message):
    with pytest.raises(AgentError, match=message):
        find(reference)


@pytest.mark.slow
def test_every_kind_is_scored_trained_with_and_sat_beside(references, tmp_path):
    protocol = read_protocol(protocol_text(episodes=1, horizon=5), "p.yaml")
    for number, (reference, _, _) in enumerate(references):
        scores, *_ = score(reference, protocol, output=tmp_path / f"out-{number}")
        assert scores.agent.sha256 == find(reference).sha256
        env = gym.make("Overcooked/CrampedRoom-v0", partner=reference, horizon=3)
        env.reset(seed=0)
        env.step(4)
    settings = Settings(layout=LAYOUT)
    given = [str(reference) for reference, _, _ in references if not isinstance(reference, dict)]
    assert len(load_partners(partner_names(given, settings), settings)) == len(references) - 1

"""Shipped entries: agents in a pool's format whose training runs are the training seeds of one submission."""

from dataclasses import replace

import msgspec
import pytest

from overcooked_bench import UnknownLayout, load_agent
from overcooked_bench.agents import entries
from overcooked_bench.agents.catalogue import catalogue, find
from overcooked_bench.agents.entries import load_entry
from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.cli import main
from overcooked_bench.evaluation.protocol import read_protocol
from tests.agents.made import record, write_policy
from tests.evaluation.made import protocol_text, score

LAYOUT = "cramped_room"
RING = "coordination_ring"


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    """A folder of entries instead of the shipped one: `lone` with two training runs on each of two layouts."""
    monkeypatch.setattr(entries, "_SHELF", replace(entries._SHELF, folder=str(tmp_path)))
    records = []
    for seed in range(2):
        write_policy(tmp_path / "lone" / LAYOUT / f"lone-{seed}", seed)
        write_policy(tmp_path / "lone" / RING / f"lone-{seed}", seed + 2, layout=RING, shape=(22, 5, 5))
        records += [record(f"lone-{seed}"), record(f"lone-{seed}", RING)]
    write_manifest(tmp_path / "lone", "lone", records)
    return tmp_path


def unhashed(records):
    """Entries that `write_manifest` hashes again."""
    return [msgspec.structs.replace(entry, reference=None) for entry in records]


def test_an_entry_is_one_folder_and_found_by_its_name(shelf, capsys):
    found, pool = find("lone", mode="greedy"), Pool.load(shelf / "lone")
    assert (found.reference, found.name, found.kind, found.training_seeds) == ("lone", "lone", "entry", 2)
    assert "lone" in catalogue()
    assert main(["list", "entries"]) == 0
    assert "lone  self-play, 2 training seeds on each of 2 layouts" in capsys.readouterr().out
    for layout in (LAYOUT, RING):
        for seed in range(2):
            agent = load_agent("lone", layout, seed, "greedy")
            assert (agent.mode, [one.sha256 for one in agent.policies]) == (
                "greedy",
                [pool.agent(layout, f"lone-{seed}").sha256],
            )


def test_what_an_entry_cannot_play_is_said(shelf):
    with pytest.raises(UnknownLayout, match=r"not trained on 'bottleneck'; it was on cramped_room, coordination_ring"):
        load_agent("lone", "bottleneck")
    with pytest.raises(AgentError, match="no training seed 2; its 2 runs are 0 to 1"):
        load_agent("lone", LAYOUT, 2)
    with pytest.raises(AgentError, match="did you mean 'lone'"):
        find("loan")


def test_an_entrys_hash_depends_on_every_policy(shelf):
    before = find("lone").sha256
    write_policy(shelf / "lone" / RING / "lone-1", 9, layout=RING, shape=(22, 5, 5))
    write_manifest(shelf / "lone", "lone", unhashed(load_entry("lone").pool.manifest.entries))
    assert find("lone").sha256 != before


def test_every_layout_has_as_many_training_seeds(shelf):
    kept = load_entry("lone").pool.manifest.entries[1:]
    write_manifest(shelf / "lone", "lone", unhashed(kept))
    with pytest.raises(PoolError, match="this one: cramped_room 2, coordination_ring 1"):
        find("lone")


def test_a_score_has_every_training_seed_of_an_entry(shelf, tmp_path):
    scores, *_ = score("lone", read_protocol(protocol_text(episodes=1, horizon=5), "p.yaml"), output=tmp_path / "out")
    assert (scores.agent.name, scores.training_seeds) == ("lone", 2)

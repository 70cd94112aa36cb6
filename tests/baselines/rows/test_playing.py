"""Entries of small policies, really played: what is kept is not played again, and a stop costs nothing."""

from dataclasses import replace

import msgspec
import pytest

from overcooked_bench.agents import entries
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.building.costs import RunCost, write_costs
from overcooked_bench.baselines.rows import playing
from overcooked_bench.baselines.rows.gathered import gather
from overcooked_bench.baselines.rows.playing import Games, play_entry
from overcooked_bench.baselines.rows.records import Cost
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.protocol import load_protocol, read_protocol
from tests.agents.made import record, write_policy
from tests.baselines.evidence.made import write_pools
from tests.evaluation.made import changed, protocol_text, reporting

LAYOUT = "cramped_room"


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """An entry, and the pool that it is scored with."""
    home = write_pools(tmp_path_factory.mktemp("home"))
    for seed in range(2):
        write_policy(home / "entries" / "two" / LAYOUT / f"two-{seed}", seed)
    write_manifest(home / "entries" / "two", "two", [record(f"two-{seed}") for seed in range(2)])
    write_costs(home / "entries" / "two", {f"{LAYOUT}/two-{seed}": RunCost(1800.0, 10, 3) for seed in range(2)})
    return home


@pytest.fixture
def games(home, monkeypatch):
    monkeypatch.setattr(entries, "_SHELF", replace(entries._SHELF, folder=str(home / "entries")))
    pool = Pool.load(home / "tiny")
    text = protocol_text(pool=pool.folder, pool_sha256=pool.hash, self_play="true", object_probability=0)
    rules = read_protocol(text, "tiny.yaml")
    rules = reporting(rules, metrics=("n", "h50", "mean", "self_play", "worst_third"), headlines=("n", "h50"))
    criterion = msgspec.structs.replace(changed(rules, salt="salt"), name="people")
    thesis = changed(load_protocol("thesis"), layouts=(LAYOUT,), episodes=1)
    return Games(rules, reporting(criterion, headlines=()), thesis, "dev-v1", horizon=40)


@pytest.mark.slow
def test_a_stopped_command_goes_on_and_finds_the_same_numbers(games, tmp_path, monkeypatch):
    def stop(*arguments, **others):
        raise KeyboardInterrupt

    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    greedy, two = (play_entry(name, games, whole) for name in ("greedy", "two"))
    with monkeypatch.context() as stopping:
        stopping.setattr(playing, "ordered_cross_play", stop)
        with pytest.raises(KeyboardInterrupt):
            play_entry("two", games, stopped)
    again = play_entry("two", games, stopped)
    found = gather([two, greedy], games, "greedy")
    assert gather([again, greedy], games, "greedy") == found
    for name in ("score", "cross_play", "ordered_cross_play"):
        monkeypatch.setattr(playing, name, stop)
    kept = [play_entry(name, games, whole) for name in ("two", "greedy")]  # nothing is played again
    assert gather(kept, games, "greedy") == found

    by_name = {one.name: one for one in found.entries}
    mine, reference = by_name["two"], by_name["greedy"]
    assert (len(mine.by_seed), len(reference.by_seed)) == (2, 1)
    assert sum(mine.by_seed) / 2 == pytest.approx(mine.n.value)
    assert list(mine.strata) == ["human", "own"]
    assert mine.home is not None
    assert reference.home is None
    assert mine.criterion is not None
    assert mine.layouts[0].seeds is not None
    assert reference.layouts[0].seeds is None
    assert (mine.thesis.rows, reference.thesis.rows) == (2, 1)
    assert reference.thesis.average > mine.thesis.average
    assert (mine.cost, reference.cost) == (Cost(1.0, 20, 2, 6), None)
    assert mine.attempted > 0


@pytest.mark.slow
def test_a_score_of_other_weights_is_no_finished_one(games, home, tmp_path, monkeypatch):
    kept = replace(games, criterion=None)
    monkeypatch.setattr(playing, "_seeds", lambda *given: None)
    monkeypatch.setattr(playing, "_ordered", lambda *given: None)
    before = play_entry("two", kept, tmp_path).scores
    assert play_entry("two", kept, tmp_path).scores == before
    stem = home / "entries" / "two" / LAYOUT / "two-0"
    weights = stem.with_suffix(".safetensors").read_bytes()
    try:
        write_policy(stem, 99)
        write_manifest(home / "entries" / "two", "two", [record(f"two-{seed}") for seed in range(2)])
        with pytest.raises(WrongUse, match="agent"):
            play_entry("two", kept, tmp_path)
    finally:
        stem.with_suffix(".safetensors").write_bytes(weights)
        write_manifest(home / "entries" / "two", "two", [record(f"two-{seed}") for seed in range(2)])

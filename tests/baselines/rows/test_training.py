"""A recipe's entries: what is trained in which order, and which training seeds ship."""

import json

import pytest

from overcooked_bench.agents.entries import load_entry
from overcooked_bench.agents.pools.manifest import policies, read_manifest
from overcooked_bench.baselines import train_rows
from overcooked_bench.baselines.building.build import PoolBuildError, missing, publish, train_run
from overcooked_bench.baselines.building.costs import CostError, RunCost, read_costs, write_costs
from overcooked_bench.baselines.rows.recipe import RecipeError, in_turn, load_recipe
from overcooked_bench.baselines.rows.shipping import ship, take_over, whole_seeds
from tests.baselines.pools import group

ROOMS = ["cramped_room", "forced_coordination"]


def write_recipe(folder, *rows, layouts=ROOMS):
    file = folder / "tiny.yaml"
    file.write_text(json.dumps({"layouts": layouts, "rows": list(rows)}))
    return file


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """A recipe whose runs are all trained, in this process: the file, and the folder of the runs."""
    home = tmp_path_factory.mktemp("trained")
    file = write_recipe(home, group("one", count=2), group("two", count=1), layouts=ROOMS[:1])
    for run in in_turn(load_recipe(file)):
        assert train_run(run, home / "runs" / run.path)
    return file, home / "runs"


def test_one_training_seed_of_each_entry_comes_after_the_other(tmp_path):
    runs = in_turn(load_recipe(write_recipe(tmp_path, group("one", count=2), group("two", count=2))))
    names = [f"{run.name} {run.layout}" for run in runs]
    assert names[:4] == [f"{name} {room}" for name in ("one-0", "two-0") for room in ROOMS]
    assert len(names) == 8
    assert len({run.seed for run in runs}) == len({run.lineage for run in runs}) == 8
    assert runs[0].lineage == "entries-one/cramped_room/one-0"


@pytest.mark.slow
def test_finished_seeds_ship_with_what_they_cost(trained, tmp_path, capsys):
    file, runs = trained
    given = [str(file), "--runs", str(runs), "--output", str(tmp_path)]
    assert train_rows.main([*given, "--seeds", "1"]) == 0
    assert [len(policies(read_manifest(tmp_path / name))) for name in ("one", "two")] == [1, 1]
    assert f"{tmp_path / 'one'}: 1 of 2 training seeds" in capsys.readouterr().out
    first = (tmp_path / "one" / ROOMS[0] / "one-0.safetensors").read_bytes()
    assert train_rows.main(given) == 0
    assert [entry.name for entry in policies(read_manifest(tmp_path / "one"))] == ["one-0", "one-1"]
    assert (tmp_path / "one" / ROOMS[0] / "one-0.safetensors").read_bytes() == first
    costs = read_costs(tmp_path / "one")
    assert list(costs) == ["cramped_room/one-0", "cramped_room/one-1"]
    assert costs["cramped_room/one-0"].joint_steps == 320
    assert costs["cramped_room/one-0"].partner_runs == 0
    assert train_rows.main([*given, "--rows", "three"]) == 2
    assert "no row 'three'; it has one, two" in capsys.readouterr().err


@pytest.mark.slow
def test_what_ships_is_taken_over_and_not_trained_again(trained, tmp_path):
    file, runs = trained
    entries = load_recipe(file)
    assert train_rows.train(entries, runs, tmp_path / "entries", 1).well
    before = (tmp_path / "entries" / "one" / "costs.json").read_bytes()
    again = train_rows.train(entries, tmp_path / "elsewhere", tmp_path / "entries", 1)
    assert again.finished == []
    assert (tmp_path / "entries" / "one" / "costs.json").read_bytes() == before
    assert not (tmp_path / "elsewhere" / ROOMS[0]).exists()
    with pytest.raises(PoolBuildError, match="has 2 training seeds, and 0 are finished"):
        ship(entries[0], tmp_path / "elsewhere", tmp_path / "nothing", tmp_path / "entries" / "one")


@pytest.mark.slow
def test_a_seed_that_is_missing_on_a_layout_holds_back_those_after_it(tmp_path):
    (entry,) = load_recipe(write_recipe(tmp_path, group("one", count=2)))
    *most, last = in_turn([entry])
    for run in (most[0], most[2], last):  # the first seed is missing on the second layout
        assert train_run(run, tmp_path / "runs" / run.path)
        publish(run, tmp_path / "runs" / run.path, tmp_path / "pool")
    assert whole_seeds(entry, tmp_path / "pool") == 0
    assert ship(entry, tmp_path / "runs", tmp_path / "pool", tmp_path / "entry") == 0
    assert not (tmp_path / "entry").exists()
    assert train_run(most[1], tmp_path / "runs" / most[1].path)
    publish(most[1], tmp_path / "runs" / most[1].path, tmp_path / "pool")
    assert ship(entry, tmp_path / "runs", tmp_path / "pool", tmp_path / "entry") == 2


def test_mistakes_in_a_recipe_are_named(tmp_path):
    with pytest.raises(RecipeError, match="each prefix once"):
        load_recipe(write_recipe(tmp_path, group("one"), group("one")))
    with pytest.raises(RecipeError, match="choose among"):
        load_recipe(write_recipe(tmp_path, group("one"), layouts=["nowhere"]))
    with pytest.raises(RecipeError, match="no recipe named 'none'"):
        load_recipe("none")


def test_the_shipped_recipe_goes_on_from_the_entries_that_ship(tmp_path):
    entries = {entry.name: entry for entry in load_recipe("v1")}
    assert {"self-play", "state-augmented"} <= entries.keys()
    runs = in_turn([*entries.values()])
    assert len({run.seed for run in runs}) == len(runs)
    known = entries["best-response-train-v1"]
    shipped = load_entry(known.name).pool.folder
    take_over(known, shipped, tmp_path)
    left = missing(known, tmp_path)
    assert {run.index for run in left}.isdisjoint(range(whole_seeds(known, shipped)))


def test_costs_are_read_as_they_were_written(tmp_path):
    assert read_costs(tmp_path) == {}
    costs = {"room/b-0": RunCost(1.5, 10, 0), "room/a-0": RunCost(2.5, 20, 3)}
    write_costs(tmp_path, costs)
    assert read_costs(tmp_path) == costs
    assert list(read_costs(tmp_path)) == sorted(costs)
    (tmp_path / "costs.json").write_text('{"a": {}}')
    with pytest.raises(CostError, match=r"costs\.json"):
        read_costs(tmp_path)

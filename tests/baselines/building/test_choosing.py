"""Builds of a small pool with quotas: real training of a few hundred steps, real games."""

import json
import shutil

import pytest
from msgspec.structs import replace

from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.building import choosing, command, ledger
from overcooked_bench.baselines.building.build import publish, train_run
from overcooked_bench.baselines.building.choosing import Effort
from overcooked_bench.baselines.building.command import main
from overcooked_bench.baselines.building.queue import Result
from overcooked_bench.evaluation.pools.bounds import Plan
from tests.baselines.pools import group, write_config

LAYOUT = "cramped_room"
FEW = Plan(tried=1, finalists=1, chosen_by=1, measured=4)
HALF = {"keep": ["half"], "snapshots": [0.4]}
"""What is half trained may reach nothing with itself."""


def quota_config(folder, **others):
    return write_config(
        folder,
        group("a", quota="half", stratum="own", count=2, **HALF),
        group("b", quota="other", stratum="own", first=10, **HALF),
        scripted=[{"name": "greedy", "quota": "script"}, {"name": "stay", "role": "floor"}],
        **{"quotas": {"half": 1, "other": 1, "script": 1}, **others},
    )


@pytest.fixture(autouse=True)
def small(monkeypatch):
    """Few episodes, and runs that are trained in this process."""

    def build(wanted, home, target, workers, display):
        for run in wanted:
            assert train_run(run, home / run.path)
            publish(run, home / run.path, target)
        return Result(finished=[run.path for run in wanted])

    monkeypatch.setattr(command, "EFFORT", Effort(rough=FEW, final=FEW, met=1, seen=1))
    monkeypatch.setattr(command, "build", build)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """The folder of the runs, all finished, by the first build that needs them."""
    return tmp_path_factory.mktemp("trained") / "runs"


@pytest.fixture
def build(trained, tmp_path, capsys):
    """Builds in a copy of the finished runs."""
    runs = tmp_path / "runs"
    if trained.exists():
        shutil.copytree(trained, runs)

    def run(**others):
        code = main(str(quota_config(tmp_path, **others)), runs=str(runs), output=str(tmp_path / "pool"))
        if not trained.exists():
            shutil.copytree(runs, trained)
        return code, capsys.readouterr()

    return run


def test_a_pool_is_chosen_among_candidates_and_measured(build, tmp_path, monkeypatch):
    code, told = build()
    assert (code, told.err) == (0, "")
    assert told.out.endswith(f"{tmp_path / 'pool'}: complete\n")
    candidates = Pool.load(tmp_path / "runs" / "candidates")
    assert (candidates.name, len(candidates.manifest.entries)) == ("tiny-candidates", 3)
    pool = Pool.load(tmp_path / "pool")
    entries = {entry.name: entry for entry in pool.partners(LAYOUT)}
    assert not pool.frozen
    assert {*entries} in ({"a-0", "b-0", "greedy", "stay"}, {"a-1", "b-0", "greedy", "stay"})
    partners = {name: entry for name, entry in entries.items() if name != "stay"}
    assert (entries["stay"].bounds, entries["stay"].weight) == (None, None)
    assert {name: entry.stratum for name, entry in partners.items()}["greedy"] == "scripted"
    assert sum(entry.weight for entry in partners.values() if entry.stratum == "own") == pytest.approx(1, abs=1e-5)
    assert partners["greedy"].weight == 1
    hashes = {entry.sha256 for entry in partners.values()}
    for entry in partners.values():
        (bound,) = entry.bounds
        assert bound.ceiling - bound.floor >= 40
        assert bound.responder_sha256 in hashes or "/" not in bound.responder
    assert partners["greedy"].convention
    assert sorted(file.stem for file in (tmp_path / "pool").rglob("*.safetensors")) == sorted({*partners} - {"greedy"})

    monkeypatch.setattr(ledger, "play_pairs", lambda *_, **__: pytest.fail("played again"))
    monkeypatch.setattr(choosing, "conventions", lambda *_, **__: pytest.fail("played again"))
    before = (tmp_path / "pool" / "manifest.json").read_bytes()
    shutil.rmtree(tmp_path / "pool")
    assert build()[0] == 0
    assert (tmp_path / "pool" / "manifest.json").read_bytes() == before
    shutil.rmtree(tmp_path / "runs")
    assert build()[1].out.endswith("complete\n"), "a finished pool needs no runs"
    assert not (tmp_path / "runs").exists()


def test_an_interrupted_build_goes_on_to_the_same_pool(build, tmp_path, monkeypatch):
    assert build()[0] == 0
    whole = (tmp_path / "pool" / "manifest.json").read_bytes()
    shutil.rmtree(tmp_path / "pool")
    shutil.rmtree(tmp_path / "runs" / "measured")
    played = []

    def interrupted(*arguments, **others):
        if len(played) == 3:
            raise KeyboardInterrupt
        played.append(play(*arguments, **others))
        return played[-1]

    play = ledger.play_pairs
    with monkeypatch.context() as patch:
        patch.setattr(ledger, "play_pairs", interrupted)
        with pytest.raises(KeyboardInterrupt):
            build()
    assert not (tmp_path / "pool").exists()
    assert len(json.loads((tmp_path / "runs" / "measured" / f"{LAYOUT}.json").read_bytes())) > 0
    assert build()[0] == 0
    assert (tmp_path / "pool" / "manifest.json").read_bytes() == whole


def test_a_partner_with_whom_too_little_can_be_reached_is_replaced(build, tmp_path, monkeypatch):
    """Two candidates turn out to be weak: one has a substitute, for the other one a further seed is trained."""
    measure = choosing.measure_bounds

    def narrow(layout, partners, responders, **others):
        found = measure(layout, partners, responders, **others)
        weak = {"a-0", "b-0"} if others["plan"] == command.EFFORT.final else set()
        return [
            tuple(replace(bound, floor=bound.ceiling - 39) for bound in bounds) if player.entry.name in weak else bounds
            for player, bounds in zip(partners, found, strict=True)
        ]

    monkeypatch.setattr(choosing, "measure_bounds", narrow)
    code, told = build()
    assert (code, told.err) == (0, "")
    assert f"{LAYOUT} b-0: left out, too little can be reached with it" in told.out
    names = {entry.name for entry in read_manifest(tmp_path / "pool").entries}
    assert names == {"a-1", "b-1", "greedy", "stay"}


def test_a_quota_that_cannot_be_met_is_one_message(build, tmp_path):
    code, told = build(quotas={"half": 1, "other": 1, "script": 2})
    assert code == 2
    assert "1 candidates are fit for the quota 'script', which is 2" in told.err
    assert not (tmp_path / "pool").exists()


def test_a_frozen_pool_is_not_replaced(build, tmp_path):
    assert build()[0] == 0
    file = tmp_path / "pool" / "manifest.json"
    file.write_text(file.read_text().replace(',\n  "frozen": false', ""))
    assert build()[0] == 0, "the same partners"
    code, told = build(quotas={"half": 2, "other": 1, "script": 1})
    assert code == 2
    assert "is frozen, and other partners were chosen now" in told.err

"""Proxies of made-up people of both sets, held against them: every table, the gates, and what the command keeps."""

import msgspec
import numpy as np
import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.building.build import publish, train_run
from overcooked_bench.baselines.by_hand import KEPT
from overcooked_bench.baselines.cloning.likelihood import Foretold
from overcooked_bench.baselines.human_report import main, read_tries
from overcooked_bench.baselines.likeness.crowds import Length
from overcooked_bench.baselines.likeness.foretold import CLONES, FREQUENCIES, nats
from overcooked_bench.baselines.likeness.likeness import EACH_OTHER, Gate, gates, likenesses
from overcooked_bench.baselines.likeness.proxies import both_stages, proxies_of
from overcooked_bench.baselines.likeness.tables import tries_table, verdict
from overcooked_bench.human.games import read_games, write_games
from overcooked_bench.human.people import SETS
from tests.baselines.pools import pool_config
from tests.baselines.tiny import MADE

SMALL = {"steps": 400, "num_kitchens": 4, "rollout": 50, "horizon": 50, "minibatches": 4, "epochs": 1, "hidden": [16]}
SHORT = Length(2, 60)
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A games file of three pairs of each set, and a pool for each set: two proxies of A, one of B, in both stages."""
    folder = tmp_path_factory.mktemp("proxies")
    names = [*SETS["A"][:3], *SETS["B"][:3]]
    games = [msgspec.structs.replace(game, group=name) for game, name in zip(read_games(MADE), names, strict=True)]
    file = folder / "people.games.jsonl"
    write_games(file, games)
    for pairs, count in (("A", 2), ("B", 1)):
        given = {**SMALL, "pairs": pairs, "games": str(file), "clone_epochs": 2}
        group = {"prefix": "x", "method": "human-proxy", "count": count, "keep": ["final", "clone"], "overrides": given}
        for run in pool_config(folder, group, namespace=f"made {pairs}").runs():
            assert train_run(run, folder / "runs" / pairs / run.name)
            publish(run, folder / "runs" / pairs / run.name, folder / pairs)
    return folder, file


@pytest.fixture(scope="module")
def written(made):
    folder, file = made
    tried = folder / "sweep" / "A-cramped_room-0.5"
    tried.mkdir(parents=True)
    (tried / "found.json").write_bytes(msgspec.json.encode(one_try("A", 0.5, 0.01, 5)))
    arguments = ["--games", str(file), "--pools", str(folder / "A"), str(folder / "B"), "--output", str(folder / "out")]
    arguments += ["--episodes", "2", "--horizon", "60"]
    assert main([*arguments, "--sweep", str(folder / "sweep")]) == 0
    return folder / "out", arguments


def one_try(pairs, coefficient, cost, soups):
    return {
        "pairs": pairs,
        "layout": "cramped_room",
        "coefficient": coefficient,
        "clone": {"nats": 1.0, "soups": 1.0, "idle": 0.5},
        "regularised": {"nats": 1.0 + cost, "soups": float(soups), "idle": 0.4},
        "people": {"soups": 5.0, "idle": 0.5},
    }


def test_the_report_has_every_table_and_small_pictures(written):
    output, _ = written
    text = (output / "human.md").read_text()
    for words in ("gates are passed", "## Gates", "Proxies of set A:", "Proxies of set B:", "regularised, each other"):
        assert words in text
    assert text.count("| self-play agents") == 4
    for name in ("human-soups.png", "human-visits.png"):
        assert f"]({name})" in text
        assert (output / name).stat().st_size < 100_000


def test_what_is_written_by_hand_and_the_tries_stay(written):
    output, arguments = written
    first = (output / "human.md").read_text()
    (output / "human.md").write_text(f"old numbers\n{KEPT}\n\nMine.\n")
    assert main(arguments) == 0
    assert (output / "human.md").read_text() == first[: first.index(KEPT)] + f"{KEPT}\n\nMine.\n"


def test_a_proxy_is_held_against_people_whom_it_does_not_know(made):
    folder, file = made
    proxies = [
        proxy for pairs in SETS for proxy in proxies_of(Pool.load(folder / pairs), "cramped_room", digest(folder))
    ]
    assert [proxy.pairs + proxy.stage[0] for proxy in proxies] == ["Ar", "Ac", "Ar", "Ac", "Br", "Bc"]
    assert len(both_stages(proxies)) == 3
    one, other = likenesses(read_games(file), "cramped_room", proxies, SHORT)
    assert (len(one.crowds[EACH_OTHER].each), EACH_OTHER in other.crowds) == (2, False)
    for found in (one, other):
        told = found.foretelling
        assert all(set(judged) <= {*SETS["A"], *SETS["B"]} - {*SETS[found.pairs]} for judged in told.others[CLONES])
        clones = [proxy for proxy in found.proxies if proxy.stage == "clone"]
        for proxy, judged in zip(clones, told.held_out[CLONES], strict=True):
            assert set(judged) == set(proxy.held_out)
        assert {*told.others} == {*told.held_out}
        assert nats(told.others["uniform"]).value == pytest.approx(np.log(6))
        by_name = {gate.name: gate for gate in gates(found)}
        less = nats(told.others[CLONES]).value - nats(told.others[FREQUENCIES]).value
        assert np.mean(by_name["clones: nats"].values) == pytest.approx(less)
        assert not by_name["regularised: soups"].passed  # nobody delivers anything here
    assert "\n- regularised: soups on cramped_room, set A" in verdict([one, other])


def digest(folder):
    return Pool.load(folder / "A").agents("cramped_room")[0].trained.settings["games_sha256"]


def test_a_pool_of_other_games_is_refused(made, capsys):
    folder, _ = made
    other = folder / "other.games.jsonl"
    other.write_bytes((folder / "people.games.jsonl").read_bytes() + b"\n")
    assert main(["--games", str(other), "--pools", str(folder / "A"), "--output", str(folder / "none")]) == 2
    assert "give the file that the pool was built from" in capsys.readouterr().err
    assert main(["--games", str(other), "--pools", "dev-v1", "--output", str(folder / "none")]) == 2
    assert "no human proxy in dev-v1" in capsys.readouterr().err
    assert not (folder / "none").exists()


def test_means_over_pairs_weigh_guessers_and_pairs_alike():
    guessers = [{"x": Foretold(1.0, 0.5), "y": Foretold(2.0, 0.5)}, {"x": Foretold(3.0, 0.5)}]
    found = nats(guessers)
    assert (found.value, found.interval is None) == (2.0, False)
    assert nats(guessers[1:]).interval is None


def test_a_gate_bounds_the_mean_and_counts_the_values():
    gate = Gate("soups", (70.0, 130.0), 80, 120, "{:.0f} %")
    assert (gate.passed, gate.within) == (True, 0)
    assert not gate._replace(values=(float("nan"),)).passed


def test_the_rule_chooses_among_the_tries(tmp_path):
    tries = [one_try("A", 1.0, 0.0, 4), one_try("A", 0.5, 0.01, 5), one_try("A", 0.2, 0.1, 9)]
    rows = tries_table(tries, []).rows
    assert [(row[2], row[6], row[7]) for row in rows] == [("1", "yes", ""), ("0.5", "yes", "chosen"), ("0.2", "no", "")]
    assert read_tries(None, tmp_path) == []

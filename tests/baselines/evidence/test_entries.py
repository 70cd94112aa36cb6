"""Entries and the oracle, scored from made-up episodes."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.evidence.entrants import partners_of
from overcooked_bench.baselines.evidence.entries import score_entries
from overcooked_bench.baselines.evidence.played import PlayedPairs
from overcooked_bench.evaluation.pools.players import Player
from tests.baselines.evidence.made import BOUND, EPISODES, LAYOUT, pretend, write_pools


def answered_by(player, responder):
    bound = msgspec.structs.replace(BOUND, responder_sha256=responder)
    return replace(player, entry=msgspec.structs.replace(player.entry, bounds=(bound,)))


@pytest.fixture
def home(tmp_path):
    home = write_pools(tmp_path)
    pretend([Pool.load(home / name) for name in ("tiny", "twin", "others")], home / "played")
    return home


def scored(home, responder, twin=True):
    partners = [
        [answered_by(p, responder) for p in partners_of(Pool.load(home / name), LAYOUT)] for name in ("tiny", "twin")
    ]
    pool, second = partners[0], partners[1] if twin else []
    others, played = Pool.load(home / "others"), PlayedPairs(home / "played", EPISODES)
    return {one.name: one for one in score_entries(LAYOUT, {"tried": others}, (pool, second), [others], played)}


def test_the_oracle_scores_as_the_best_known_responder_of_each_partner(home):
    found = scored(home, Player.scripted("greedy", LAYOUT).sha256)
    assert found["oracle"].pool == pytest.approx(found["greedy"].pool)  # it is the best known one of all, here
    assert found["oracle"].twin == pytest.approx(found["greedy"].twin)
    assert "oracle" not in scored(home, "0" * 64)


def test_an_entry_scores_the_mean_of_its_runs_and_needs_no_twin(home):
    found = scored(home, "0" * 64, twin=False)
    kept = np.load(home / "played" / f"{LAYOUT}-{EPISODES}-episodes-seed-0-horizon-400.npz")
    mean = dict(zip(kept["pairs"].tolist(), kept["returns"].mean(axis=(1, 2)).tolist(), strict=True))
    runs, pool = Pool.load(home / "others").agents(LAYOUT), Pool.load(home / "tiny").agents(LAYOUT)
    share = {"sp-0": 0.3, "sp-1": 0.2, "person-0": 0.5}
    expected = np.mean([sum(share[p.name] * (mean[f"{r.sha256} {p.sha256}"] - 20) / 200 for p in pool) for r in runs])
    assert (found["tried"].runs, found["tried"].twin) == (len(runs), None)
    assert found["tried"].pool == pytest.approx(expected)

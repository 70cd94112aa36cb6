"""The oracle: who knows its partner reaches the ceilings, up to noise."""

import json

import msgspec
import pytest

from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.cli import main
from overcooked_bench.evaluation.pools.oracle import oracle_score, play_oracle
from overcooked_bench.evaluation.pools.players import Player, players_of
from tests.agents.made import scripted

LAYOUT = "forced_coordination"
SP_0 = Pool.load("dev-v0").agent(LAYOUT, "sp-0")


def bound(side, responder, ceiling, sha256=None):
    found = {player.reference: player.sha256 for player in players_of(Pool.load("dev-v0"), LAYOUT)}
    found["stay"] = Player.scripted("stay", LAYOUT).sha256
    return Bound(
        **{"side": side, "floor": 0.0, "floor_agent": "stay", "ceiling": ceiling, "low": ceiling, "high": ceiling},
        **{"episodes": 100, "responder": responder, "responder_sha256": sha256 or found[responder]},
    )


def write(folder, bounds, **others):
    """A pool of `greedy`, and of the floor `random`."""
    greedy = msgspec.structs.replace(scripted("greedy", LAYOUT), bounds=bounds, **others)
    write_manifest(folder, "bounded", [greedy, scripted("random", LAYOUT, role="floor")])
    return Pool.load(folder)


def test_each_side_has_its_responder_and_its_share(tmp_path):
    pool = write(tmp_path, (bound(0, f"dev-v0/{LAYOUT}/sp-0", 50.0), bound(1, "stay", 40.0)))
    rows = play_oracle(pool, LAYOUT, episodes=4)
    assert [(row.partner, row.bound.side, row.weight) for row in rows] == [("greedy", 0, 0.5), ("greedy", 1, 0.5)]
    assert rows[0].reached.value > 0
    assert rows[1].reached.value == 0
    assert oracle_score(rows).value == pytest.approx(rows[0].reached.value / 50 / 2)


def test_what_cannot_be_played_is_said(tmp_path):
    with pytest.raises(PoolError, match=r"the bounds of forced_coordination/greedy have not been measured"):
        play_oracle(write(tmp_path, None), LAYOUT)
    with pytest.raises(PoolError, match="not the agent that the bound was measured with"):
        play_oracle(write(tmp_path, (bound(0, "stay", 40.0, "0" * 64),)), LAYOUT)
    with pytest.raises(PoolError, match="no agent 'sp-9' on forced_coordination, which a bound names"):
        play_oracle(write(tmp_path, (bound(0, f"dev-v0/{LAYOUT}/sp-9", 40.0, "0" * 64),)), LAYOUT)


def test_the_command_prints_a_line_per_layout_and_json(tmp_path, capsys):
    write(tmp_path, (bound(0, "stay", 40.0),))
    assert main(["pool", "oracle", str(tmp_path), "--episodes", "2", "--workers", "1"]) == 0
    assert f"{LAYOUT}  0.000" in capsys.readouterr().out
    assert main(["pool", "oracle", str(tmp_path), "--episodes", "2", "--workers", "1", "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)[LAYOUT]["partners"]
    assert (row["partner"], row["responder"], row["weight"]) == ("greedy", "stay", 1.0)

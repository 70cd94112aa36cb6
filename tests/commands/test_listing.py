import json

import pytest

from overcooked_bench.agents.catalogue import catalogue, find
from overcooked_bench.agents.pools.pool import shipped_pools
from overcooked_bench.baselines.methods import METHODS
from overcooked_bench.baselines.presets import load_config
from overcooked_bench.cli import main
from overcooked_bench.commands.listing import KINDS
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS


def test_everything_that_has_a_name_is_listed(capsys):
    assert main(["list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found) == set(KINDS)
    assert found["layouts"] == list(layout_names())
    assert sorted(found["agents"]) == sorted(catalogue())
    assert (found["pools"], found["methods"]) == (list(shipped_pools()), list(METHODS))
    assert found["observations"] == list(OBSERVATIONS)
    for one in found["configurations"]:
        method, _, name = one.partition(":")
        assert method == "pool" or load_config(method, name, layout="cramped_room")
    assert len(found["scenarios"]) == len(set(found["scenarios"])) >= 50


def test_agents_are_grouped_by_pool_and_each_line_says_what_it_is(capsys):
    assert main(["list", "agents"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    assert head == f"agents ({len(catalogue())})"
    assert len(lines) < len(catalogue()) / 5
    assert all(len(line.split("  ")) >= 3 for line in lines)
    assert "dev-v0/{layout}/sp-0 ... sp-3" in " ".join(lines)
    assert "self-play, 4 on each of 5 layouts" in " ".join(lines)
    assert find("greedy").name in " ".join(lines)


@pytest.mark.parametrize("kind", KINDS)
def test_one_kind_alone_can_be_listed(kind, capsys):
    assert main(["list", kind]) == 0
    assert capsys.readouterr().out.startswith(f"{kind} (")

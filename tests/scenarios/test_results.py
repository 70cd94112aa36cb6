import json

import pytest

from overcooked_bench.estimate import wilson
from overcooked_bench.scenarios.items import items
from overcooked_bench.scenarios.results import SuiteResult
from overcooked_bench.scenarios.runner import run_items
from tests.scenarios.players import Player, knows
from tests.scenarios.writing import POT, YIELD, scenario

WILSON = [(20, 20, 0.84, 1.0), (19, 20, 0.76, 0.99), (16, 20, 0.58, 0.92), (49, 50, 0.90, 1.0), (0, 20, 0.0, 0.16)]


@pytest.mark.parametrize(("passed", "n", "low", "high"), WILSON)
def test_wilson_intervals(passed, n, low, high):
    rate = wilson(passed, n)
    assert (rate.value, round(rate.low, 2), round(rate.high, 2)) == (passed / n, low, high)


def test_nothing_tells_nothing():
    assert tuple(wilson(0, 0)) == (0.0, 0.0, 1.0)


@pytest.fixture(scope="module")
def result():
    """T02 passed, T05 failed: one family; T01 not attempted."""
    others = scenario(POT, id="T05-far", family="T02", accept="A.serve >= 1")
    chosen = items([scenario(POT), others, scenario(YIELD)])
    played = run_items(knows("cramped_room", make=Player), chosen)
    return SuiteResult("mine", "greedy", 20, 0, 0, False, tuple(played))


def test_families_count_once_each(result):
    assert (result.n, result.passed) == (12, 4)
    total = result.total
    assert (total.n, total.passed, total.not_attempted, total.adapted, total.families) == (12, 4, 4, 4, 2)
    assert total.score.value == 0.25
    assert total.score == wilson(0.5, 2)
    assert total.mean_rate == 0.25
    assert {name: tally.score.value for name, tally in result.by_family.items()} == {"T01": 0.0, "T02": 0.5}
    assert {name: (tally.passed, tally.n) for name, tally in result.by_category.items()} == {
        "state": (4, 8),
        "convention": (0, 4),
    }


def test_json_holds_everything(result):
    told = json.loads(json.dumps(result.to_dict()))
    assert (told["schema"], told["agent"], told["mode"], told["n"], told["passed"]) == (1, "mine", "greedy", 12, 4)
    assert [entry["status"] for entry in told["items"]] == ["not attempted"] * 4 + ["passed"] * 4 + ["failed"] * 4
    missing, passed, failed = told["items"][0], told["items"][5], told["items"][8]
    assert (missing["reason"], missing["runs"], missing["failure"]) == ("never seen coordination_ring", 0, None)
    assert (passed["id"], passed["adapted"], passed["rate"]) == ("T02-pot-seat0-mirrored", True, 1.0)
    assert failed["failure"]["situation"] == "T05-far-seat0"
    assert told["by_category"]["state"]["score"]["value"] == 0.5


def test_an_item_is_found_by_its_id(result):
    assert result.result("T02-pot-seat1").passed
    with pytest.raises(KeyError, match="T99"):
        result.result("T99")

from overcooked_bench.kitchen.state import Chef
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.results import ItemResult, faulty
from overcooked_bench.scenarios.solving.fuzzing import search_failure
from overcooked_bench.scenarios.solving.solver import solve
from tests.scenarios.writing import POT, YIELD, scenario

SPREAD = scenario(POT.replace("  X  BX", "  o  BX"), id="T02-spread")
MOST = 12


def verdict(item, passed):
    return ItemResult(item, "passed" if passed else "failed", 1, int(passed), True, False, 9, None)


def searched(fails, scenarios=(SPREAD,), most=MOST):
    """Looks for kitchens in which `fails(situation)`; gives what was found, and all that was played."""
    played = []

    def play(items):
        (item,) = items
        played.append(item.situations[0])
        return [verdict(item, not fails(item.situations[0]))]

    return search_failure(scenarios, play, most), played


def test_what_is_played_can_be_solved_and_not_by_doing_nothing():
    found, played = searched(lambda situation: False, (scenario(YIELD), SPREAD))
    assert found == (len(played), None)
    assert MOST <= found.tried <= MOST + 1
    assert {situation.layout.name for situation in played} == {"coordination_ring", "cramped_room"}
    for situation in played:
        budget = situation.scenario.budget
        assert solve(situation, budget) is not None
        assert not judge(situation, budget, []).passed
        drawn = scenario(YIELD) if situation.layout.name == "coordination_ring" else SPREAD
        assert situation.state.chefs[situation.partner_seat] == drawn.state.chefs[1], "B is as it was drawn"


def test_a_failure_is_shrunk_and_found_again():
    def fails(situation):
        return situation.state.chefs[situation.seat].holding == "dish"

    found, _ = searched(fails)
    smallest = found.failure.item.situations[0]
    assert smallest.state.chefs[smallest.seat] == Chef((2, 1), "north", "dish")
    assert not smallest.state.objects, "neither clutter nor onions in the pot"
    assert smallest.seat == 0
    assert found.failure.item.id == "T02-drawn-seat0"
    again, _ = searched(fails)
    assert again.failure.item.situations[0].state == smallest.state
    assert again.tried == found.tried


def test_what_cannot_be_solved_is_not_played():
    found, played = searched(lambda situation: True, (scenario(POT, never="dist(A, B) >= 0"),), most=3)
    assert (found.tried, found.failure, played) == (0, None, [])


def test_an_item_that_cannot_be_played_to_its_end_counts_as_failed():
    found, _ = searched(lambda situation: True, most=1)
    record = faulty(found.failure.item, "act() raised KeyError").to_dict()
    assert (record["status"], record["rate"], record["runs"]) == ("failed", 0.0, 0)
    assert record["reason"] == "act() raised KeyError"

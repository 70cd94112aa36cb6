import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.pools.bounds import Plan, measure_bounds
from overcooked_bench.evaluation.pools.players import Player, players_of

PLAN = Plan(tried=1, finalists=2, chosen_by=3, measured=10)


def dev(layout, *names):
    return [player for player in players_of(Pool.load("dev-v1"), layout) if player.entry.name in names]


def test_each_side_of_a_partner_has_its_floor_and_its_best_known_responder():
    layout, told = "asymmetric_advantages", []
    greedy, stay = Player.scripted("greedy", layout), Player.scripted("stay", layout)
    found = measure_bounds(
        layout, [greedy], [stay, *dev(layout, "half-0")], plan=PLAN, on_progress=lambda *at: told.append(at)
    )
    assert told == [("try", 3, 3), ("choose", 3, 3), ("measure", 4, 4)] or told[-1][0] == "measure"
    ((left, right),) = found
    assert (left.side, right.side) == (0, 1)
    for bound in (left, right):
        assert bound.floor_agent in ("stay", "random")
        assert 100 < bound.floor < bound.low < bound.ceiling < bound.high  # greedy serves alone
        assert bound.episodes == 10
        assert bound.responder in ("greedy", f"dev-v1/{layout}/half-0")
        assert len(bound.responder_sha256) == 64
    assert left.floor != right.floor


def test_the_own_copy_is_a_responder_and_is_listed_once():
    layout = "forced_coordination"
    sp_4, sp_0 = dev(layout, "sp-4"), dev(layout, "sp-0")
    told = []
    for responders in ([*sp_0], [*sp_0, *sp_4, *sp_4]):
        told.clear()
        ((left, right),) = measure_bounds(layout, sp_4, responders, plan=PLAN, on_progress=lambda *at: told.append(at))
        assert {bound.responder for bound in (left, right)} == {f"dev-v1/{layout}/sp-4"}
        assert left.responder_sha256 == sp_4[0].sha256
        assert told[0] == ("try", 2, 2)
        assert left.ceiling == pytest.approx(198, abs=15)
        assert left.floor < 20


def test_where_the_floor_is_one_region_there_is_one_bound():
    layout = "cramped_room"
    greedy = Player.scripted("greedy", layout)
    again, ((bound,),) = (measure_bounds(layout, [greedy], [], plan=PLAN) for _ in range(2))
    assert again == [(bound,)]
    assert (bound.side, bound.episodes, bound.responder) == (0, 10, "greedy")
    ((other,),) = measure_bounds(layout, [greedy], [], seed=1, plan=PLAN)
    assert other != bound

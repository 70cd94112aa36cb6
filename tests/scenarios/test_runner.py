import re

import numpy as np
import pytest

from overcooked_bench import UnknownLayout, run_scenarios
from overcooked_bench.agents import one_game_at_a_time, sample_actions
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.scenarios.errors import ScenarioFault
from overcooked_bench.scenarios.items import items
from overcooked_bench.scenarios.runner import play_once, run_items, scenario_seed
from tests.scenarios.players import INTERACT, STAY, Player, knows, player
from tests.scenarios.writing import POT, YIELD, scenario


def four(**changes):
    return items([scenario(POT, **changes)])


def test_a_deterministic_agent_is_run_once():
    agents = []
    results = run_items(lambda *_: agents.append(Player()) or agents[-1], four(budget="150"))
    assert {tuple(agent.asked) for agent in agents} == {(4,)}
    assert [r.status for r in results] == ["passed"] * 4
    assert all(r.deterministic and r.runs == r.passes == 1 and r.failure is None for r in results)
    assert tuple(results[0].rate) == (1.0, 1.0, 1.0)
    (failed, *_) = run_items(player(0.0), four(budget="150"))
    assert (failed.status, tuple(failed.rate), failed.failure.repeat) == ("failed", (0.0, 0.0, 0.0), 0)


def test_few_decisions_do_not_show_that_an_agent_is_deterministic():
    results = run_items(player(1.0), four(), repeats=20)
    assert [(r.deterministic, r.passes, r.runs) for r in results] == [(False, 20, 20)] * 4
    assert results[0].rate.low == pytest.approx(0.8389, abs=1e-4)
    assert run_items(player(1.0), four(), repeats=50)[0].deterministic


@pytest.mark.parametrize(("chance", "status"), [(0.95, "passed"), (0.5, "failed")])
def test_others_are_run_with_many_seeds_and_pass_at_four_fifths(chance, status):
    results = run_items(player(chance), four(), repeats=50)
    assert len({scenario_seed("T02-pot", k) for k in range(50)}) == 50
    for result in results:
        assert (result.status, result.runs, result.deterministic) == (status, 50, False)
        assert abs(result.passes / 50 - chance) < 0.2
        assert result.rate.low < result.passes / 50 < result.rate.high
    assert len({r.passes for r in results}) == 1, "all seats and mirrors see the same seeds"


def test_a_run_among_others_can_be_played_alone():
    result = run_items(player(0.5), four(), repeats=20)[0]
    situation = result.item.situations[0]
    runs = [play_once(player(0.5), situation, k) for k in range(20)]
    assert [run.passed for run in runs].index(False) == result.failure.repeat
    assert sum(run.passed for run in runs) == result.passes
    mirrored = scenario(POT).seated(1, True)
    assert play_once(knows("cramped_room"), mirrored).passed
    with pytest.raises(UnknownLayout, match="never seen cramped_room-mirrored"):
        play_once(knows("elsewhere"), mirrored)


def test_the_first_failure_can_be_played_again():
    result = run_items(player(0.5), four(), repeats=20)[0]
    failure = result.failure
    assert failure.seed == scenario_seed("T02-pot", failure.repeat)
    run = failure.run()
    assert not run.passed
    assert len(run.actions) == 3
    assert "`A.pot >= 1` never held" in run.why()


def test_verdicts_do_not_depend_on_what_else_is_played():
    alone = run_items(player(0.5), four())[1]
    together = run_items(player(0.5), items([scenario(POT), scenario(YIELD), scenario(POT, id="T03", budget="9")]))
    (same,) = [r for r in together if r.item.id == alone.item.id]
    assert (same.passes, same.failure.repeat, same.failure.actions) == (
        alone.passes,
        alone.failure.repeat,
        alone.failure.actions,
    )


def test_stopping_early_changes_no_verdict():
    for chance in (0.3, 0.5, 0.97):
        whole = run_items(player(chance), four(), 20)
        early = run_items(player(chance), four(), 20, sequential=True)
        assert [r.status for r in early] == [r.status for r in whole]
        assert all(r.runs < 20 for r in early)


def test_an_agent_of_the_plain_kitchen_alone_is_adapted_to_its_mirror():
    results = run_items(knows("cramped_room"), four())
    assert [(r.item.mirrored, r.adapted, r.status) for r in results] == [
        (False, False, "passed"),
        (True, True, "passed"),
    ] * 2


def test_what_an_agent_does_not_know_is_not_attempted_and_failed():
    results = run_items(knows("coordination_ring"), four())
    assert {r.status for r in results} == {"not attempted"}
    assert all((r.runs, r.passes, r.passed) == (0, 0, False) for r in results)
    assert {r.reason for r in results} == {"never seen cramped_room", "never seen cramped_room-mirrored"}


def test_features_cannot_be_mirrored():
    class Blind(Player):
        observation = "features"

    results = run_items(knows("cramped_room", make=Blind), four())
    assert [r.status for r in results] == ["passed", "not attempted"] * 2


def test_a_layout_that_is_refused_at_the_reset_is_not_attempted():
    class Late(Player):
        def reset(self, layout, seats, seeds):
            knows("cramped_room")(layout, 0)
            super().reset(layout, seats, seeds)

    results = run_items(lambda layout, seed: Late(), four())
    assert [(r.status, r.adapted) for r in results] == [("passed", False), ("passed", True)] * 2


def test_the_views_are_the_agents_own_and_warm_up_shows_the_first_one():
    agents = []

    class Watching(Player):
        def reset(self, layout, seats, seeds):
            super().reset(layout, seats, seeds)
            self.views = []

        def act(self, observations):
            self.views.append(observations.copy())
            return np.full(len(observations), STAY)

    def make(layout, training_seed):
        agents.append(Watching())
        return agents[-1]

    run_items(make, four(before="{A: [left, stay], B: [up, stay]}"), repeats=1, warmup=2)
    agent = agents[0]
    assert agent.seats.tolist() == [0, 1]
    assert len(agent.views) == 2 + 2 + 3
    assert (agent.views[0] == agent.views[1]).all()
    assert (agent.views[1] == agent.views[2]).all()
    assert not (agent.views[2] == agent.views[3]).all()
    own = agent.views[2][:, 0]  # channel 0: where the agent itself stands
    assert [np.argwhere(view).tolist() for view in own] == [[[1, 2]], [[1, 2]]]


def test_stacked_views_hold_what_happened_before():
    class Stacked(Player):
        observation = "stack_states"

        def act(self, observations):
            moved = (observations[:, 0, 0] != observations[:, 2, 0]).any(axis=(1, 2))  # since two steps ago
            return np.where(moved, INTERACT, STAY)

    came, stayed = "{A: [left, right, up], B: [stay*3]}", "{A: [up*3], B: [stay*3]}"
    for before, status in ((came, "passed"), (stayed, "failed")):
        results = run_items(lambda *_: Stacked(), four(before=before, budget="1"))
        assert {r.status for r in results} == {status}


def test_a_pair_is_passed_with_both_halves_alone():
    easy = scenario(POT, id="T04-near", pair="T04-both")
    hard = scenario(POT, id="T04-far", pair="T04-both", accept="A.serve >= 1")
    (pair,) = items([easy, hard])
    (result,) = run_items(player(1.0), [pair])
    assert (result.status, result.passes, result.failure.situation.scenario.id) == ("failed", 0, "T04-far")
    (both,) = items([easy, scenario(POT, id="T04-far", pair="T04-both")])
    assert run_items(player(1.0), [both])[0].passed
    assert run_items(player(0.5), [both])[0].runs == 20


FAULTS = {
    "raises": (lambda self, seen: 1 / 0, r"scenarios on 'cramped_room', step 0: act\(\) raised ZeroDivisionError"),
    "shape": (lambda self, seen: [4], r"returned the shape \(1,\) for 4 rows"),
    "range": (lambda self, seen: np.full(len(seen), 6), "the action 6"),
    "exits": (lambda self, seen: exit(), "SystemExit"),
}


@pytest.mark.parametrize(("act", "message"), FAULTS.values(), ids=FAULTS.keys())
def test_a_fault_is_the_agents(act, message):
    with pytest.raises(ScenarioFault, match=message):
        run_items(lambda *_: type("Bad", (Player,), {"act": act})(), four())


def test_a_fault_of_one_game_names_its_scenario():
    class Clumsy:
        observation = "lossless26"

        def reset(self, layout, seat, seed):
            self.seat = seat

        def act(self, observation):
            return 4 if self.seat == 0 else "left"

    with pytest.raises(ScenarioFault, match=r"^T02-pot-seat1, step 0: row 2: Clumsy's act returned 'left'"):
        run_items(lambda *_: one_game_at_a_time(Clumsy), four())


def test_an_agent_that_is_none_is_refused():
    with pytest.raises(AgentError, match="has no method reset"):
        run_items(lambda *_: object(), four())
    tomatoes = POT.replace("cramped_room", "|\n  XXPXX\n  O   T\n  X   X\n  XDXSX").replace("O A O", "O A T")
    make = type("Grid", (Player,), {"observation": "lossless"})
    with pytest.raises(ScenarioFault, match="cannot be given here"):
        run_items(lambda *_: make(), items([scenario(tomatoes)]))


@pytest.mark.parametrize("wrong", [dict(repeats=0), dict(warmup=-1)], ids=["repeats", "warmup"])
def test_numbers_are_checked(wrong):
    with pytest.raises(ValueError, match="give a whole number"):
        run_items(player(), four(), **wrong)


def test_the_library_call_counts_by_category_and_family():
    result = run_scenarios("stay", ["S01", "C04"], repeats=2)
    assert (result.agent, result.mode, result.n, result.passed) == ("stay", "sample", 8, 0)
    assert list(result.by_category) == ["state", "convention"]
    assert list(result.by_family) == ["wrong-item", "yield"]
    told = result.to_dict()
    assert told["schema"] == 1
    assert re.fullmatch(r"overcooked-bench \d.*", told["package"])
    first = told["items"][0]
    assert first["id"] == "C04-yield-pot-cell-seat0"
    assert (first["shortest"], first["budget"], first["status"]) == (7, 15, "failed")
    assert len(first["failure"]["actions"]) == 15


@pytest.mark.slow
def test_shipped_frozen_agents_play_by_layout():
    own = run_scenarios("dev-v0/cramped_room/sp-0", ["S01", "P09"], repeats=20, mode="greedy")
    assert [r.status == "not attempted" for r in own.items] == [True] * 4 + [False] * 4
    assert [(r.adapted, r.deterministic) for r in own.items[4:]] == [(False, True), (True, True)] * 2
    every = find("dev-v0/{layout}/sp-0", mode="greedy").make
    room, grid = four(), items([scenario(POT.replace("cramped_room", "|\n  XXPXX\n  O   O\n  X   X\n  XDXSX"))])
    assert "not attempted" not in {r.status for r in run_items(every, room, 2)}
    assert {r.status for r in run_items(every, grid, 2)} == {"not attempted"}


def test_random_play_is_sampled_by_seed():
    class Random(Player):
        def act(self, observations):
            self.step += 1
            return sample_actions(np.full((len(self.seeds), NUM_ACTIONS), 1 / 6), self.seeds, self.step)

    results = run_items(lambda *_: Random(), four(accept="A.pot >= 1", budget="4"), repeats=40)
    passes = [r.passes for r in results]
    assert passes[0] == passes[2]
    assert all(5 < n < 35 for n in passes)


def test_a_function_of_a_file_is_named_after_a_colon(tmp_path):
    file = tmp_path / "mine.py"
    file.write_text(
        "from tests.scenarios.players import Player\ndef cook(layout, training_seed):\n    return Player()\n"
    )
    assert find(f"{file}:cook").make("cramped_room", 0).observation == Player.observation
    with pytest.raises(AgentError, match="defines no waiter"):
        find(f"{file}:waiter")

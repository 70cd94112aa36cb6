from dataclasses import replace

import numpy as np
import pytest

from overcooked_bench.scenarios.items import load_items
from overcooked_bench.scenarios.solving.lock import budget_of
from overcooked_bench.scenarios.solving.memory import unknowing
from overcooked_bench.scenarios.solving.solver import search_for, solve
from tests.scenarios.writing import scenario

MEET = """\
id: T05-meet
category: memory
layout: |
  XXXXXX
  S    O
  X X XX
  XDXPXX
kitchen: |
  XXXXXX
  S A BO
  X X XX
  XDXPXX
A: {facing: right, holds: onion}
B: {facing: left, holds: soup, does: carry, yields: true, then: [4, 1]}
before: {A: [stay], B: [stay]}
accept: A.pot >= 1
budget: 7
why: B gives way.
"""
PUSHES = {"B": "{facing: left, holds: soup, does: carry, insist: true, then: [4, 1]}"}


def frontier(ways):
    """Those of which no other one is as good in both."""
    found = []
    for one, other in sorted(ways):
        if not found or other < found[-1][1]:
            found.append((one, other))
    return found


def by_trying(first, second, budgets):
    """All that `unknowing` may find, by trying every sequence of actions."""
    searches = [search_for(situation) for situation in (first, second)]
    starts = []
    for situation, search in zip((first, second), searches, strict=True):
        row, counts = search.row(situation.state), search.no_counts()
        for joint in situation.before:
            row, _ = search.step(row, counts, joint)
        starts.append((row, counts))
    ways, seen = [], set()

    def on(worlds, t):
        key = t, worlds[0][0].tobytes(), *(counts.tobytes() for _, counts in worlds)
        if t == min(budgets) or key in seen:
            return
        seen.add(key)
        for action in range(6):
            after, over = [], []
            for situation, search, (row, counts) in zip((first, second), searches, worlds, strict=True):
                joint = [action, search.answer(row, situation.behaviour, t)]
                row, counts = search.step(row, counts, joint if situation.seat == 0 else joint[::-1])
                reached, lost = search.judge(row[None], counts[None])
                after.append((row, counts))
                over.append("lost" if lost[0] else "reached" if reached[0] else "")
            if "lost" in over:
                continue
            if np.array_equal(after[0][0], after[1][0]) and not any(over):
                on(after, t + 1)
                continue
            rest = []
            for situation, search, world, budget in zip((first, second), searches, after, budgets, strict=True):
                found = search.run(*world, situation.behaviour, t + 1, budget - t - 1)
                rest.append(None if found is None else t + 1 + len(found.actions))
            if None not in rest:
                ways.append(tuple(rest))

    on(starts, 0)
    return frontier(ways)


@pytest.mark.parametrize(
    ("seat", "budgets", "steps"), [(0, (9, 10), [(7, 10), (9, 9)]), (1, (8, 9), [])], ids=["some", "none"]
)
def test_ways_are_those_that_trying_everything_finds(seat, budgets, steps):
    pair = [scenario(MEET).seated(seat), scenario(MEET, **PUSHES).seated(seat)]
    assert [way.steps for way in unknowing(*pair, budgets)] == by_trying(*pair, budgets) == steps


def test_what_is_found_can_be_played():
    pair = [scenario(MEET).seated(0), scenario(MEET, **PUSHES).seated(0)]
    (way, *_) = unknowing(*pair, (9, 12))
    for situation, steps in zip(pair, way.steps, strict=True):
        search = search_for(situation)
        row, counts = search.row(situation.state), search.no_counts()
        for joint in situation.before:
            row, _ = search.step(row, counts, joint)
        played = []
        for t, action in enumerate(way.actions):
            played.append((action, search.answer(row, situation.behaviour, t)))
            row, counts = search.step(row, counts, played[-1])
        later = replace(situation, before=(*situation.before, *played))
        assert len(played) + solve(later, 20).steps == steps


def test_one_partner_takes_no_memory():
    same = scenario(MEET).seated(0)
    (way,) = unknowing(same, same, (20, 20))
    assert way.steps == (solve(same).steps,) * 2


def test_different_sights_are_refused():
    pair = [scenario(MEET).seated(0), scenario(MEET, A="{facing: left, holds: onion}").seated(0)]
    with pytest.raises(ValueError, match="do not look the same"):
        unknowing(*pair, (5, 5))
    with pytest.raises(ValueError, match="do not look the same"):
        unknowing(scenario(MEET).seated(0), scenario(MEET).seated(1), (5, 5))


@pytest.mark.parametrize("item", [i for i in load_items("memory")], ids=lambda item: item.id)
def test_shipped_pairs_are_close_to_what_they_may_be(item):
    """Each half alone is solved with steps to spare; four steps more in both, and no memory would be needed."""
    one, other = (s for s in item.situations if s.seat == 0)
    budgets = budget_of(one.scenario), budget_of(other.scenario)
    assert unknowing(one, other, budgets) == []
    assert unknowing(one, other, (budgets[0] + 4, budgets[1] + 4))
    assert all(solve(half).steps < budget for half, budget in zip((one, other), budgets, strict=True))

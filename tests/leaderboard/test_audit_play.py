"""What an audit plays again and flags: how many cells, how they are compared elsewhere, and what is unusual."""

import dataclasses
from math import ceil

import msgspec
import numpy as np
import pytest

from overcooked_bench.evaluation.cells import SideBound
from overcooked_bench.evaluation.games.block import Outcome, play_block, rows_of
from overcooked_bench.evaluation.games.episode import pack_actions
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import load_protocol, read_protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE
from overcooked_bench.leaderboard.audit import flags
from overcooked_bench.leaderboard.audit.again import compare, draw, recorded
from overcooked_bench.leaderboard.audit.playing import _again, _same_machine
from tests.evaluation.made import block, changed, protocol_text, score


@pytest.fixture(scope="module")
def greedy(tmp_path_factory):
    """A result of greedy, which is a partner itself: its scores and its episodes by block."""
    folder = tmp_path_factory.mktemp("greedy")
    rules = read_protocol(protocol_text(episodes=5, horizon=120), "tiny.yaml")
    scored = score("greedy", rules, output=folder)
    with Store(folder / EPISODES_FILE) as store:
        return scored.scores, recorded(store, sorted(store.blocks())), block(rules)


@pytest.mark.parametrize(("blocks", "share"), [(2, 1.0), (400, 0.02)])
def test_two_percent_of_cells_are_drawn_and_twenty_at_least(blocks, share):
    made = [block(load_protocol("v1"), layout="cramped_room", pool="v1", episodes=(0,))] * blocks
    rows = rows_of(made[0])
    drawn = len(draw(made, seed=3)) * rows
    assert max(20, ceil(0.02 * rows * blocks)) <= drawn
    assert drawn < max(20, ceil(0.02 * rows * blocks)) + rows
    assert len(draw(made, 3, everything=True)) == blocks


def test_the_draw_is_the_seeds():
    made = [block(load_protocol("v1"), pool="v1", episodes=(number,)) for number in range(10)] * 20
    assert draw(made, 1) == draw(made, 1) != draw(made, 2)


def played(greedy, change):
    """Compares the recorded cells with themselves, where the return of each is changed by `change(number)`."""
    _, found, first = greedy
    numbers = iter(range(10_000))
    outcomes = [
        Outcome(
            dataclasses.replace(first, episodes=(key[2],)),
            episodes=tuple(
                msgspec.structs.replace(one, soup_reward=one.soup_reward + change(next(numbers))) for one in episodes
            ),
        )
        for key, episodes in found.items()
    ]
    return compare(outcomes, found)


@pytest.mark.parametrize(
    ("change", "same", "verdict"),
    [
        (lambda number: 0, True, "passed"),
        (lambda number: 0, False, "passed"),
        (lambda number: 20 * (number == 7), True, "failed"),
        (lambda number: 20 * (number == 7), False, "passed"),
        (lambda number: 20 * (-1) ** number, False, "passed"),
        (lambda number: 20, False, "failed"),
    ],
    ids=["equal, here", "equal, elsewhere", "one differs, here", "one, elsewhere", "noise", "another agent"],
)
def test_elsewhere_returns_are_compared_instead_of_actions(greedy, change, same, verdict):
    check = _again(played(greedy, change), same)
    assert check.verdict == verdict, check
    assert ("other machine or versions" in check.said) == (not same and change(7) != 0)


def test_an_agent_that_fails_when_it_is_played_again_is_another_one(greedy):
    _, found, first = greedy
    outcomes = [Outcome(dataclasses.replace(first, episodes=(key[2],)), fault="it raised") for key in found]
    assert (compared := compare(outcomes, found)).same == 0
    assert _again(compared, True).problems == ("first: it raised",)


@pytest.mark.parametrize("change", [{}, {"machine": "other"}, {"python": "2.7"}, {"versions": {"numpy": "0.1"}}])
def test_another_machine_or_version_is_noticed(greedy, change):
    scores, _, _ = greedy
    there = msgspec.structs.replace(scores, run={**scores.run, **change})
    assert _same_machine(there) == (not change)


def test_returns_above_a_ceiling_are_flagged(greedy):
    scores, found, _ = greedy
    episodes = [one for some in found.values() for one in some]
    (layout,) = scores.layouts
    low = tuple(
        msgspec.structs.replace(one, bounds=tuple(SideBound(side, -2.0, -1.0) for side in (0, 1)))
        for one in layout.partners
    )
    assert not list(flags.above_ceilings(episodes, layout)), "the pool has no bounds"
    flagged = list(flags.above_ceilings(episodes, msgspec.structs.replace(layout, partners=low)))
    assert {flag.kind for flag in flagged} == {"above the ceiling"}
    high = tuple(msgspec.structs.replace(one, bounds=(SideBound(0, 0.0, 1e6),)) for one in layout.partners)
    assert not list(flags.above_ceilings(episodes, msgspec.structs.replace(layout, partners=high)))


def test_uneven_seats_are_flagged(greedy):
    scores, _, _ = greedy

    def seats(first, second):
        values = {0: first, 1: second}
        rows = [
            msgspec.structs.replace(row, value=values[row.seat])
            if row.metric == "mean" and row.partner is None and row.seat is not None
            else row
            for row in scores.rows
        ]
        return [flag.kind for flag in flags.uneven_seats(msgspec.structs.replace(scores, rows=tuple(rows)))]

    assert seats(100.0, 70.0) == ["seat gap"]
    assert seats(100.0, 80.0) == seats(19.0, 0.0) == [], "a quarter, and no soup, is little"


def test_training_runs_that_play_the_same_are_flagged(greedy):
    _, found, _ = greedy
    copies = {(key[0], 1, key[2]): episodes for key, episodes in found.items()}
    (flag,) = flags.identical_runs({**found, **copies})
    assert (flag.kind, flag.value) == ("identical runs", 1.0)
    other = {key: [msgspec.structs.replace(one, actions=b"") for one in episodes] for key, episodes in copies.items()}
    assert not list(flags.identical_runs({**found, **other}))


def test_an_agent_that_acts_as_a_partner_does_is_flagged(greedy):
    scores, found, first = greedy
    key = next(iter(found))
    assert [flag.value for flag in flags.similar_partners(first, found[key])] == [1.0]
    assert [flag.said for flag in flags.same_as_partner(scores)] == ["it is partner greedy"]
    still = [msgspec.structs.replace(one, actions=stay(one, 120)) for one in found[key]]
    assert not list(flags.similar_partners(first, still))


def stay(episode, horizon):
    """Joint actions in which nobody does anything."""
    assert episode.joint_actions(horizon).shape == (horizon, 2)
    return pack_actions(np.full((horizon, 2), 4, np.uint8))


def test_an_agent_that_acts_as_a_shipped_entry_does_is_flagged():
    """A copy of an entry: its games, under another hash. The entry itself is not held against it."""
    greedily = changed(read_protocol(protocol_text(episodes=1, horizon=30), "tiny.yaml"), mode="greedy")
    own = block(greedily, agent="partner-blind")
    episodes = play_block(own).episodes
    copy = dataclasses.replace(own, agent="copy", agent_sha256="0" * 64)
    assert "entry partner-blind, training run 0," in "".join(one.said for one in flags.similar_entries(copy, episodes))
    assert "partner-blind, training run 0" not in "".join(one.said for one in flags.similar_entries(own, episodes))

from collections import Counter

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.explaining.moments import EARLIEST, STEPS, choose_moments
from overcooked_bench.evaluation.games.episode import Episode


def episode(partner="a", seed=0, number=0, seat=0, kind="trained", points=0.0):
    return Episode(
        *("cramped_room", seed, number, partner, seat, 0, f"hash of {partner}", kind, points, 0.0, 0.0, 0, 0, "{}", b"")
    )


def score(partners=7, seeds=3, numbers=4):
    return [
        episode(f"p{p}", seed, number, seat)
        for p in range(partners)
        for seed in range(seeds)
        for number in range(numbers)
        for seat in (0, 1)
    ]


@given(st.integers(1, 9), st.integers(1, 5), st.integers(1, 4), st.integers(1, 60), st.integers(150, 500))
def test_moments_are_spread_evenly_over_what_was_played(partners, seeds, numbers, most, horizon):
    episodes = score(partners, seeds, numbers)
    moments = choose_moments(episodes, "me", horizon, "salt", most)
    assert len(moments) == min(most, len(episodes)) == len({msgspec.json.encode(one.episode) for one in moments})
    per_partner = Counter(one.episode.partner for one in moments)
    assert max(per_partner.values()) - min(per_partner.get(f"p{p}", 0) for p in range(partners)) <= 1
    if most >= 2 * seeds:
        per_seed = Counter(one.episode.training_seed for one in moments)
        assert max(per_seed.values()) - min(per_seed.get(s, 0) for s in range(seeds)) <= 2
    assert all(EARLIEST <= one.step <= horizon - STEPS for one in moments)


def test_nothing_that_happened_has_a_say():
    before = choose_moments(score(), "me", 400, "salt", 20)
    after = [msgspec.structs.replace(one, soup_reward=20.0 * one.seat) for one in score()]
    assert [(m.episode.cell, m.step) for m in choose_moments(after[::-1], "other", 400, "salt", 20)] == [
        (m.episode.cell, m.step) for m in before
    ]
    assert [m.step for m in choose_moments(score(), "me", 400, "pepper", 20)] != [m.step for m in before]


def test_floors_and_the_agent_itself_explain_nothing():
    episodes = [episode("random", kind="floor"), episode("me"), episode("a")]
    (moment,) = choose_moments(episodes, "hash of me", 400, "salt")
    assert moment.episode.partner == "a"


def test_short_episodes_have_no_middle():
    with pytest.raises(WrongUse, match="a horizon of 150 or more"):
        choose_moments(score(), "me", 149, "salt")
    assert {one.step for one in choose_moments(score(), "me", 150, "salt")} == {50}

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.evaluation.pools.choice import Candidate, choose_partners

CANDIDATES = st.lists(
    st.builds(
        Candidate,
        name=st.just("somebody"),
        quota=st.sampled_from("ab"),
        lineage=st.integers(0, 12).map(str),
        convention=st.fixed_dictionaries({}, optional={"x": st.sampled_from("123"), "y": st.sampled_from("12")}),
        eligible=st.integers(0, 4).map(bool),
        successful=st.booleans(),
    ),
    min_size=1,
    max_size=14,
)


def similarities(size, seed):
    s = np.random.default_rng(seed).random((size, size))
    s = np.minimum(s, s.T)
    np.fill_diagonal(s, 1)
    return s


@st.composite
def problems(draw):
    candidates = draw(CANDIDATES)
    quotas = {quota: draw(st.integers(0, 5)) for quota in {candidate.quota for candidate in candidates}}
    return candidates, similarities(len(candidates), draw(st.integers(0, 9))), quotas


def made(conventions, quota="own", **others):
    return [Candidate(f"sp-{i}", quota, str(i), said, **others) for i, said in enumerate(conventions)]


@given(problems())
@settings(deadline=None)
def test_only_eligible_candidates_of_different_lineages_are_chosen_within_the_quotas(problem):
    candidates, _, quotas = problem
    chosen = [candidates[i] for i in choose_partners(*problem).chosen]
    assert all(one.eligible for one in chosen)
    assert len({one.lineage for one in chosen}) == len(chosen)
    taken = Counter(one.quota for one in chosen)
    assert all(taken[quota] <= wanted for quota, wanted in quotas.items())


@given(problems())
@settings(deadline=None)
def test_a_choice_says_what_it_does_not_satisfy(problem):
    candidates, _, quotas = problem
    found = choose_partners(*problem)
    chosen = [candidates[i] for i in found.chosen]
    taken = Counter(one.quota for one in chosen)
    able = [one for one in candidates if one.eligible and quotas[one.quota]]
    values = {pair for one in able if one.successful for pair in one.convention.items()}
    having = Counter(pair for one in chosen for pair in one.convention.items())
    combinations = Counter(str(sorted(one.convention.items())) for one in chosen if one.convention)
    short = [quota for quota, wanted in quotas.items() if taken[quota] < wanted]
    missing = [pair for pair in values if having[pair] < 2]
    total = sum(min(n, len({one.lineage for one in able if one.quota == quota})) for quota, n in quotas.items())
    beyond = [name for name, times in combinations.items() if times > total // 3]
    assert len(found.unmet) == len(short) + len(missing) + len(beyond)


@given(problems())
@settings(deadline=None)
def test_the_same_candidates_give_the_same_choice(problem):
    assert choose_partners(*problem) == choose_partners(*problem)


def test_the_most_diverse_candidates_are_chosen():
    s = np.eye(6)
    s[:3, :3] = 1  # three copies, and three strangers
    assert choose_partners(made([{}] * 6), s, {"own": 4}) == ((0, 3, 4, 5), ())


def test_an_exchange_mends_what_one_after_the_other_gets_wrong():
    """The first one taken is the least similar to all, and similar to both that are different."""
    s = np.array([[1, 0.3, 0.3, 0.3], [0.3, 1, 0, 0.9], [0.3, 0, 1, 0.9], [0.3, 0.9, 0.9, 1]])
    assert choose_partners(made([{}] * 4), s, {"own": 2}).chosen == (1, 2)


def test_values_of_successful_candidates_occur_twice_though_they_are_similar():
    ways = [{}] * 6 + [{"onions": "top"}] * 3 + [{"onions": "bottom"}]
    s = np.full((10, 10), 0.9)
    s[:6, :6] = 0
    np.fill_diagonal(s, 1)
    found = choose_partners(made(ways), s, {"own": 6})
    assert found.chosen == (0, 1, 2, 6, 7, 9)
    assert found.unmet == ("onions=bottom: 1 of 2 partners; 1 eligible candidates have it",)
    assert choose_partners(made(ways, successful=False), s, {"own": 6}) == (tuple(range(6)), ())


def test_partners_of_other_quotas_count_for_coverage_and_shares():
    left, right = {"walks": "left"}, {"walks": "right"}
    scripted, own = made([left] * 2, "scripted"), made([left] * 3 + [right] * 3 + [{}] * 2)
    candidates = [one._replace(lineage=str(i)) for i, one in enumerate([*scripted, *own])]
    found = choose_partners(candidates, similarities(10, 0), {"scripted": 2, "own": 4})
    assert found.chosen[:2] == (0, 1)
    assert [candidates[i].convention for i in found.chosen[2:]] == [right, right, {}, {}]
    assert found.unmet == ()


def test_a_combination_that_cannot_be_kept_rare_is_said():
    found = choose_partners(made([{"serves": "left"}] * 4), np.eye(4), {"own": 3})
    assert found == ((0, 1, 2), ("serves=left: 3 of 3 partners, more than 1",))


@pytest.mark.parametrize(
    ("size", "quotas", "message"),
    [
        (2, {"own": 1}, r"shape \(2, 2\) for 3 candidates"),
        (3, {"own": -1}, "give a number from 0"),
        (3, {"human": 1}, "no candidate counts to it; there are own"),
    ],
)
def test_quotas_and_shapes_must_fit(size, quotas, message):
    with pytest.raises(ValueError, match=message):
        choose_partners(made([{}] * 3), np.eye(size), quotas)

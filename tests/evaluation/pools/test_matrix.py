import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.pools.matrix import agreement

NAMES = [f"run-{i}" for i in range(20)]


def test_the_diagonal_is_self_play_and_the_rest_is_cross_play():
    found = agreement([[100, 20, 30], [40, 140, 10], [0, 50, 60]], NAMES[:3])
    assert found.self_play.value == pytest.approx(100)
    assert found.cross_play.value == pytest.approx(25)
    assert found.ratio.value == pytest.approx(0.25)
    assert found.units == 3


def test_pairs_of_one_lineage_are_no_strangers():
    matrix = np.full((4, 4), 10.0)
    matrix[:2, :2] = 999
    found = agreement(matrix, ["a", "a", "b", "c"])
    assert found.cross_play.value == pytest.approx(10)
    assert found.units == 3


@settings(max_examples=20)
@given(arrays(float, (5, 5), elements=st.integers(0, 300)), st.permutations(range(5)))
def test_neither_order_nor_seats_matter(matrix, order):
    names, shuffled = np.array(["a", "b", "b", "c", "d"]), list(order)
    values = [
        (found.self_play.value, found.cross_play.value)
        for found in (
            agreement(matrix, names),
            agreement(matrix.T, names),
            agreement(matrix[np.ix_(shuffled, shuffled)], names[shuffled]),
        )
    ]
    assert values[1] == pytest.approx(values[0])
    assert values[2] == pytest.approx(values[0])


def test_copies_of_agents_make_no_interval_narrower():
    """The unit is the lineage: ten copies of each agent tell nothing new."""
    matrix = np.random.default_rng(0).uniform(0, 200, (4, 4))
    once = agreement(matrix, NAMES[:4])
    tenfold = agreement(np.kron(matrix, np.ones((10, 10))), np.repeat(NAMES[:4], 10))
    assert tuple(tenfold.cross_play) == pytest.approx(tuple(once.cross_play))
    assert tuple(tenfold.ratio) == pytest.approx(tuple(once.ratio))


def test_few_lineages_give_no_interval_and_one_gives_nothing():
    assert agreement(np.ones((2, 2)), ["a", "b"]).cross_play == Estimate(1)
    with pytest.raises(ValueError, match="two lineages"):
        agreement(np.ones((2, 2)), ["a", "a"])
    with pytest.raises(ValueError, match="for 3 agents"):
        agreement(np.ones((2, 2)), ["a", "b", "c"])


def test_there_is_no_ratio_to_nothing():
    assert agreement(np.zeros((3, 3)), NAMES[:3]).ratio is None


def games(rng, size, cliques):
    """A matrix of agents that differ in skill, or that understand those of their own clique alone."""
    if cliques:
        side = rng.integers(0, 2, size)
        matrix = np.where(side[:, None] == side, 180.0, 20.0) + rng.normal(0, 10, (size, size))
    else:
        skill = rng.normal(0, 20, (2, size))
        matrix = 100 + skill[0][:, None] + skill[1] + rng.normal(0, 20, (size, size))
    matrix[np.diag_indices(size)] = 180 + rng.normal(0, 10, size)
    return matrix


@pytest.mark.parametrize("cliques", [False, True], ids=["skill", "cliques"])
@pytest.mark.parametrize("size", [6, 16])
def test_intervals_cover_the_truth(size, cliques):
    rng, runs = np.random.default_rng(1), 150
    found = [agreement(games(rng, size, cliques), NAMES[:size]) for _ in range(runs)]
    for one, truth in (("self_play", 180), ("cross_play", 100), ("ratio", 100 / 180)):
        if one == "ratio" and size < 10:
            assert all(a.ratio.interval is None for a in found)
            continue
        covered = np.mean([getattr(a, one).low <= truth <= getattr(a, one).high for a in found])
        assert covered > 0.88, one


def test_pairs_as_if_they_were_independent_would_not_cover():
    """What whole agents are drawn for: with the pairs' own error the truth is missed far too often."""
    rng, hits = np.random.default_rng(1), []
    for _ in range(200):
        strangers = games(rng, 6, cliques=False)[~np.eye(6, dtype=bool)]
        hits.append(abs(strangers.mean() - 100) < 1.96 * strangers.std(ddof=1) / 30**0.5)
    assert np.mean(hits) < 0.8

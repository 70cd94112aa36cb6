import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from overcooked_bench.evaluation.pools.similarity import effective_number, similarity, weights

SIZES = st.integers(1, 6)


@st.composite
def measured(draw):
    size = draw(SIZES)
    means = draw(arrays(np.float64, (size, size), elements=st.floats(0, 400)))
    return means, draw(arrays(np.float64, size, elements=st.floats(40, 400)))


def test_similarity_is_the_worse_seat_by_the_lower_ceiling():
    means = [[0, 90, 10], [60, 0, 500], [10, 200, 0]]
    found = similarity(means, [100, 120, 50])
    assert found == pytest.approx(np.array([[1, 0.6, 0.2], [0.6, 1, 1], [0.2, 1, 1]]))


@given(measured())
def test_similarity_is_symmetric_between_0_and_1_and_1_with_itself(given_):
    found = similarity(*given_)
    assert (found == found.T).all()
    assert ((found >= 0) & (found <= 1)).all()
    assert (found.diagonal() == 1).all()


@given(measured())
def test_weights_are_positive_and_sum_to_one(given_):
    found = weights(similarity(*given_))
    assert (found > 0).all()
    assert found.sum() == pytest.approx(1)


@given(measured(), st.randoms())
def test_the_order_of_partners_does_not_matter(given_, random):
    means, ceilings = given_
    order = list(range(len(ceilings)))
    random.shuffle(order)
    s, shuffled = similarity(means, ceilings), similarity(means[np.ix_(order, order)], ceilings[order])
    assert weights(shuffled) == pytest.approx(weights(s)[order])
    assert effective_number(shuffled) == pytest.approx(effective_number(s))


@given(measured())
def test_the_effective_number_is_from_one_to_the_number_of_partners(given_):
    s = similarity(*given_)
    assert 1 - 1e-9 <= effective_number(s) <= len(s) + 1e-9


@given(SIZES, SIZES)
def test_copies_share_the_weight_of_one(copies, others):
    s = np.eye(copies + others)
    s[:copies, :copies] = 1
    found = weights(s)
    assert found[:copies].sum() == pytest.approx(1 / (1 + others))
    assert found[copies:] == pytest.approx(1 / (1 + others))
    assert effective_number(np.eye(others)) == pytest.approx(others)
    assert effective_number(np.ones((copies, copies))) == pytest.approx(1)


@pytest.mark.parametrize(
    ("means", "ceilings", "message"),
    [
        ([[1, 2]], [1, 1], r"give \(P, P\) and \(P,\)"),
        ([[1.0]], [0.0], "ceiling of partner 0 is 0"),
        ([[np.nan]], [10.0], "not finite"),
    ],
)
def test_what_has_no_similarity_is_refused(means, ceilings, message):
    with pytest.raises(ValueError, match=message):
        similarity(means, ceilings)


@pytest.mark.parametrize("s", [np.ones((2, 3)), [[1, 0.5], [0.4, 1]], [[1, 2], [2, 1]], [[0.5]], np.ones((0, 0))])
def test_only_similarities_have_weights(s):
    with pytest.raises(ValueError, match="square, symmetric"):
        weights(s)

import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.evaluation.explaining.reasons import FAILURES, HALF, REASONS, Soups, reason_for, typical

amounts = st.lists(st.integers(0, 5).map(float), min_size=4, max_size=4).map(tuple)
played = st.builds(Soups, pair=amounts, agent=amounts, partner=amounts, greedy=amounts.map(lambda soups: soups[:1]))


def soups(pair, agent, partner, greedy):
    return Soups(pair=(pair,), agent=(agent,), partner=(partner,), greedy=(greedy,))


@pytest.mark.parametrize(
    ("delivered", "reason"),
    [
        ((0, 3, 3, 3), "clash"),
        ((1.4, 3, 3, 3), "clash"),
        ((1.5, 3, 3, 3), "works"),
        ((0, 0, 3, 3), "inexperience"),
        ((0, 3, 0, 3), "weak partner"),
        ((0, 0, 0, 3), "neither"),
        ((0, 0.75, 0.75, 3), "neither"),  # less than a soup is not doing well, however little the pair does
        ((1.4, 1.6, 1.6, 3), "neither"),  # as slow together as alone
        ((1.4, 3, 1.6, 3), "weak partner"),  # as slow as the partner is alone
        ((1.4, 1.6, 3, 3), "inexperience"),
        ((0, 3, 1, 3), "weak partner"),  # not half of what the agent does alone
        ((0, 0.5, 0.5, 0), "nothing"),
        ((0, 0, 0, 0), "nothing"),
        ((5, 0, 0, 1), "works"),
        ((0.5, 0, 0, 1), "works"),
    ],
)
def test_the_reason_of_a_moment(delivered, reason):
    assert reason_for(soups(*delivered)) == reason


@given(played)
def test_agent_and_partner_change_places(one):
    swapped = Soups(pair=one.pair, agent=one.partner, partner=one.agent, greedy=one.greedy)
    other = {"inexperience": "weak partner", "weak partner": "inexperience"}
    reason = reason_for(one)
    assert reason_for(swapped) == other.get(reason, reason)


@given(played)
def test_a_clash_is_half_of_what_each_does_alone(one):
    reason, pair = reason_for(one), one.mean("pair")
    assert reason in REASONS
    if reason == "clash":
        assert pair < HALF * min(one.mean("agent"), one.mean("partner"))
    assert (reason in FAILURES) == (one.best >= 1 and pair < HALF * one.best)


@given(played)
def test_a_pair_that_does_better_never_fails_for_it(one):
    better = Soups(pair=(5.0,) * 4, agent=one.agent, partner=one.partner, greedy=one.greedy)
    assert reason_for(better) == "works"


@pytest.mark.parametrize(("soups", "repeat"), [((0, 0, 0, 4), 0), ((4, 0, 1, 0), 2), ((2,), 0)])
def test_the_game_that_is_shown_is_the_one_nearest_to_the_mean(soups, repeat):
    assert typical(soups) == repeat

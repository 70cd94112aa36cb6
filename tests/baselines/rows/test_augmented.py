"""State augmentation beside plain self-play: both readings of the claim, from records."""

import pytest

from overcooked_bench.baselines.rows.augmented import ALL, claims, mean, minus, readings
from overcooked_bench.estimate import Estimate
from tests.baselines.rows.made import LAYOUTS, entry, standings


@pytest.mark.parametrize(
    ("crossed", "level", "said"),
    [
        (160.0, 0.5, ("holds here", "undecided here")),
        (40.0, 0.7, ("the opposite holds here", "holds here")),
        (101.0, 0.3, ("undecided here", "the opposite holds here")),
    ],
)
def test_each_reading_is_decided_by_an_interval_of_its_own(crossed, level, said):
    plain = entry("self-play", 0.5)
    augmented = entry("state-augmented", level, crossed=crossed, by_seed=tuple(x + level - 0.5 for x in plain.by_seed))
    rows = claims(standings(plain, augmented))
    assert [row.layout for row in rows] == [*LAYOUTS, ALL]
    for sentence, verdict in zip(readings(rows), said, strict=True):
        assert f": {verdict}." in sentence
    whole = rows[-1]
    assert whole.cross_play.value == pytest.approx(crossed - 100)
    assert whole.gap.value == pytest.approx(100 - crossed)
    assert whole.n.value == pytest.approx(level - 0.5)


def test_without_both_entries_nothing_is_claimed():
    assert claims(standings(entry("self-play", 0.5))) == []
    assert claims(standings(entry("self-play", 0.5), entry("state-augmented", 0.5, seeds=1))) == []


def test_half_widths_add_up_as_those_of_independent_numbers():
    one, other = Estimate(10.0, 7.0, 13.0), Estimate(2.0, 0.0, 6.0)  # the second's lower end is clipped
    assert minus(one, other) == Estimate(8.0, 3.0, 13.0)
    assert mean([one, other]) == Estimate(6.0, 3.5, 8.5)
    assert minus(one, Estimate(2.0)) == Estimate(8.0)
    assert mean([one, Estimate(2.0)]) == Estimate(6.0)

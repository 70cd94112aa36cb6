"""No person is in both sets, and pairs are chosen by what a user writes."""

import pytest

from overcooked_bench.errors import WrongUse
from overcooked_bench.human.people import PAIRS_2019, SETS, chosen, set_of
from tests.human.made import random_game

GAMES = [random_game(steps=1, group=pair) for pair in PAIRS_2019] + [random_game(steps=1), random_game(group="ours.1")]


def groups(wanted: str) -> list[str | None]:
    return [game.group for game in chosen(GAMES, wanted)]


def test_every_pair_of_2019_is_in_one_set():
    assert sorted(SETS["A"] + SETS["B"]) == sorted(PAIRS_2019)
    assert (len(SETS["A"]), len(SETS["B"])) == (9, 8)
    assert [set_of(pair) for pair in ("2019-00", "2019-01", "ours.1", None)] == ["A", "B", None, None]


def test_pairs_are_chosen_by_set_number_and_name():
    assert groups("A") == list(SETS["A"])
    assert groups("B") == list(SETS["B"])
    assert groups("5, 03") == ["2019-03", "2019-05"]
    assert groups("2019-16,ours.1") == ["2019-16", "ours.1"]


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ("C", "no game of C; there are"),
        ("17", "'17' is no pair"),
        ("", "'' is no pair"),
        ("3,2019-03", "twice"),
        ("1,,2", "'' is no pair"),
    ],
)
def test_pairs_that_are_not_there_are_refused(wanted, message):
    with pytest.raises(WrongUse, match=message):
        chosen(GAMES, wanted)


def test_a_set_needs_a_game():
    with pytest.raises(WrongUse, match=r"no game of 2019-01, .*there are games of 2019-00"):
        chosen(GAMES[:1], "B")

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.agents.mirror import mirror_state
from overcooked_bench.scenarios.language.counters import Counter
from overcooked_bench.scenarios.language.predicates import PredicateError, parse_any_of, parse_condition
from overcooked_bench.scenarios.language.terms import Moment

RING = Layout.load("coordination_ring")
STATE = KitchenState(
    (Chef((3, 1), "north", "dish"), Chef((1, 2), "west")),
    {(2, 2): "onion", (3, 0): Soup((3, 0), 12, 20), (4, 1): Soup((2, 0)), (3, 4): Soup((3, 0), 20, 20)},
)
COUNTS = {
    Counter("pot", "A"): 2,
    Counter("pot", "A", "onion", 1): 1,
    Counter("pick", "B", "dish"): 0,
    Counter("blocked", "B"): 3,
    Counter("score"): 20,
}


def moment(state=STATE, layout=RING, seat=0):
    kitchens = Kitchens(layout, 1)
    kitchens.set_state(0, state)
    return Moment(layout, kitchens.batch.rows, seat, {key: np.array([count]) for key, count in COUNTS.items()})


TRUE = [
    *("A.holds(dish)", "B.holds(nothing)", "not B.holds(dish)", "A.at(3, 1)", "A.x == 3", "A.y < B.y", "B.x < A.x"),
    *("pot(1).cooking", "not pot(1).ready", "pot(1).n == 3", "pot(2).n == 2", "not pot(2).cooking"),
    *("counter(2, 2) == onion", "counter(0, 0) == nothing", "counter(3, 4) != dish", "counter(3, 4) == soup"),
    *("dist(A, B) == 3", "dist(B, A) < 4", "blocked(B) >= 3", "score == 20", "20 <= score", "1 <= A.pot <= 2"),
    *("A.pot > 1", "A.pot(onion, at=1) == 1", "B.pick(dish) < 1", "A.pot >= 3 or A.holds(dish)"),
    *("A.pot >= 2 and not (B.x > 2 or B.y > 2)", "1 < A.x <= 3"),
]


@pytest.mark.parametrize("text", TRUE)
def test_what_is_true_is_true_in_the_mirror_and_is_written_as_it_is_read(text):
    condition = parse_condition(text, RING)
    assert condition.value(moment()).tolist() == [True]
    assert parse_condition(f"not ({text})", RING).value(moment()).tolist() == [False]
    turned = condition.mirrored(RING)
    assert turned.value(moment(mirror_state(STATE, RING.width), RING.mirrored())).tolist() == [True]
    assert turned.mirrored(RING.mirrored()) == condition
    assert parse_condition(str(condition), RING) == condition


def test_a_list_is_any_of():
    assert parse_any_of(["A.x == 0", "A.x == 3"], RING).value(moment()).tolist() == [True]
    assert parse_any_of(["A.x == 3"], RING) == parse_condition("A.x == 3", RING)


def test_chefs_go_by_the_seat():
    condition = parse_condition("A.holds(nothing) and B.holds(dish)", RING)
    assert condition.value(moment(seat=1)).tolist() == [True]
    assert [str(part) for part in condition.conjuncts] == ["A.holds(nothing)", "B.holds(dish)"]


def test_what_has_to_be_counted_is_bounded():
    condition = parse_condition("(A.pot >= 3 or 1 < A.pot) and B.serve == 0 and not score > 39 and A.x >= 2", RING)
    assert condition.counters == {Counter("pot", "A"): 4, Counter("serve", "B"): 1, Counter("score"): 40}


REFUSED = {
    "call": ("__import__('os')", "not in the language"),
    "attribute": ("A.pot.__class__ == 1", "no chef"),
    "hidden": ("A.__class__", "After a chef come"),
    "lambda": ("(lambda: 1)()", "not in the language"),
    "comprehension": ("[x for x in A]", "not in the language"),
    "text": ("'A'", "not in the language"),
    "arithmetic": ("A.pot + 1 >= 2", "not in the language"),
    "walrus": ("(x := 1)", "not in the language"),
    "statement": ("import os", "no condition"),
    "fraction": ("A.pot >= 1.5", "not in the language"),
    "huge": ("A.pot >= 10001", "too great"),
    "negative": ("A.x >= -1", "not in the language"),
    "true": ("True", "not in the language"),
    "is": ("A.pot is 1", "compares in a way"),
    "number_alone": ("A.pot", "compare it: `A.pot >= 1`"),
    "condition_compared": ("A.holds(dish) == 1", "true or false already"),
    "constants": ("1 == 1", "always true or never"),
    "two_counts": ("A.pot >= B.pot", "compare it with a number"),
    "things_and_numbers": ("counter(2, 2) == 1", "mixes things"),
    "things_in_order": ("counter(2, 2) > onion", "mixes things"),
    "column_and_row": ("A.x == A.y", "mirrored"),
    "column_and_distance": ("dist(A, B) < A.x", "mirrored"),
    "no_pot": ("pot(3).n == 1", "1 to 2 here"),
    "pot_word": ("pot(1).full", "`n`, `cooking` and `ready`"),
    "pot_bare": ("pot(1) == 3", "needs a word more"),
    "no_counter": ("counter(1, 1) == onion", "is no counter"),
    "outside": ("counter(5, 1) == onion", "outside"),
    "no_floor": ("A.at(0, 0)", "is no floor"),
    "item": ("A.holds(pan)", "nothing or onion"),
    "plated_item": ("A.plate(onion) >= 1", "is written `A.plate`"),
    "served_at": ("A.serve(at=1) >= 1", "is written `A.serve`"),
    "empty_call": ("A.pot() >= 1", "is written"),
    "unpacked": ("A.pot(*onion) >= 1", "no thing"),
    "named_otherwise": ("A.pot(to=1) >= 1", "is written"),
    "holds_bare": ("A.holds", "is written `A.holds"),
    "third_chef": ("C.pot >= 1", "no chef"),
    "distance": ("dist(A, A) == 1", "between both chefs"),
    "blocked": ("blocked() >= 1", "about one chef"),
    "long": ("A.pot >= 1" + " and A.pot >= 1" * 50, "500 at most"),
    "deep": ("(" * 240 + "A.pot >= 1" + ")" * 240, "no condition"),
    "empty": ("", "no condition"),
    "null": ("A.pot >= 1\0", "no condition"),
}


@pytest.mark.parametrize(("text", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_what_is_not_in_the_language_is_refused(text, message):
    with pytest.raises(PredicateError, match=message):
        parse_condition(text, RING)


@settings(max_examples=200, deadline=None)
@given(st.text(st.sampled_from("AB.potxy()=<>!1 2andorholds,[]{}'\"\\_:*@#\n"), max_size=40))
def test_any_text_is_read_or_refused(text):
    try:
        condition = parse_condition(text, RING)
    except PredicateError:
        return
    assert condition.value(moment()).shape == (1,)

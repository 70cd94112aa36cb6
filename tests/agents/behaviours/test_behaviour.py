"""What holds for all behaviours, in any state."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Layout, UnknownLayout, load_agent
from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.agents.mirror import mirror_actions, mirror_state
from overcooked_bench.agents.submissions.checks import AgentError, check_agent
from overcooked_bench.kitchen.codes import NUM_ACTIONS, STAY
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup

LAYOUTS = {
    name: Layout.load(name)
    for name in ("cramped_room", "coordination_ring", "forced_coordination", "counter_circuit", "bottleneck")
}
TIMES = [{}, {"until": 3, "then": "onions"}, {"from": 2}, {"noisy": {"p": 0.3, "seed": 1}}, {"then": "plater"}]
MANNERS = [{}, {"insist": True}, {"yields": True}]


def behaviours(layout):
    """Any behaviour that fits a layout, as it is written."""
    counters = st.lists(st.sampled_from(layout.positions("X")), min_size=1, max_size=3).map(lambda c: [*map(list, c)])
    cells = st.lists(st.sampled_from(layout.positions(" ")), min_size=1, max_size=3).map(lambda c: [*map(list, c)])
    walks = {"manner": st.sampled_from(MANNERS)}
    kinds = [
        st.fixed_dictionaries({"does": st.sampled_from(["carry", "onions", "plater", "helper"]), **walks}),
        st.fixed_dictionaries(
            {"does": st.sampled_from(["receiver", "dumper", "lay", "helper"]), "counters": counters, **walks}
        ),
        st.fixed_dictionaries({"does": st.just("pace"), "cells": cells, "every": st.integers(1, 3), **walks}),
        st.just({"does": "loop", "actions": ["up", "interact", "left"]}),
    ]
    return st.tuples(st.one_of(kinds), st.sampled_from(TIMES)).map(_written)


def _written(drawn):
    kind, times = dict(drawn[0]), drawn[1]
    return kind | kind.pop("manner", {}) | times


@st.composite
def moments(draw):
    """A behaviour, a layout and a state that random play leads to."""
    layout = LAYOUTS[draw(st.sampled_from(sorted(LAYOUTS)))]
    kitchens = Kitchens(layout, 1, object_probability=0.5)
    kitchens.reset(seed=draw(st.integers(0, 1000)))
    for action in draw(st.lists(st.tuples(*[st.integers(0, NUM_ACTIONS - 1)] * 2), max_size=12)):
        kitchens.step([action])
    return parse_behaviour(draw(behaviours(layout))), layout, kitchens.state(0)


@settings(max_examples=150, deadline=None)
@given(moments(), st.integers(0, 1), st.integers(0, 12))
def test_any_state_has_an_answer_that_the_mirror_mirrors(moment, seat, t):
    behaviour, layout, state = moment
    action = behaviour.act(layout, state, seat, t)
    assert action in range(NUM_ACTIONS)
    assert behaviour.act(layout, state, seat, behaviour.phase(t)) == action
    assert behaviour.phase(behaviour.phase(t) + 1) == behaviour.phase(t + 1)
    image = behaviour.mirrored(layout.width)
    assert image.act(layout.mirrored(), mirror_state(state, layout.width), seat, t) == mirror_actions(action)
    assert image.mirrored(layout.width) == behaviour


@settings(max_examples=60, deadline=None)
@given(moments(), st.integers(0, 1))
def test_what_is_not_looked_at_does_not_matter(moment, seat):
    behaviour, layout, state = moment
    partner, sight = state.chefs[1 - seat], behaviour.sight
    other = replace(partner, holding=None if partner.holding else "onion")
    if not sight.partner_facing:
        other = replace(other, facing="south" if partner.facing == "north" else "north")
    chefs = (state.chefs[0], other) if seat == 0 else (other, state.chefs[1])
    seen = {*sight.counters, *(layout.positions("P") if sight.pots else ())}
    objects = {cell: thing for cell, thing in state.objects.items() if cell in seen}
    changed = KitchenState(chefs, objects)
    assert behaviour.act(layout, changed, seat, 1) == behaviour.act(layout, state, seat, 1)


# A job, where its chef starts and with what, what lies about, and what it will have done in the end.
PARTS = {
    "carry an onion": ("coordination_ring", {"does": "carry"}, ((1, 1), "onion"), {}, "potting_onion"),
    "carry a soup": ("counter_circuit", {"does": "carry"}, ((1, 2), "soup"), {}, "soup_delivery"),
    "onions": ("cramped_room", {"does": "onions"}, ((3, 2), None), {}, "potting_onion"),
    "plater": ("coordination_ring", {"does": "plater"}, ((2, 1), None), {(3, 0): "soup"}, "soup_delivery"),
    "receiver": (
        "counter_circuit",
        {"does": "receiver", "counters": [[3, 2]]},
        ((3, 1), None),
        {(3, 2): "onion"},
        "potting_onion",
    ),
    "dumper": ("counter_circuit", {"does": "dumper", "counters": [[5, 2]]}, ((3, 3), None), {}, "onion_drop"),
    "lay": ("cramped_room", {"does": "lay", "counters": [[0, 2]]}, ((3, 1), "dish"), {}, "dish_drop"),
    "helper": ("cramped_room", {"does": "helper"}, ((3, 1), None), {}, "potting_onion"),
}
SOUP = Soup((3, 0), 20, 20)


@pytest.mark.parametrize("manner", MANNERS, ids=["polite", "insists", "yields"])
@pytest.mark.parametrize("part", PARTS)
def test_whoever_was_disturbed_goes_on_once_the_way_is_clear(part, manner):
    name, mapping, (cell, item), things, event = PARTS[part]
    behaviour = parse_behaviour(mapping | manner)
    layout, rng = Layout.load(name), np.random.default_rng(0)
    me = Chef(cell, "north", SOUP if item == "soup" else item)
    objects = {place: SOUP if thing == "soup" else thing for place, thing in things.items()}
    floor = [free for free in layout.positions(" ") if free != cell]
    for seat in (0, 1):
        for _ in range(4):
            partner = Chef(floor[rng.integers(len(floor))])
            kitchens = Kitchens(layout, 1, events=True)
            kitchens.set_state(0, KitchenState((me, partner) if seat == 0 else (partner, me), objects))
            done = 0
            # The other walks about, in the way and never with anything, and at last keeps away.
            for t in range(30):
                joint = [behaviour.act(layout, kitchens.state(0), seat, t)] * 2
                joint[1 - seat] = int(rng.integers(4))
                done += kitchens.step([joint]).events[0, seat, EVENTS.index(event)]
            for t in range(30, 60):
                joint = [behaviour.act(layout, kitchens.state(0), seat, t)] * 2
                joint[1 - seat] = away(kitchens.state(0), layout, seat)
                done += kitchens.step([joint]).events[0, seat, EVENTS.index(event)]
            assert done >= 1


def away(state, layout, seat):
    """The action that leads the other chef farthest from the one on a seat."""
    (x, y), (a, b) = state.chefs[seat].position, state.chefs[1 - seat].position
    ways = [(0, -1), (0, 1), (1, 0), (-1, 0), (0, 0)]
    open_ways = [k for k, (dx, dy) in enumerate(ways) if layout.tile((a + dx, b + dy)) == " "]
    return max(open_ways, key=lambda k: abs(a + ways[k][0] - x) + abs(b + ways[k][1] - y))


def test_a_script_on_a_seat():
    agent = ScriptAgent(parse_behaviour({"does": "script", "actions": ["up", "left"]}))
    check_agent(agent, "script")
    kitchens = Kitchens("cramped_room", 3)
    for _ in range(2):
        agent.reset("cramped_room", np.array([0, 1, 0]), np.zeros(3, np.uint64))
        states = [kitchens.state(i) for i in range(3)]
        assert [agent.act(states).tolist() for _ in range(3)] == [[0] * 3, [3] * 3, [STAY] * 3]


def test_cells_that_the_kitchen_has_not_are_refused():
    seats = np.zeros(1, np.int64), np.zeros(1, np.uint64)
    for mapping, what in (
        ({"does": "lay", "counters": [[1, 1]]}, r"\(1, 1\) is no counter of 'cramped_room'"),
        ({"does": "carry", "then": [0, 0]}, r"\(0, 0\) is no floor of 'cramped_room'"),
        ({"does": "pace", "cells": [[1, 9]], "from": 3}, r"\(1, 9\) is no floor of 'cramped_room'"),
    ):
        with pytest.raises(UnknownLayout, match=what):
            ScriptAgent(parse_behaviour(mapping)).reset("cramped_room", *seats)


def test_scripts_are_agents_of_the_catalogue():
    agent = load_agent("script:{does: onions, insist: true}", "cramped_room")
    check_agent(agent, "script")
    assert agent.observation == "state"
    with pytest.raises(AgentError, match=r"script:carries: .* did you mean 'carry'"):
        load_agent("script:carries", "cramped_room")

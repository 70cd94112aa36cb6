"""A state that is shown to several agents cannot be changed by one of them."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from overcooked_bench import Chef, Kitchens, KitchenState, play_episodes
from overcooked_bench.agents.behaviours.parsing import parse_behaviour

STATE = KitchenState((Chef((1, 1)), Chef((2, 1))), {(0, 0): "onion", (1, 0): "dish"})


def changes():
    return {
        "clear": lambda objects: objects.clear(),
        "set": lambda objects: objects.__setitem__((0, 0), "dish"),
        "delete": lambda objects: objects.__delitem__((0, 0)),
        "pop": lambda objects: objects.pop((0, 0)),
        "popitem": lambda objects: objects.popitem(),
        "setdefault": lambda objects: objects.setdefault((3, 0), "dish"),
        "update": lambda objects: objects.update({(0, 0): "dish"}),
        "or": lambda objects: objects.__ior__({(0, 0): "dish"}),
    }


@pytest.mark.parametrize("change", changes().values(), ids=changes())
def test_objects_are_only_read(change):
    before = dict(STATE.objects)
    with pytest.raises(TypeError, match=r"change a copy, dict\(state.objects\)"):
        change(STATE.objects)
    assert STATE.objects == before == {(0, 0): "onion", (1, 0): "dish"}


def test_a_state_keeps_its_own_objects():
    given = {(0, 0): "onion"}
    state = KitchenState(STATE.chefs, given)
    given.clear()
    assert state.objects == {(0, 0): "onion"}


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda state: pickle.loads(pickle.dumps(state))])
def test_states_are_copied_and_pickled(copied):
    twin = copied(STATE)
    assert twin == STATE
    with pytest.raises(TypeError):
        twin.objects.clear()


def test_a_copy_is_changed_as_the_message_says():
    objects = dict(STATE.objects)
    objects.pop((0, 0))
    assert replace(STATE, objects=objects).objects == {(1, 0): "dish"}
    assert STATE.objects | {(3, 0): "dish"} == {**STATE.objects, (3, 0): "dish"}
    kitchens = Kitchens("cramped_room", 1)
    kitchens.set_state(0, KitchenState(STATE.chefs, {(0, 0): "onion"}))
    assert kitchens.state(0).objects == {(0, 0): "onion"}


class Waits:
    observation = "state"

    def __init__(self, spoils):
        self.spoils, self.refused = spoils, 0

    def reset(self, layout, seats, seeds):
        pass

    def act(self, states):
        for state in states if self.spoils else ():
            try:
                state.objects.clear()
            except TypeError:
                self.refused += 1
        return np.full(len(states), 4)


class Onions:
    """Fetches onions, as one who sees states."""

    observation = "state"

    def reset(self, layout, seats, seeds):
        from overcooked_bench.kitchen.layout import Layout

        self.layout, self.seats, self.step = Layout.load(layout), seats, 0
        self.behaviour = parse_behaviour({"does": "helper"})

    def act(self, states):
        step, self.step = self.step, self.step + 1
        return np.array(
            [
                self.behaviour.act(self.layout, state, int(seat), step)
                for state, seat in zip(states, self.seats, strict=True)
            ]
        )


def test_an_agent_that_spoils_what_it_is_shown_changes_no_game():
    fair = play_episodes("cramped_room", (Waits(False), Onions()), episodes=2, horizon=120)
    spoiler = Waits(True)
    foul = play_episodes("cramped_room", (spoiler, Onions()), episodes=2, horizon=120)
    assert spoiler.refused == 2 * 120
    assert fair.soup_reward.sum() > 0
    np.testing.assert_array_equal(foul.soup_reward, fair.soup_reward)

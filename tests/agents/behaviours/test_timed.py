import numpy as np
import pytest

from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.kitchen.codes import EAST, INTERACT, NORTH, STAY, WEST
from tests.agents.behaviours.kitchens import Watched

ROOM = "cramped_room"


def actions(mapping, steps, holding=None):
    kitchen = Watched(ROOM, ((2, 2), "north", holding), ((1, 1), "north"))
    return kitchen.play(parse_behaviour(mapping), steps)


@pytest.mark.parametrize(
    ("mapping", "played"),
    [
        pytest.param({"does": "frozen"}, [STAY] * 5, id="frozen"),
        pytest.param({"does": "script", "actions": ["up", "interact"]}, [NORTH, INTERACT] + [STAY] * 3, id="script"),
        pytest.param({"does": "script", "actions": ["stay*3", "up"]}, [STAY] * 3 + [NORTH, STAY], id="repeated"),
        pytest.param(
            {"does": "script", "actions": ["up"], "then": {"does": "loop", "actions": ["left", "right"]}},
            [NORTH, WEST, EAST, WEST, EAST],
            id="script, then loop",
        ),
        pytest.param({"does": "loop", "actions": ["left", "right"], "from": 2}, [STAY] * 2 + [3, 2, 3], id="late"),
        pytest.param({"does": "loop", "actions": ["left"], "until": 2}, [WEST] * 2 + [STAY] * 3, id="drops out"),
        pytest.param(
            {"does": "loop", "actions": ["left"], "from": 1, "until": 3}, [STAY, WEST, WEST, STAY, STAY], id="both"
        ),
        pytest.param({"does": "frozen", "until": 2, "then": [3, 2]}, [STAY, STAY, EAST, STAY, STAY], id="leaves"),
        pytest.param(
            {"does": "frozen", "until": 2, "then": {"does": "script", "actions": ["up"]}},
            [STAY, STAY, NORTH, STAY, STAY],
            id="its clock starts at the change",
        ),
    ],
)
def test_time_goes_by(mapping, played):
    assert actions(mapping, 5) == played


def test_noise_is_the_same_every_time_and_as_frequent_as_was_said():
    noisy = {"does": "loop", "actions": ["interact"], "noisy": {"p": 0.5, "seed": 7}}
    played = actions(noisy, 300)
    assert played == actions(noisy, 300)
    assert set(played) == set(range(6))
    assert 0.5 < np.mean(np.array(played) == INTERACT) < 0.67  # half of them wanted, a sixth of the rest drawn
    other = {**noisy, "noisy": {"p": 0.5, "seed": 8}}
    assert played != actions(other, 300)
    assert actions({**noisy, "noisy": {"p": 0, "seed": 7}}, 30) == [INTERACT] * 30


def test_phases_are_as_early_as_they_can_be():
    def phases(mapping):
        return [parse_behaviour(mapping).phase(t) for t in range(6)]

    assert phases({"does": "frozen"}) == [0] * 6
    assert phases({"does": "plater"}) == [0] * 6
    assert phases({"does": "script", "actions": ["up", "up"]}) == [0, 1, 2, 2, 2, 2]
    assert phases({"does": "loop", "actions": ["up", "down", "up"]}) == [0, 1, 2, 0, 1, 2]
    assert phases({"does": "plater", "until": 3}) == [0, 1, 2, 3, 3, 3]
    late = {"does": "carry", "then": {"does": "loop", "actions": ["up", "down"]}}
    assert phases(late) == [0, 1, 0, 1, 0, 1]

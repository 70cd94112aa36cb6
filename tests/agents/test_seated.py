"""Whatever an agent returns or raises ends in actions or in a fault that names it."""

import numpy as np
import pytest

from overcooked_bench import Kitchens, UnknownLayout, play_episodes
from overcooked_bench.agents import one_game_at_a_time
from overcooked_bench.agents.saying import MOST
from overcooked_bench.agents.seated import Seated, SeatedFault, Views
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

ROWS = 3


class Hostile:
    """Everything that is asked of it raises."""

    def __getattribute__(self, name):
        raise LookupError("not for you")

    def __repr__(self):
        raise MemoryError


class Liar(np.ndarray):
    """An array that says of itself what is not so."""

    def min(self, *args, **options):
        return 0

    def max(self, *args, **options):
        return 5


class Array:
    def __array__(self, *args, **options):
        raise KeyError("array")


class Detached:
    def detach(self):
        raise OSError("detach")


class Unsaid(Exception):
    def __str__(self):
        raise RuntimeError


class Ends(BaseException):
    pass


class Acts:
    """Returns what it is given, or raises it."""

    observation = "features"

    def __init__(self, answer, at_reset=False):
        self.answer, self.at_reset = answer, at_reset

    def reset(self, layout, seats, seeds):
        if self.at_reset:
            raise self.answer

    def act(self, observations):
        if issubclass(type(self.answer), BaseException):
            raise self.answer
        return self.answer


def seated(agent):
    one = Seated(agent, "the cook", np.arange(ROWS), np.zeros(ROWS, np.int64))
    one.reset("cramped_room", np.arange(ROWS, dtype=np.uint64))
    return one


ANSWERS = {
    "hostile": (Hostile(), "act returned no array"),
    "hostile items": ([Hostile()] * ROWS, "act returned no array"),
    "array": (Array(), r"act returned no array \(KeyError: 'array'\)"),
    "detach": (Detached(), r"act returned no array \(OSError: detach\)"),
    "liar": (np.array([0, 9, 9]).view(Liar), "the action 9 in row 1"),
    "masked": (np.ma.array([0, 7, 0], mask=[0, 1, 0]), "the action 7 in row 1"),
    "huge": (np.array([4, 4, 2**64 - 1], np.uint64), "in row 2"),
    "wide": (np.array([("a" * 50_000,)] * ROWS, dtype=[("\x1b[31m" + "n" * 90, "U50000")]), "act returned"),
    "record": (np.zeros(ROWS, "V8"), "act returned"),
    "endless": (iter(int, 1), r"the shape \(\)"),
}


@pytest.mark.parametrize(("answer", "message"), ANSWERS.values(), ids=ANSWERS.keys())
def test_what_is_no_answer_is_the_agents_fault(answer, message):
    with pytest.raises(SeatedFault, match=message) as fault:
        seated(Acts(answer)).act(None)
    assert (fault.value.who, fault.value.step) == ("the cook", 0)
    check_text(str(fault.value))


RAISED = {
    "long": (ValueError("\x1b[2J\a" + "x" * 700_000), r"ValueError: \\x1b\[2J\\x07xxx"),
    "unsaid": (Unsaid(), r"Unsaid: \(its message cannot be shown\)"),
    "ends": (Ends("now"), "Ends: now"),
    "exits": (SystemExit(3), "SystemExit: 3"),
    "generator": (GeneratorExit(), r"raised GeneratorExit$"),
    "lines": (ValueError("one\ntwo"), r"one\\ntwo"),
    "named": (type("\x1b" + "N" * 9_000, (Exception,), {})(), "raised"),
}


@pytest.mark.parametrize("at_reset", [False, True])
@pytest.mark.parametrize(("error", "message"), RAISED.values(), ids=RAISED.keys())
def test_what_is_raised_is_the_agents_fault(error, message, at_reset):
    with pytest.raises(SeatedFault, match=message) as fault:
        seated(Acts(error, at_reset)).act(None)
    assert fault.value.step == (None if at_reset else 0)
    check_text(str(fault.value))


def check_text(text):
    """Any message can be printed: one line, not too long, nothing that moves a cursor."""
    assert text.isprintable()
    assert len(text) < 3 * MOST


def test_ctrl_c_is_nobodys_fault():
    for at_reset in (False, True):
        with pytest.raises(KeyboardInterrupt):
            seated(Acts(KeyboardInterrupt(), at_reset)).act(None)


def test_an_unknown_layout_passes_with_a_message_that_can_be_printed():
    with pytest.raises(UnknownLayout) as error:
        seated(Acts(UnknownLayout("\x1b" * 90_000), at_reset=True))
    check_text(str(error.value))
    with pytest.raises(SeatedFault, match="raised UnknownLayout"):
        seated(Acts(UnknownLayout("too late"))).act(None)


def test_a_player_of_one_game_may_be_as_hostile():
    class Plays:
        def act(self, seen):
            return Hostile()

    with pytest.raises(SeatedFault, match=r"row 0: Plays's act returned an object of the type Hostile"):
        seated(one_game_at_a_time(Plays, "features")).act(np.zeros((ROWS, 96)))

    class Falls(Plays):
        def act(self, seen):
            raise Unsaid

    with pytest.raises(SeatedFault, match="row 0: Falls's act raised Unsaid"):
        seated(one_game_at_a_time(Falls, "features")).act(np.zeros((ROWS, 96)))


@pytest.mark.parametrize("observation", ["pixels", None, 3, b"state"])
def test_an_observation_that_there_is_not(observation):
    agent = Acts(None)
    agent.observation = observation
    with pytest.raises(SeatedFault, match="the agent's observation is"):
        seated(agent)


class Turns(Acts):
    """Asks for something else once the episode has started."""

    def __init__(self, wish):
        super().__init__(np.full(2, 4))
        self.observation, self.wish = "lossless", wish

    def reset(self, layout, seats, seeds):
        if self.wish is None:
            del self.observation
        else:
            self.observation = self.wish

    def act(self, observations):
        self.seen = observations
        return self.answer


@pytest.mark.parametrize("wish", ["state", "pixels", "features", None])
def test_what_an_agent_sees_is_settled_when_it_sits_down(wish):
    agent = Turns(wish)
    play_episodes("cramped_room", agents=(agent, Acts(np.full(2, 4))), episodes=2, horizon=3)
    assert agent.seen.shape == (2, 22, 4, 5)


def test_every_agent_is_given_states_of_its_own():
    seen = []

    class Keeps(Acts):
        observation = "state"

        def act(self, observations):
            seen.append(observations)
            return self.answer

    stays = np.full(2, 4)
    play_episodes("cramped_room", agents=(Keeps(stays), Keeps(stays)), episodes=2, horizon=2)
    first, second, later, _ = seen
    assert first == second
    assert first is not second
    for mine, theirs, next_one in zip(first, second, later, strict=True):
        assert mine is not theirs
        assert mine.objects is not theirs.objects
        assert mine is not next_one


@pytest.mark.parametrize("name", [*OBSERVATIONS, "state"])
@pytest.mark.parametrize("rows", [[0, 1, 2], [1, 2], [2], [3, 0]])
def test_views_are_the_rows_of_the_agent_and_nobody_elses_memory(name, rows):
    kitchens = Kitchens("coordination_ring", 4, history=3)
    kitchens.reset(seed=0)
    seats = np.array([0, 1, 1, 0])
    agent = Acts(None)
    agent.observation = name
    one = Seated(agent, "one", np.array(rows), seats[rows])
    both, own = Views(kitchens), Views(kitchens, seats)
    for _ in range(2):
        for views in (both, own):
            views.renew()
        if name == "state":
            assert both.of(one) == own.of(one) == [kitchens.state(row) for row in rows]
        else:
            expected = kitchens.observe(name)[rows, seats[rows]]
            np.testing.assert_array_equal(both.of(one), expected)
            np.testing.assert_array_equal(own.of(one), expected)
            kept = both.of(one)
            kept[...] = 1
            np.testing.assert_array_equal(both.of(one), expected)
        kitchens.step(np.array([[0, 2], [3, 1], [5, 2], [1, 3]]))


def test_an_observation_that_this_kitchen_lacks():
    agent = Acts(None)
    agent.observation = "lossless"
    with pytest.raises(OvercookedBenchError, match="no tomato channels"):
        seated(agent).fit(Kitchens("XXPXX\nT1 2O\nX   X\nXDXSX", ROWS))

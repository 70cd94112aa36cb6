"""The checks for users' own suites find what would spoil a score, and nothing in agents that keep the contract."""

import numpy as np
import pytest

from overcooked_bench import UnknownLayout, load_agent
from overcooked_bench.agents import sample_actions
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.testing import CheckFailed, check_agent, check_layout, check_submission


class Draws:
    """Draws by the row's seed, as it should."""

    observation = "lossless"

    def reset(self, layout, seats, seeds):
        self.seats, self.seeds, self.step = seats, seeds, 0

    def act(self, observations):
        self.step += 1
        return sample_actions(np.full((len(self.seeds), 6), 1 / 6), self.seeds, self.step)


class Global(Draws):
    def act(self, observations):
        return np.random.randint(0, 6, len(observations))  # noqa: NPY002


class Shared(Draws):
    """Draws for all rows from one generator."""

    def reset(self, layout, seats, seeds):
        super().reset(layout, seats, seeds)
        self.random = np.random.default_rng(0)

    def act(self, observations):
        return self.random.integers(0, 6, len(observations))


class Remembers(Draws):
    """Goes on where the last episode ended."""

    count = 0

    def act(self, observations):
        self.count += 1
        return np.full(len(observations), self.count % 3)


class Compares(Draws):
    """Acts by what it sees in all rows together."""

    def act(self, observations):
        return np.full(len(observations), int(observations.sum(dtype=np.int64)) % 6)


class ByPlace(Draws):
    def act(self, observations):
        return np.minimum(np.arange(len(observations)), 5)


class Seven(Draws):
    def act(self, observations):
        return np.full(len(observations), 7)


@pytest.mark.parametrize("name", [*SCRIPTED, "script:helper"])
def test_our_own_agents_pass(name):
    check_agent(name)


@pytest.mark.parametrize("layout", ["counter_circuit", "XXPXX\nT1 2O\nX   X\nXDXSX"])
def test_layouts_of_every_kind_are_played(layout):
    check_agent({"does": "carry"} if "\n" not in layout else "greedy", layout)
    agent = Draws()
    agent.observation = "lossless26"
    check_agent(agent, layout)


@pytest.mark.parametrize(
    ("agent", "message"),
    [
        (Global(), "rows 0 and 5, which have the same start, seat and seed, act differently.*sample_actions"),
        (Shared(), "rows 0 and 5"),
        (ByPlace(), "rows 0 and 5"),
        (Remembers(), "played differently the second time.*start from nothing"),
        (Compares(), "played differently without the others.*its own observation"),
        (Seven(), "the action 7 in row 0; return 6 whole numbers"),
        (object(), "has no method reset and no act"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_spoils_a_score_is_found(agent, message):
    with pytest.raises(CheckFailed, match=message) as failure:
        check_agent(agent)
    assert isinstance(failure.value, AssertionError)


def test_a_layout_that_the_agent_does_not_play_is_not_its_fault():
    with pytest.raises(UnknownLayout):
        check_agent("dev-v1/cramped_room/sp-0", "coordination_ring")


SUBMISSION = """
import numpy as np
from overcooked_bench import UnknownLayout
from overcooked_bench.agents import sample_actions

TRAINING_SEEDS = 2
made = []

class Agent:
    observation = "features"

    def reset(self, layout, seats, seeds):
        self.seeds, self.step = seeds, 0

    def act(self, observations):
        self.step += 1
        return {act}

def make_agent(layout, training_seed):
    {make}
    made.append(layout)
    agent = Agent()
    agent.number = len(made)
    return agent
"""
DRAW = "sample_actions(np.full((len(self.seeds), 6), 1 / 6), self.seeds, self.step)"


@pytest.mark.parametrize(
    ("act", "make", "message"),
    [
        (DRAW, "if layout != 'cramped_room': raise UnknownLayout(layout)", None),
        (DRAW, "raise UnknownLayout(layout)", "declines every layout"),
        (DRAW, "raise KeyError('weights')", r"mine\.py, line \d+: KeyError: 'weights'"),
        ("np.full(len(observations), self.number % 6)", "pass", "made again plays differently.*module level"),
        ("np.random.randint(0, 6, len(observations))", "pass", "rows 0 and 5"),
    ],
)
def test_submissions_are_checked(tmp_path, act, make, message):
    file = tmp_path / "mine.py"
    file.write_text(SUBMISSION.format(act=act, make=make))
    if message is None:
        check_submission(file)
    else:
        with pytest.raises(CheckFailed, match=message):
            check_submission(file, layouts=["cramped_room", "bottleneck"])


def test_a_submission_that_is_none():
    with pytest.raises(CheckFailed, match="no such file"):
        check_submission("nonesuch.py")


@pytest.mark.parametrize("layout", [*layout_names(), "XXPXX\nT1 2O\nX   X\nXDXSX"])
def test_shipped_layouts_pass(layout):
    check_layout(layout)


def test_a_layout_nobody_can_cook_in(tmp_path):
    with pytest.raises(CheckFailed, match="no soup was served"):
        check_layout("XPXXXXXX\nO1    2D\nXXXXXXSX")
    file = tmp_path / "mine.layout"
    file.write_text("XXPXX\nO  2O\nX1  X\nXDXXX\n")
    with pytest.raises(LayoutError):
        check_layout(file)


def test_an_agent_may_be_made_and_checked_where_it_stands():
    check_agent(load_agent("greedy", "forced_coordination"), layout="forced_coordination")

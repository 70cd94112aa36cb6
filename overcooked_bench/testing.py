"""Conformance checks for your own test suite: whether an agent, a submission or a layout can be scored.

Each check returns None or raises `CheckFailed`, an AssertionError that says what went wrong and what to do about it.

Example:
    ```python
    from overcooked_bench.testing import check_agent, check_layout, check_submission

    def test_my_agent():
        check_agent(MyAgent(), layout="coordination_ring")

    def test_my_submission():
        check_submission("my_agent.py", layouts=["cramped_room", "forced_coordination"])

    def test_my_kitchen():
        check_layout("my_kitchen.layout")
    ```

Axes: B rows (simultaneous episodes), T steps.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, Reference, UnknownLayout
from overcooked_bench.agents.catalogue import find, load_agent
from overcooked_bench.agents.seated import Seated, SeatedFault, Views
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.checks import check_agent as check_shape
from overcooked_bench.errors import AgentFault
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout, layout_names
from overcooked_bench.kitchen.observations.registry import history_for

ROWS: Final = 6
STEPS: Final = 40
EPISODES: Final = 20
_TWIN: Final = ROWS - 1  # this row is row 0 once more: same start, seat and seed


class CheckFailed(AgentFault, AssertionError):
    """A check failed; the message says what went wrong and what to do."""


def check_agent(agent: Agent | Reference, layout: str = "cramped_room", steps: int = STEPS) -> None:
    """Checks that an agent plays as scoring needs it.

    It plays short episodes with a partner that acts at random, in batches of several sizes and orders:

    - it has `observation`, `reset` and `act`, and every answer is one action per row;
    - a row plays the same whatever else is in the batch, and wherever in it;
    - a row's play depends only on its seed, its seat and what it sees: not on global random number generators, nor on
      earlier episodes.

    Args:
        agent: The agent, or what `load_agent` takes.
        layout: A shipped layout's name, a grid's text or a `.layout` file.
        steps: Length of the episodes.

    Raises:
        CheckFailed: The agent does not keep one of these.
        UnknownLayout: The agent does not play this layout; choose one that it plays.
    """
    plan = Layout.load(layout)
    if isinstance(agent, str | Path | Mapping):
        agent = load_agent(agent, plan.name)
    try:
        check_shape(agent, type(agent).__name__)
    except AgentError as error:
        raise CheckFailed(str(error)) from None
    play = _Play(agent, plan, steps)
    rows = np.arange(ROWS)
    whole = play(rows)
    twins = f"rows 0 and {_TWIN}, which have the same start, seat and seed"
    _same(whole[:, 0], whole[:, _TWIN], f"{twins}, act differently", _DRAW)
    _same(whole, play(rows), "the same batch is played differently the second time", _RESET)
    turned = play(rows[::-1])[:, ::-1]
    _same(whole, turned, "a batch is played differently in the reverse order", _ROWS)
    for part in ([0], [3], [1, 4], [5, 2, 0]):
        _same(whole[:, part], play(np.array(part)), f"the rows {part} are played differently without the others", _ROWS)


def check_submission(path: str | Path, layouts: Sequence[str] | None = None, steps: int = STEPS) -> None:
    """Checks that a submission can be scored.

    Its agents are made for every layout and training seed and pass `check_agent`. They are made twice, since each block
    of a score makes its agent again: both have to play the same, or the score would depend on what was played before.

    Args:
        path: A Python file, a folder with `agent.py`, or `file.py:function`.
        layouts: Layouts; all that ship by default. Those that it declines with UnknownLayout are left out.
        steps: Length of the episodes.

    Raises:
        CheckFailed: It cannot be loaded, declines all layouts, or one of its agents does not keep the contract.
    """
    try:
        found, known = find(path), 0
        for layout in layout_names() if layouts is None else layouts:
            for seed in range(found.training_seeds):
                try:
                    first = found.make(layout, seed)
                    check_agent(first, layout, steps)
                except UnknownLayout:
                    continue
                known += 1
                plan, rows, again = Layout.load(layout), np.arange(ROWS), found.make(layout, seed)
                _same(
                    *(_Play(first, plan, steps)(rows), _Play(again, plan, steps)(rows)),
                    f"{layout}, training seed {seed}: an agent that is made again plays differently",
                    "keep nothing at module level that changes while agents are made or play",
                )
    except AgentError as error:
        raise CheckFailed(str(error)) from None
    if not known:
        raise CheckFailed(f"{path}: it declines every layout; name the layouts that it plays with layouts=[...]")


def check_layout(grid_or_file: str | Path | Layout, cooking: str = "auto") -> None:
    """Checks that a layout can be played: it is legal, can be mirrored, and two `greedy` agents serve soups in it.

    Args:
        grid_or_file: A grid's text, a `.layout` file, a shipped name or a Layout.
        cooking: "auto" or "manual".

    Raises:
        LayoutError: The layout is not legal; says which line and cell.
        CheckFailed: No soup is ever served.
    """
    layout = Layout.load(grid_or_file)
    for plan in (layout, layout.mirrored()):
        kitchens = Kitchens(plan, EPISODES, cooking=cooking)
        kitchens.reset(seed=0)
        rows, seeds = np.arange(EPISODES), np.arange(EPISODES, dtype=np.uint64)
        pair = [Seated(load_agent("greedy", plan.name), "greedy", rows, np.full(EPISODES, seat)) for seat in range(2)]
        for cook in pair:
            cook.reset(plan.name, seeds)
        views, served = Views(kitchens), 0.0
        for _ in range(kitchens.horizon):
            views.renew()
            served += kitchens.step(np.stack([cook.act(views.of(cook)) for cook in pair], axis=1)).soup_reward.sum()
        if not served:
            grid = "\n".join(plan.rows)
            raise CheckFailed(
                f"no soup was served in {EPISODES} episodes of two greedy agents on\n{grid}\nIs a corridor so narrow "
                "that chefs cannot pass each other? Widen it, or put what they need on both sides of it"
            )


_DRAW: Final = "draw with overcooked_bench.agents.sample_actions(probabilities, seeds, step)"
_ROWS: Final = f"let a row depend on its own observation, seat and seed alone; {_DRAW}"
_RESET: Final = f"start from nothing at reset(), and use no global generator; {_DRAW}"


class _Play:
    """Plays chosen rows of one fixed set of episodes: start states, seats, seeds and the partner's actions.

    Args:
        agent: The agent.
        layout: The layout.
        steps: T.
    """

    def __init__(self, agent: Agent, layout: Layout, steps: int) -> None:
        random = np.random.default_rng(0)
        self._agent, self._layout = agent, layout
        self._starts = random.integers(2**63, size=ROWS).astype(np.uint64)
        self._seeds = random.integers(2**63, size=ROWS).astype(np.uint64)
        self._seats = np.arange(ROWS) % 2
        self._partner = random.integers(NUM_ACTIONS, size=(steps, ROWS))
        for drawn in (self._starts, self._seeds, self._seats, self._partner.T):
            drawn[_TWIN] = drawn[0]

    def __call__(self, rows: NDArray[np.int64]) -> NDArray[np.int64]:
        """Plays these rows: the agent's actions (T, B)."""
        mine = Seated(self._agent, type(self._agent).__name__, np.arange(len(rows)), self._seats[rows])
        history = history_for([mine.observation])
        kitchens = Kitchens(self._layout, len(rows), horizon=len(self._partner) + 1, history=history)
        kitchens.reset(seed=self._starts[rows])
        actions, joint = np.empty((len(self._partner), len(rows)), np.int64), np.empty((len(rows), 2), np.int64)
        try:
            mine.fit(kitchens)
            mine.reset(self._layout.name, self._seeds[rows])
            views = Views(kitchens)
            for step, partner in enumerate(self._partner):
                views.renew()
                actions[step] = mine.act(views.of(mine))
                joint[mine.rows, mine.seats], joint[mine.rows, 1 - mine.seats] = actions[step], partner[rows]
                kitchens.step(joint)
        except SeatedFault as fault:
            raise CheckFailed(str(fault)) from fault
        return actions


def _same(expected: NDArray[np.int64], found: NDArray[np.int64], what: str, remedy: str) -> None:
    wrong: Any = np.argwhere(expected != found)
    if len(wrong):
        raise CheckFailed(f"{what} (first at step {wrong[0][0]}); {remedy}")

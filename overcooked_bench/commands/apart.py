"""Plays submissions in a process of their own, so that one that exits, crashes or hangs does not end the command."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from overcooked_bench.agents.agent import AgentFactory
from overcooked_bench.agents.catalogue import find, runs_code
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.evaluation.games.engines import open_engine
from overcooked_bench.scenarios.errors import ScenarioFault

Call = Callable[..., Any]
"""Calls a function as `call(function, *args, **options)`: the function gets the agent's `make_agent` first."""


@contextmanager
def agent_apart(reference: str, mode: str, act_timeout: float) -> Iterator[Call]:
    """Finds an agent, in a process of its own if it is a submission, which ends with the context.

    Args:
        reference: What `find` takes.
        mode: How frozen policies act.
        act_timeout: Seconds that one call of a submission may take.

    Raises:
        AgentError: There is no such agent; raised at the first call.
        ScenarioFault: The agent broke the contract, or its process ended or was overdue.
    """
    with open_engine("local", 1, apart=runs_code(reference)) as engine:

        def call(function: Callable[..., Any], *args: Any, **options: Any) -> Any:
            (result,) = engine.map(_call, [_Task(reference, mode, function, args, options)], _lost, act_timeout)
            return result

        yield call


@dataclass(frozen=True)
class _Task:
    """A call; the function is importable, and all of it can be pickled."""

    reference: str
    mode: str
    function: Callable[..., Any]
    args: tuple[Any, ...]
    options: Mapping[str, Any]


def _call(task: _Task) -> Any:
    with calling("loading", LOADING):
        make_agent = _maker(task.reference, task.mode)
    return task.function(make_agent, *task.args, **task.options)


@lru_cache(maxsize=1)
def _maker(reference: str, mode: str) -> AgentFactory:
    return find(reference, mode=mode).make  # type: ignore[arg-type]


def _lost(task: _Task, why: str) -> Any:
    raise ScenarioFault(f"{task.reference}: {why}")

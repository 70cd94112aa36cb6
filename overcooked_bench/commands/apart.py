"""Plays submissions in a process of their own, so that one that exits, crashes or hangs does not end the command."""

import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from overcooked_bench.agents.agent import AgentFactory
from overcooked_bench.agents.catalogue import find, runs_code
from overcooked_bench.agents.isolation.settings import How, Isolation, isolate
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.evaluation.games.engines import open_engine
from overcooked_bench.scenarios.errors import ScenarioFault

Call = Callable[..., Any]
"""Calls a function as `call(function, *args, **options)`: the function gets the agent's `make_agent` first."""


@contextmanager
def agent_apart(reference: str, mode: str, act_timeout: float, how: How | None = None) -> Iterator[Call]:
    """Finds an agent, in a process of its own if it is a submission, which ends with the context.

    Args:
        reference: What `find` takes.
        mode: How frozen policies act.
        act_timeout: Seconds that one call of a submission may take.
        how: How a submission is isolated (see `isolate`); None for not at all.

    Raises:
        IsolationError: The submission cannot be isolated as it should be.
        AgentError: There is no such agent; raised at the first call.
        ScenarioFault: The agent broke the contract, or its process ended or was overdue.
    """
    untrusted = runs_code(reference)
    isolation = isolate(how, act_timeout) if how and untrusted else None
    if isolation and isolation.why:
        print(f"overcooked-bench: warning: {isolation.sentence}", file=sys.stderr)
    patience = None if isolation else act_timeout
    with open_engine("local", 1, apart=untrusted) as engine:

        def call(function: Callable[..., Any], *args: Any, **options: Any) -> Any:
            (result,) = engine.map(_call, [_Task(reference, mode, function, args, options, isolation)], _lost, patience)
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
    isolation: Isolation | None


def _call(task: _Task) -> Any:
    with calling("loading", LOADING):
        make_agent = _maker(task.reference, task.mode, task.isolation)
    return task.function(make_agent, *task.args, **task.options)


@lru_cache(maxsize=1)
def _maker(reference: str, mode: str, isolation: Isolation | None) -> AgentFactory:
    return find(reference, mode=mode, isolation=isolation).make  # type: ignore[arg-type]


def _lost(task: _Task, why: str) -> Any:
    raise ScenarioFault(f"{task.reference}: {why}")

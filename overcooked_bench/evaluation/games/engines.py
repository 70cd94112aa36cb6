"""Where blocks are played: in this process, in worker processes, or on a cluster by Dask or Ray.

Only the parent writes anything; results come back in any order.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, Final, Protocol, TypeVar

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.workers import Crew

Task = TypeVar("Task")
Result = TypeVar("Result")

ENGINES: Final = ("local", "dask", "ray")
MOST_DEFAULT_WORKERS: Final = 4  # each needs about 400 MB, most of it torch and numba
ATTEMPTS: Final = 3  # of a task on a cluster, which loses workers for reasons of its own, too
DIED: Final = f"the worker process died {ATTEMPTS} times"


class EngineError(WrongUse):
    """An engine cannot be used here; the message says what to install."""


def default_workers() -> int:
    """Returns the number of usable cores, four at most."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(cores, MOST_DEFAULT_WORKERS)


class Engine(Protocol):
    """Where functions are applied to tasks."""

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        """Applies a function to tasks and yields the results as they come.

        Args:
            function: Importable by name, and pure: it may run anywhere.
            tasks: Small and picklable; read a few ahead at most.
            lost: Makes the result of a task whose process died or was overdue, from the task and what happened in
                words; the other tasks go on. `refuse` raises an EngineError.
            patience: Seconds that one call of a submission's code may take (see `agents.watch`); worker processes of
                this machine only.
        """


@contextmanager
def open_engine(name: str, workers: int, apart: bool = False) -> Iterator[Engine]:
    """Opens an engine; its processes end with the context.

    Args:
        name: "local"; "dask" uses the cluster that DASK_SCHEDULER_ADDRESS names, or a local one; "ray" the cluster that
            RAY_ADDRESS names, or a local one.
        workers: Processes.
        apart: Whether one local worker is a process of its own too, as it should be for code that may end or block its
            process; otherwise it is this process.

    Raises:
        EngineError: An unknown engine, or one that is not installed.
    """
    if name not in ENGINES:
        raise EngineError(f"no engine named {name!r}; choose one of {', '.join(ENGINES)}")
    if workers < 1:
        raise EngineError(f"workers is {workers}; give a number from 1")
    if name == "local":
        opened: AbstractContextManager[Engine] = Crew(workers) if apart or workers > 1 else nullcontext(_Here())
    else:
        opened = _dask(workers) if name == "dask" else _ray(workers)
    with opened as engine:
        yield engine


def map_tasks(
    function: Callable[[Task], Result], tasks: Iterable[Task], workers: int = 1, engine: str = "local"
) -> Iterator[Result]:
    """Applies a function to tasks in an engine of its own; see `Engine.map`.

    Raises:
        EngineError: The engine cannot be used, or a process died.
    """
    with open_engine(engine, workers) as opened:
        yield from opened.map(function, tasks, refuse)


def refuse(task: object, why: str) -> Any:
    """Raises an EngineError for a task that came to nothing."""
    raise EngineError(
        f"{why}; finished work is kept, and the same command goes on from there. Try --workers 1, which needs the "
        "least memory"
    )


class _Here:
    """This process."""

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        return map(function, tasks)


@contextmanager
def _dask(workers: int) -> Iterator[Engine]:
    if find_spec("distributed") is None:
        raise EngineError("--engine dask needs Dask: pip install 'overcooked-bench[dask]'")
    distributed, config = import_module("distributed"), import_module("dask").config
    address = config.get("scheduler-address", None)
    settings = (
        {"address": address} if address else {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    )
    with config.set({"distributed.scheduler.allowed-failures": ATTEMPTS - 1}), distributed.Client(**settings) as client:
        yield _Dask(distributed, client)


class _Dask:
    """A Dask cluster.

    Args:
        distributed: The library.
        client: Connected.
    """

    def __init__(self, distributed: Any, client: Any) -> None:
        self._distributed, self._client = distributed, client

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        remaining, given, finished = iter(tasks), {}, self._distributed.as_completed()

        def give(count: int) -> None:
            for task in islice(remaining, count):
                future = self._client.submit(function, task, pure=False)
                given[future.key] = task
                finished.add(future)

        give(2 * max(1, sum(self._client.nthreads().values())))
        for future in finished:
            task, error = given.pop(future.key), future.exception()
            if isinstance(error, self._distributed.scheduler.KilledWorker):
                yield lost(task, DIED)
            elif error is not None:
                raise error
            else:
                yield future.result()
            give(1)


@contextmanager
def _ray(workers: int) -> Iterator[Engine]:
    if find_spec("ray") is None:
        raise EngineError("--engine ray needs Ray: pip install 'overcooked-bench[ray]'")
    ray = import_module("ray")
    ours = not ray.is_initialized()
    if ours:
        local = {} if os.environ.get("RAY_ADDRESS") else {"num_cpus": workers, "include_dashboard": False}
        ray.init(log_to_driver=False, **local)
    try:
        yield _Ray(ray, import_module("ray.exceptions"))
    finally:
        if ours:
            ray.shutdown()


class _Ray:
    """A Ray cluster.

    Args:
        ray: The library, connected.
        errors: Its exceptions.
    """

    def __init__(self, ray: Any, errors: Any) -> None:
        self._ray, self._errors = ray, errors

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        call = self._ray.remote(max_retries=ATTEMPTS - 1)(function)
        remaining, most = iter(tasks), 2 * max(1, int(self._ray.cluster_resources().get("CPU", 1)))
        given = {call.remote(task): task for task in islice(remaining, most)}
        died = self._errors.WorkerCrashedError, self._errors.OutOfMemoryError, self._errors.NodeDiedError
        while given:
            (reference,), _ = self._ray.wait(list(given), num_returns=1)
            task = given.pop(reference)
            try:
                result = self._ray.get(reference)
            except died:
                result = lost(task, DIED)
            except self._errors.RayTaskError as error:
                raise error.cause from None
            yield result
            given |= {call.remote(task): task for task in islice(remaining, 1)}

"""Where blocks are played: in this process, in worker processes, or on a cluster by Dask or Ray.

Only the parent writes anything; results come back in any order.
"""

import os
import secrets
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, Final, Protocol, TypeVar

from overcooked_bench.evaluation.games.apart import EngineError, Lost, Session, play_apart, versions
from overcooked_bench.evaluation.games.workers import Crew

Task = TypeVar("Task")
Result = TypeVar("Result")

ENGINES: Final = ("local", "dask", "ray")
MOST_DEFAULT_WORKERS: Final = 4  # each needs about 400 MB, most of it torch and numba
ATTEMPTS: Final = 3  # of a task on a cluster that loses the workers it is given to
DIED: Final = "the cluster lost each worker that had it"
_FIRST_WORKER: Final = 60.0  # seconds to wait for it
_ADDRESS: Final = "DASK_SCHEDULER_ADDRESS and RAY_ADDRESS say where a cluster is; without them a local one is started"


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
            patience: Seconds that one call of a submission's code may take (see `agents.watch`); not in this process.
        """


@contextmanager
def open_engine(name: str, workers: int, apart: bool = False) -> Iterator[Engine]:
    """Opens an engine; its processes end with the context.

    Args:
        name: "local"; "dask" uses the cluster that DASK_SCHEDULER_ADDRESS names, or a local one; "ray" the cluster that
            RAY_ADDRESS names, or a local one.
        workers: Processes.
        apart: Whether it is code that may end or block its process, or change it for others: one local worker is a
            process of its own then, too, and a cluster's processes are not those of other runs.

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
        name_of_session = secrets.token_hex(8) if apart else "trusted"
        session = Session(name_of_session, os.getcwd(), versions())
        opened = _dask(workers, session) if name == "dask" else _ray(workers, session)
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
def _dask(workers: int, session: Session) -> Iterator[Engine]:
    if find_spec("distributed") is None:
        raise EngineError("--engine dask needs Dask: pip install 'overcooked-bench[dask]'")
    distributed, config = import_module("distributed"), import_module("dask").config
    address = config.get("scheduler-address", None)
    settings = (
        {"address": address} if address else {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    )
    try:
        client = distributed.Client(**settings)
    except (OSError, ValueError) as error:
        raise EngineError(f"--engine dask: no scheduler answers at {address} ({error}); {_ADDRESS}") from error
    with client:
        try:
            client.wait_for_workers(1, timeout=_FIRST_WORKER)
        except TimeoutError:
            raise EngineError(f"--engine dask: the cluster at {address} has no worker; start one there") from None
        yield _Dask(distributed, client, session)


class _Dask:
    """A Dask cluster.

    Args:
        distributed: The library.
        client: Connected.
        session: What all tasks share.
    """

    def __init__(self, distributed: Any, client: Any, session: Session) -> None:
        self._distributed, self._client, self._session = distributed, client, session

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        remaining, finished = iter(tasks), self._distributed.as_completed()
        session, given = self._session._replace(patience=patience), dict[Any, Task]()

        def give() -> None:
            most = 2 * max(1, sum(self._client.nthreads().values()))  # a cluster grows and shrinks
            for task in islice(remaining, max(0, most - len(given))):
                future = self._client.submit(play_apart, session, function, task, pure=False)
                given[future.key] = task
                finished.add(future)

        give()
        for future in finished:
            task, error = given.pop(future.key), future.exception()
            if isinstance(error, self._distributed.scheduler.KilledWorker):
                yield lost(task, DIED)
            elif error is not None:
                raise _told(error)
            else:
                result = future.result()
                yield lost(task, result.why) if isinstance(result, Lost) else result
            give()


@contextmanager
def _ray(workers: int, session: Session) -> Iterator[Engine]:
    if find_spec("ray") is None:
        raise EngineError("--engine ray needs Ray: pip install 'overcooked-bench[ray]'")
    os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")  # otherwise `uv run` makes an environment per worker
    ray = import_module("ray")
    ours = not ray.is_initialized()
    if ours:
        local = {} if os.environ.get("RAY_ADDRESS") else {"num_cpus": workers, "include_dashboard": False}
        try:
            ray.init(log_to_driver=False, **local)
        except ConnectionError as error:
            raise EngineError(f"--engine ray: no cluster answers ({error}); {_ADDRESS}") from error
    try:
        yield _Ray(ray, import_module("ray.exceptions"), session)
    finally:
        if ours:
            ray.shutdown()


class _Ray:
    """A Ray cluster.

    Args:
        ray: The library, connected.
        errors: Its exceptions.
        session: What all tasks share.
    """

    def __init__(self, ray: Any, errors: Any, session: Session) -> None:
        self._ray, self._errors, self._session = ray, errors, session

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Iterator[Result]:
        call = self._ray.remote(max_retries=ATTEMPTS - 1)(play_apart)
        remaining, given = iter(tasks), dict[Any, Task]()
        session = self._session._replace(patience=patience)

        def give() -> None:
            most = 2 * max(1, int(self._ray.cluster_resources().get("CPU", 1)))
            for task in islice(remaining, max(0, most - len(given))):
                given[call.remote(session, function, task)] = task

        died = self._errors.WorkerCrashedError, self._errors.OutOfMemoryError, self._errors.NodeDiedError
        give()
        while given:
            (reference,), _ = self._ray.wait(list(given), num_returns=1)
            task = given.pop(reference)
            try:
                result = self._ray.get(reference)
            except died:
                yield lost(task, DIED)
            except self._errors.RayTaskError as error:
                raise _told(error.cause) from None
            else:
                yield lost(task, result.why) if isinstance(result, Lost) else result
            give()


def _told(error: BaseException) -> BaseException:
    """Returns the error to raise for one that a worker of a cluster sent."""
    if isinstance(error, ModuleNotFoundError):
        return EngineError(f"a worker of the cluster failed ({error}); install the same packages there as here")
    return error

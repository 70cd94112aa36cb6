"""Where blocks are played: in this process, in worker processes, or on a cluster by Dask or Ray.

Only the parent writes anything; results come back in any order.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures.process import BrokenProcessPool
from contextlib import AbstractContextManager, contextmanager
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, Final, TypeVar

from overcooked_bench.errors import WrongUse

Task = TypeVar("Task")
Result = TypeVar("Result")

ENGINES: Final = ("local", "dask", "ray")
MOST_DEFAULT_WORKERS: Final = 4  # each needs about 400 MB, most of it torch and numba


class EngineError(WrongUse):
    """An engine cannot be used here; the message says what to install."""


def default_workers() -> int:
    """Gives the number of usable cores, four at most."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(cores, MOST_DEFAULT_WORKERS)


def map_tasks(
    function: Callable[[Task], Result], tasks: Iterable[Task], workers: int = 1, engine: str = "local"
) -> Iterator[Result]:
    """Applies a function to tasks and yields the results as they come.

    Args:
        function: Importable by name, and pure: it may run anywhere.
        tasks: Small and picklable; read a few ahead, from a thread of this process.
        workers: Processes; one local worker is this process.
        engine: "local"; "dask" uses the cluster that DASK_SCHEDULER_ADDRESS names, or a local one; "ray" the cluster
            that RAY_ADDRESS names, or a local one.

    Raises:
        EngineError: An unknown engine, one that is not installed, or a local worker process that died.
    """
    if engine not in ENGINES:
        raise EngineError(f"no engine named {engine!r}; choose one of {', '.join(ENGINES)}")
    if workers < 1:
        raise EngineError(f"workers is {workers}; give a number from 1")
    if engine == "local" and workers == 1:
        yield from map(function, tasks)
        return
    import joblib

    with _backend(engine, workers):
        calls = (joblib.delayed(function)(task) for task in tasks)
        if engine == "ray":  # its joblib backend has no generators: a few rounds of tasks at a time
            while some := list(islice(calls, 4 * workers)):
                yield from joblib.Parallel(n_jobs=workers)(some)
            return
        try:
            yield from joblib.Parallel(n_jobs=workers, batch_size=1, return_as="generator_unordered")(calls)
        except BrokenProcessPool as error:
            raise EngineError(
                "a worker process died: out of memory, or the agent ended it; finished blocks are kept, and the same "
                "command goes on from there. Try --workers 1, which needs the least memory"
            ) from error


def _backend(engine: str, workers: int) -> AbstractContextManager[Any]:
    import joblib

    if engine == "local":
        context: AbstractContextManager[Any] = joblib.parallel_config(backend="loky", inner_max_num_threads=1)
        return context
    return _dask(workers) if engine == "dask" else _ray()


@contextmanager
def _dask(workers: int) -> Iterator[None]:
    if find_spec("distributed") is None:
        raise EngineError("--engine dask needs Dask: pip install 'dask[distributed]'")
    import joblib

    client, config = import_module("distributed").Client, import_module("dask").config
    address = config.get("scheduler-address", None)
    settings = (
        {"address": address} if address else {"n_workers": workers, "threads_per_worker": 1, "dashboard_address": None}
    )
    with client(**settings), joblib.parallel_config(backend="dask"):
        yield


@contextmanager
def _ray() -> Iterator[None]:
    if find_spec("ray") is None:
        raise EngineError("--engine ray needs Ray: pip install ray")
    import joblib

    import_module("ray.util.joblib").register_ray()
    with joblib.parallel_config(backend="ray"):
        yield

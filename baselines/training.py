"""One training run from settings to its summary: what `overcooked-bench train` does after parsing its arguments."""

import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any, Final

import msgspec

from overcooked_bench.estimate import t_interval
from overcooked_bench.kitchen.layout import Layout

from .learning.freeze import Returns
from .learning.settings import Settings
from .methods import find_method
from .presets import config_names, load_config
from .running.place import EVERY, label, open_place, write_record
from .running.run import Outcome
from .running.seeds import USER, derive_seed

SUMMARY: Final = "summary.json"
"""The summary, in the run's folder."""


class Points(msgspec.Struct, frozen=True):
    """Mean return in points per episode with its 95 % interval over episodes."""

    mean: float
    low: float | None
    high: float | None
    episodes: int


class Summary(msgspec.Struct, frozen=True, kw_only=True):
    """The outcome of a training run, including all its parts.

    Attributes:
        method: How it was trained.
        configuration: Name of the method's configuration.
        layout: The layout's name.
        seed: Training seed that the user gave.
        with_itself: Self-play return of the policy.
        with_partners: Return with the partners that it was trained with; None if it had none of its own.
        steps: Joint steps.
        seconds: Wall-clock of training.
        restarts: How often the divergence check restarted it.
    """

    method: str
    configuration: str
    layout: str
    seed: int
    with_itself: Points
    with_partners: Points | None
    steps: int
    seconds: float
    restarts: int


def default_folder(method: str, configuration: str, settings: Settings) -> Path:
    """Returns the folder of a run for which none is named; the default configuration is not mentioned."""
    parts = (method, configuration.replace(",", "-"), label(settings.layout), str(settings.seed))
    return Path("runs") / "-".join(filter(None, parts))


def train_method(
    method: str, configuration: str, settings: Settings, folder: Path, resume: bool = False, every: int = EVERY
) -> tuple[Outcome, Summary] | None:
    """Trains by a method and writes `summary.json`.

    Args:
        method: A method's name.
        configuration: Name of the configuration.
        settings: The method's settings.
        folder: Folder that everything is written to.
        resume: Whether to go on from the folder's checkpoint.
        every: Joint steps between checkpoints.

    Returns:
        What came of it, or None if it was interrupted and saved.

    Raises:
        CheckpointError: The folder holds another run, nothing to resume, or something damaged.
        WrongUse: The settings do not fit the layout, the machine or the partners.
    """
    layout = Layout.load(settings.layout).name
    place = open_place(folder, derive_seed(USER, layout, method, settings.seed), resume, every)
    outcome: Outcome | None = find_method(method).train(settings, place)
    if outcome is None:
        return None
    summary = Summary(
        method=method,
        configuration=configuration,
        layout=layout,
        seed=settings.seed,
        with_itself=_points(outcome.returns),
        with_partners=None if outcome.with_partners is None else _points(outcome.with_partners),
        steps=outcome.total_steps,
        seconds=round(outcome.total_seconds, 1),
        restarts=outcome.total_restarts,
    )
    write_record(folder / SUMMARY, msgspec.to_builtins(summary))
    return outcome, summary


def train(
    method: str, configuration: str = "", *, folder: str | Path | None = None, resume: bool = False, **settings: Any
) -> tuple[Outcome, Summary]:
    """Trains a baseline as `overcooked-bench train` does; its progress goes to standard error.

    Args:
        method: A method's name.
        configuration: One of its configurations, or several joined by commas; by default its first one.
        folder: Folder that everything is written to; by default the one of the command line.
        resume: Whether to go on from the folder's checkpoint.
        settings: Settings that replace the configuration's, such as `layout="cramped_room"` and `seed=1`;
            `overcooked-bench train METHOD --help` lists them.

    Returns:
        The frozen policy with its returns, and the summary that was written.

    Raises:
        KeyboardInterrupt: Stopped by Ctrl-C; the run is saved, and `resume=True` goes on with it.
        WrongUse: No such method, configuration or setting, or the folder holds another run.

    Example:
        ```python
        from overcooked_bench.baselines.training import train

        outcome, summary = train("best-response", layout="cramped_room", partners=("train-v1",), seed=1)
        print(outcome.files.weights, summary.with_partners)
        ```
    """
    resolved = load_config(method, configuration, **settings)
    place = Path(folder) if folder else default_folder(method, configuration, resolved)
    with redirect_stdout(sys.stderr):
        found = train_method(method, configuration or config_names(method)[0], resolved, place, resume)
    if found is None:
        raise KeyboardInterrupt
    return found


def _points(returns: Returns) -> Points:
    found = t_interval(returns)
    return Points(found.value, found.low, found.high, len(returns))

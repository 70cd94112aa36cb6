"""One training run from settings to its summary: what `overcooked-bench train` does after parsing its arguments."""

from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.estimate import t_interval
from overcooked_bench.kitchen.layout import Layout

from .learning.freeze import Returns
from .learning.settings import Settings
from .methods import find_method
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


def _points(returns: Returns) -> Points:
    found = t_interval(returns)
    return Points(found.value, found.low, found.high, len(returns))

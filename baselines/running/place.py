"""The folder of a training run, how the run resumes, and the small files in the folder."""

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, TypeVar

from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.layout import Layout

from .seeds import part_of

CONFIG_FILE: Final = "config.json"
"""A run's resolved configuration, in its folder."""
EVERY: Final = 250_000
"""Joint steps between checkpoints by default."""
_MOST_BYTES: Final = 64_000_000

Content = TypeVar("Content")


class CheckpointError(WrongUse):
    """A run's folder or checkpoint is missing, damaged or of another run."""


@dataclass(frozen=True)
class Place:
    """Where a run is written, and how it goes on.

    Attributes:
        folder: For the checkpoint, the logs, the resolved configuration and the frozen policy.
        seed: Of all random numbers.
        resume: Whether to go on from the folder's checkpoint; the weights are those of an uninterrupted run.
        every: Joint steps between checkpoints.
    """

    folder: Path
    seed: int
    resume: bool = False
    every: int = EVERY

    def part(self, folder: str | Path, name: str) -> "Place":
        """Returns the place of one of the runs that this run consists of, which is resumed if it was started.

        Args:
            folder: Below this one.
            name: What its seed is derived from.
        """
        own = self.folder / folder
        return replace(self, folder=own, seed=part_of(self.seed, name), resume=(own / CONFIG_FILE).exists())


def label(layout: str) -> str:
    """Returns a layout's name as a folder can have it: "custom" for a grid."""
    name = Layout.load(layout).name
    return "custom" if "\n" in name else name


def open_place(folder: Path, seed: int, resume: bool, every: int) -> Place:
    """Returns the place of a run that a user asks for.

    Raises:
        CheckpointError: The folder holds a run that is not to be resumed, or none that could be.
    """
    held = folder.is_dir() and any(folder.iterdir())
    if held and not resume:
        raise CheckpointError(f"{folder} holds a run already; go on with it by --resume, or choose another --output")
    if resume and not held:
        raise CheckpointError(f"{folder}: no checkpoint to resume from; start without --resume")
    return Place(folder, seed, resume, every)


def write_record(file: Path, content: Any) -> None:
    """Writes a JSON file whole or not at all."""
    write_whole(file, json.dumps(content, indent=2) + "\n")


def read_record(file: Path, kind: type[Content]) -> Content | None:
    """Reads a JSON file of a run; None if there is none.

    Args:
        file: The file.
        kind: The type of its content.

    Raises:
        CheckpointError: It is not JSON, or holds something else.
    """
    if not os.path.lexists(file):
        return None
    try:
        return read_json(file, _MOST_BYTES, kind, CheckpointError)
    except CheckpointError as error:
        raise CheckpointError(f"{error}; restore the file, or choose another --output") from None

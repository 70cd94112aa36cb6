"""What the training of agents cost, run by run: `costs.json`, beside a pool's manifest."""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole

COSTS_FILE: Final = "costs.json"
_MOST_BYTES: Final = 4_000_000


class CostError(WrongUse):
    """A file of costs cannot be read; the message names it."""


class RunCost(msgspec.Struct, frozen=True):
    """The price of one training run, with those of the partners that were trained for it.

    Attributes:
        seconds: Wall-clock of training, on one core.
        joint_steps: Steps in which both chefs act.
        partner_runs: Further policies that were trained for it, such as the other members of a population.
    """

    seconds: float
    joint_steps: int
    partner_runs: int


def read_costs(folder: Path) -> dict[str, RunCost]:
    """Reads what the runs of a pool or an entry cost.

    Args:
        folder: The pool's.

    Returns:
        `<layout>/<agent>` -> its run's cost; empty if nobody recorded them.

    Raises:
        CostError: The file is damaged.
    """
    file = folder / COSTS_FILE
    return read_json(file, _MOST_BYTES, dict[str, RunCost], CostError) if file.is_file() else {}


def write_costs(folder: Path, costs: Mapping[str, RunCost]) -> None:
    """Writes the file."""
    content = msgspec.json.encode(dict(sorted(costs.items())))
    write_whole(folder / COSTS_FILE, msgspec.json.format(content, indent=1) + b"\n")

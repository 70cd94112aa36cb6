"""The table of finished runs: `python -m overcooked_bench.baselines.results_table runs/full/*`."""

import json
import sys
from pathlib import Path
from typing import Any

from overcooked_bench.estimate import Estimate
from overcooked_bench.rendering.table import Column, Table

from .training import SUMMARY

COLUMNS = "layout", "method", "configuration", "seed", "with itself", "with its partners", "joint steps", "wall-clock"


def row(summary: dict[str, Any]) -> list[str]:
    """Lays out one run."""
    names = [str(summary[key]) for key in ("layout", "method", "configuration", "seed")]
    points = [_points(summary[key]) for key in ("with_itself", "with_partners")]
    return [*names, *points, f"{summary['steps'] / 1e6:.1f} M", f"{summary['seconds'] / 60:.1f} min"]


def table(folders: list[Path]) -> str:
    """Writes the table of the runs in these folders, in Markdown.

    Raises:
        FileNotFoundError: A folder holds no finished run.
    """
    summaries = [json.loads((folder / SUMMARY).read_text()) for folder in folders]
    summaries.sort(key=lambda one: (one["layout"], one["method"], one["configuration"], one["seed"]))
    return Table([Column(name, left=True) for name in COLUMNS], [*map(row, summaries)]).markdown()


def _points(measured: dict[str, float] | None) -> str:
    return Estimate(measured["mean"], measured["low"], measured["high"]).text(0) if measured else "-"


def main(arguments: list[str]) -> int:
    """Prints the table; gives the exit code, 2 where a folder holds no finished run."""
    try:
        print(table([Path(folder) for folder in arguments]))
    except FileNotFoundError as error:
        print(f"{error.filename}: no finished run; give folders of `overcooked-bench train`", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))

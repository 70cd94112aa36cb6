"""The table of finished runs: `python -m overcooked_bench.baselines.results_table runs/full/*`."""

import json
import sys
from pathlib import Path
from typing import Any

from .learning.run import SUMMARY

HEAD = "| layout | method | configuration | seed | with itself | with its partners | joint steps | wall-clock |"


def row(summary: dict[str, Any]) -> str:
    """Writes one run."""
    return (
        f"| {summary['layout']} | {summary['method']} | {summary['configuration']} | {summary['seed']} | "
        f"{_points(summary['with_itself'])} | {_points(summary['with_partners'])} | "
        f"{summary['steps'] / 1e6:.1f} M | {summary['seconds'] / 60:.1f} min |"
    )


def table(folders: list[Path]) -> str:
    """Writes the table of the runs in these folders, in Markdown.

    Raises:
        FileNotFoundError: A folder holds no finished run.
    """
    summaries = [json.loads((folder / SUMMARY).read_text()) for folder in folders]
    summaries.sort(key=lambda one: (one["layout"], one["method"], one["configuration"], one["seed"]))
    return "\n".join([HEAD, "|---" * 8 + "|", *map(row, summaries)])


def _points(told: dict[str, float] | None) -> str:
    return f"{told['mean']:.0f} [{told['low']:.0f}, {told['high']:.0f}]" if told else "-"


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

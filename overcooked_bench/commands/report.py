"""`overcooked-bench report`: write a score's report again, and its plots and tables as files."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command, console


def add_report(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "report",
        _report,
        "write the report of a score, beside chosen scores, and its plots as PNG and SVG, its tables as CSV",
        "overcooked-bench report scores/mine-v1 --beside scores/theirs-v1 scores/greedy-v1",
    )
    parser.add_argument("score", metavar="DIR", help="the folder of a score; everything is written there")
    parser.add_argument(
        "--beside",
        metavar="SCORE",
        nargs="+",
        action="extend",
        default=[],
        help="scores of the same games, which the plots show as well",
    )


def _report(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.errors import WrongUse
    from overcooked_bench.evaluation.scores import REPORT_FILE, read_scores
    from overcooked_bench.evaluation.shown.report import PLOTS_FOLDER, TABLES_FOLDER, write_files, write_report

    folder = Path(options.score)
    if not folder.is_dir():
        raise WrongUse(f"{folder}: no such folder; give the folder of a score, such as scores/greedy-v1")
    sections = write_report(read_scores(folder), folder, [read_scores(other) for other in options.beside])
    files = write_files(sections, folder)
    shown = console()
    for line in (
        f"{folder / REPORT_FILE}  the report",
        f"{folder / PLOTS_FOLDER}  {', '.join(sorted({file.stem for file in files if file.suffix == '.png'}))}",
        f"{folder / TABLES_FOLDER}  {sum(file.suffix == '.csv' for file in files)} tables",
    ):
        shown.print(line, soft_wrap=True, highlight=False, markup=False)
    return 0

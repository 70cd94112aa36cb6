"""`overcooked-bench games answers`: the games and answers of a study, as a table."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command


def add_answers(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "answers",
        _answers,
        "write the games of a study and what participants answered as answers.csv in its folder, a row per game",
        "overcooked-bench games answers studies/ring",
    )
    parser.add_argument("folder", metavar="DIR", help="the folder of a study, from `play --study`")


def _answers(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.files import write_whole
    from overcooked_bench.human.study.log import StudyLog
    from overcooked_bench.human.study.plan import PLAN, read_study
    from overcooked_bench.human.study.table import as_csv

    folder = Path(options.folder)
    log = StudyLog(folder, read_study(folder / PLAN))
    table = folder / "answers.csv"
    write_whole(table, as_csv(log))
    played = sum(len(one.played) for one in log.participants.values())
    print(f"{table}: {len(log.participants)} participants, {played} games")
    return 0

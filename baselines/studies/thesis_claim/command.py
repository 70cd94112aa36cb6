"""What `python -m overcooked_bench.baselines.studies.thesis_claim` does."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.evaluation.protocol import load_protocol
from overcooked_bench.files import write_whole

from ...building.queue import Display, Report, Result, work_off
from .analysis import paired
from .costs import cost_table
from .gathered import whole_blocks
from .page import written
from .pictures import draw
from .power import power_table
from .records import RESULTS, joined, read_record, record_file, write_record
from .registered import check_registered, register
from .report import BESIDE, make_result
from .study import HOME, MAIN, Block, Study, StudyError, blocks, load_study
from .training import block_file, do_block
from .view import play_view

RESULT: Final = "result.json"
PAGE: Final = "result.md"


def run_blocks(
    study: Study,
    home: Path,
    part: str,
    layouts: Sequence[str] = (),
    indices: Sequence[int] = (),
    runs: Path = Path("runs/thesis-claim"),
    workers: int = 1,
) -> Result:
    """Trains and scores blocks, each in a process, and keeps a record of each; goes on where it was stopped.

    Args:
        study: The recipe.
        home: The study's folder.
        part: Part of the study.
        layouts: Only these; all of the part by default.
        indices: Only these blocks of each layout; all by default.
        runs: Folder of all runs.
        workers: Blocks at the same time.

    Raises:
        StudyError: The plan or the recipe is not what was registered, or there is no such part, layout or block.
    """
    known, _ = check_registered(home)
    play = load_protocol(study.protocol).sha256
    wanted = []
    for block in blocks(study, part, known.hashes, layouts, indices):
        file = record_file(block, home)
        if not file.is_file() or play not in read_record(file).plays:
            wanted.append(block)
    made = block_file(part, play)

    def keep(block: Block, folder: Path, say: Report) -> bool:
        record, file = read_record(folder / made), record_file(block, home)
        try:
            if file.is_file():
                record = joined(read_record(file), record)
            write_record(record, file)
        except StudyError as error:
            say(f"{block.name}: not kept ({error})")
            return False
        for one in record.arms:
            if one.failed:
                say(f"{block.name}: {one.arm} could not be trained and counts as 0 ({one.failed})")
        say(f"{block.name}: done")
        return True

    with Display(len(wanted)) as display:
        return work_off(wanted, runs, workers, do_block, keep, made, display)


def write_report(study: Study, home: Path, ended: bool = False) -> Path:
    """Analyses the records and writes result.md, result.json and the pictures.

    Args:
        study: The recipe.
        home: The study's folder.
        ended: Whether no further blocks will be run.

    Returns:
        The page.

    Raises:
        StudyError: As `make_result` and `check_registered`.
    """
    known, changed = check_registered(home)
    result = make_result(study, home, known, changed, ended)
    main, folder = whole_blocks(study, MAIN, home, known), home / RESULTS
    per_block = {
        f"{test.measure}, {test.layout}": paired(
            *(
                [record.by_arm[arm].value(test.measure, study.play_sha256) for record in main[test.layout]]
                for arm in (test.first, test.second)
            )
        )
        for test in result.primary
    }
    draw(result, per_block, folder)
    write_whole(folder / RESULT, msgspec.json.format(msgspec.json.encode(result), indent=1) + b"\n")
    write_whole(folder / PAGE, written(result, BESIDE))
    return folder / PAGE


def main(arguments: Sequence[str] | None = None) -> int:
    """Does what is asked for; gives the exit code: 0 done, 1 a block failed, 2 wrong use, 130 stopped."""
    given = _parser().parse_args(arguments)
    home = Path(given.study)
    try:
        study = load_study(home)
        code: int = given.do(study, home, given)
    except OvercookedBenchError as error:
        print(f"thesis_claim {given.command}: {error}", file=sys.stderr)
        return error.exit_code
    except KeyboardInterrupt:
        return 130
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="thesis_claim", description="Runs and analyses the study of thesis-claim.")
    parser.add_argument("--study", default=HOME, help="folder of the study (default: the one that ships)")
    commands = parser.add_subparsers(dest="command", required=True)

    run = commands.add_parser("run", help="trains and scores blocks; resumes what was stopped")
    run.add_argument("part", nargs="?", default=MAIN, help="part of the study: pilot, main, rows or convolutions")
    run.add_argument("--layouts", type=lambda text: text.split(","), default=(), help="only these, joined by commas")
    run.add_argument("--blocks", type=_range, default=(), metavar="A-B", help="only these blocks, such as 0-4")
    run.set_defaults(do=_run)

    view = commands.add_parser("view", help="plays the thesis's view, once the blocks are there; descriptive")
    view.add_argument("--layouts", type=lambda text: text.split(","), default=(), help="only these, joined by commas")
    view.set_defaults(do=_view)
    for one in (run, view):
        one.add_argument("--runs", type=Path, default=Path("runs/thesis-claim"), help="folder of all runs")
        one.add_argument("--workers", type=int, default=1, help="processes (default: 1)")

    report = commands.add_parser("report", help="analyses the records as the plan says and writes the result page")
    report.add_argument("--ended", action="store_true", help="compute has ended: analyses the blocks that are there")
    report.set_defaults(do=_report)

    for name, what, does in (
        ("costs", "prints what blocks cost so far, and no score", _costs),
        ("power", "prints the plan's figures of power", _power),
        ("register", "writes the hashes of plan, recipe and code, before anything is run", _register),
    ):
        commands.add_parser(name, help=what).set_defaults(do=does)
    return parser


def _range(text: str) -> range:
    first, _, last = text.partition("-")
    try:
        return range(int(first), int(last or first) + 1)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no range of blocks; write 0-4, or 3 for one") from None


def _run(study: Study, home: Path, given: argparse.Namespace) -> int:
    result = run_blocks(study, home, given.part, given.layouts, given.blocks, given.runs, given.workers)
    known, _ = check_registered(home)
    for layout, records in whole_blocks(study, given.part, home, known).items():
        print(f"{given.part}, {layout}: {len(records)} of {study.part(given.part).blocks[layout]} blocks are there")
    return 130 if result.stopped else int(not result.well)


def _view(study: Study, home: Path, given: argparse.Namespace) -> int:
    known, _ = check_registered(home)
    parts = [name for name, part in study.parts.items() if part.set == study.part(MAIN).set]
    whole = {name: whole_blocks(study, name, home, known) for name in parts}
    for layout in given.layouts or study.part(MAIN).blocks:
        count = min(study.view, len(whole[MAIN].get(layout, [])))
        if not count:
            raise StudyError(f"no main blocks are there on {layout}; run them first")
        records = [record for name in parts for record in whole[name].get(layout, [])[:count]]
        view = play_view(study, layout, records, given.runs, home, given.workers)
        print(f"{layout}: {view.blocks} blocks played")
    return 0


def _report(study: Study, home: Path, given: argparse.Namespace) -> int:
    print(write_report(study, home, given.ended))
    return 0


def _costs(study: Study, home: Path, given: argparse.Namespace) -> int:
    known, _ = check_registered(home)
    print(cost_table(study, {name: whole_blocks(study, name, home, known) for name in study.parts}))
    return 0


def _power(study: Study, home: Path, given: argparse.Namespace) -> int:
    print(power_table(study.part(MAIN).blocks))
    return 0


def _register(study: Study, home: Path, given: argparse.Namespace) -> int:
    found = register(home)
    print(f"plan {found.plan}\nrecipe {found.recipe}\ncode {found.code_sha256}")
    return 0

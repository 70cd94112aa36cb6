"""`overcooked-bench submission`: starts, checks, packs and unpacks submissions."""

import argparse
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import add_command, add_group, add_json, add_output, print_json

if TYPE_CHECKING:
    from overcooked_bench.leaderboard.submission.check import Checked

_EXAMPLE = "my-agent"


def add_submission(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands,
        "submission",
        "start, check, pack and unpack a submission to the leaderboard",
        f"overcooked-bench submission new {_EXAMPLE}",
    )
    parser = add_command(
        inner,
        "new",
        _new,
        "write the folder of a submission that plays, to replace its tiny agent with yours",
        f"overcooked-bench submission new {_EXAMPLE}",
    )
    parser.add_argument("folder", metavar="NAME", help="the submission's name, a folder that does not exist yet")
    parser = add_command(
        inner,
        "check",
        _check,
        "list everything that has to be changed in a submission; plays nothing, exits with 1 if there is anything",
        f"overcooked-bench submission check {_EXAMPLE}",
    )
    parser.add_argument("submission", metavar="DIR|ARCHIVE", help="a folder, or what `submission pack` wrote")
    add_json(parser)
    parser = add_command(
        inner,
        "pack",
        _pack,
        "check a submission and write it into one archive; the same files give the same bytes",
        f"overcooked-bench submission pack {_EXAMPLE}",
    )
    parser.add_argument("folder", metavar="DIR", help="the submission's folder")
    add_output(parser, "the current one")
    add_json(parser)
    parser = add_command(
        inner,
        "unpack",
        _unpack,
        "check an archive and write its files into a new folder, or refuse it and write nothing",
        f"overcooked-bench submission unpack {_EXAMPLE}.submission.zip unpacked",
    )
    parser.add_argument("archive", metavar="ARCHIVE", help="what `submission pack` wrote")
    parser.add_argument("folder", metavar="DIR", help="a folder that does not exist yet")


def _new(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.submission.template import new_submission

    folder = new_submission(options.folder)
    print(f"{folder}: written; complete {folder}/submission.yaml, then\n  overcooked-bench submission check {folder}")
    return 0


def _check(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.submission.check import check_submission

    checked = check_submission(options.submission)
    if options.json:
        print_json(checked)
    else:
        _print_checked(checked)
    return 0 if checked.sound else 1


def _pack(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.submission.check import pack

    checked, packed = pack(options.folder, options.output or ".")
    if options.json:
        print_json(packed or checked)
    elif packed is None:
        _print_checked(checked)
        print("nothing was packed")
    else:
        print(f"{packed.archive}: {packed.bytes:,} bytes, SHA-256 {packed.archive_sha256}")
        print(f"its files: SHA-256 {packed.sha256}, as scores name it")
    return 0 if packed else 1


def _unpack(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.submission.archive import unpack

    unpack(options.archive, options.folder)
    print(f"{options.folder}: unpacked; its code has not been run")
    return 0


def _print_checked(checked: "Checked") -> None:
    from overcooked_bench.files import shown

    for problem in checked.problems:
        print(shown(problem, 1_000))
    count = len(checked.problems)
    verdict = "in order" if checked.sound else f"{count} thing{'s' if count > 1 else ''} to change"
    print(f"{shown(checked.path)}: {verdict}; {checked.files:,} files, {checked.bytes:,} bytes")
    if checked.sha256:
        print(f"SHA-256 {checked.sha256}")

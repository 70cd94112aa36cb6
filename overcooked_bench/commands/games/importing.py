"""`overcooked-bench games import-2019`: make a games file of the human games of 2019."""

import argparse
from typing import Any

from overcooked_bench.commands.common import ProgressBar, add_command, add_json, add_output, console, print_json

_FOLDER = "runs/human"
_NAME = "2019.games.jsonl"


def add_import_2019(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "import-2019",
        _import,
        "get the 76 human games of 2019 (Carroll et al.) and replay every step of them; exits with 1 if one differs",
        "overcooked-bench games import-2019",
    )
    parser.add_argument(
        "--file",
        metavar="SDIST",
        help="overcooked_ai-1.1.0.tar.gz, read without running anything (default: download it with pip, which checks "
        "its hash, then fetches the newest setuptools, unchecked, and runs its setup.py)",
    )
    add_output(parser, f"{_FOLDER}; the file in it is {_NAME}")
    add_json(parser)


def _import(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.human.games import write_games
    from overcooked_bench.human.original_2019.distribution import FILE, digest_of, download, read_file, unpack
    from overcooked_bench.human.original_2019.importing import import_games
    from overcooked_bench.human.original_2019.summary import count, count_table, leak

    with ProgressBar("downloading with pip" if options.file is None else "reading") as tell:
        data = download() if options.file is None else read_file(options.file)
        imported = import_games(
            unpack(data, options.file or FILE), on_progress=lambda done, of: tell("replaying", done, of)
        )
    output = Path(options.output or _FOLDER) / _NAME
    output.parent.mkdir(parents=True, exist_ok=True)
    write_games(output, imported.games)
    digest, counts = digest_of(output.read_bytes()), count(imported)
    if options.json:
        print_json({"file": str(output), "sha256": digest, "differences": 0, "counts": [c._asdict() for c in counts]})
        return 0
    console().print(count_table(counts).terminal())
    print(f"{counts[-1].games} games, {counts[-1].steps:,} joint steps, 0 differences")
    print(leak(counts))
    print(f"{output}  SHA-256 {digest}")
    return 0

"""`overcooked-bench train`: train a baseline.

Each method has options of its own: one for every field of its settings, described by the text below the field.
"""

import argparse
import sys
from pathlib import Path
from typing import Any, Final

from overcooked_bench.baselines.methods import METHODS, find_method
from overcooked_bench.commands.common import Parser, add_command, whole
from overcooked_bench.commands.settings_options import add_settings, show_defaults

STOPPED: Final = 130


def add_train(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "train",
        _train,
        "train a baseline; `overcooked-bench train METHOD --help` shows the method's own options",
        "overcooked-bench train self-play --layout cramped_room --seed 0 --output runs/self-play",
    )
    parser.add_argument("method", metavar="METHOD", help=", ".join(METHODS))
    parser.add_argument("options", metavar="...", nargs=argparse.REMAINDER, help="options of the method")


def method_parser(method: str, config: type[Any], configurations: tuple[str, ...]) -> Parser:
    """Makes the parser of a method's options; what is not given is not in its result."""
    parser = Parser(
        prog=f"overcooked-bench train {method}",
        usage=f"overcooked-bench train {method} --layout LAYOUT [options]",
        description=f"{METHODS[method][0].upper()}{METHODS[method][1:]}.",
        epilog=f"example:\n  overcooked-bench train {method} --layout forced_coordination --seed 1",
        argument_default=argparse.SUPPRESS,
        add_help=False,
    )
    run = parser.add_argument_group("the run")
    run.add_argument(
        "-h",
        "--help",
        action="store_true",
        help="show this help and exit; with --config NAME, its values are the defaults shown",
    )
    run.add_argument(
        "--config",
        metavar="NAME",
        help=f"named settings: {', '.join(configurations)}; join several with commas, the later ones win",
    )
    run.add_argument("--output", metavar="DIR", help="folder to write to (default: runs/<method>-<layout>-<seed>)")
    run.add_argument("--resume", action="store_true", help="continue from the checkpoint in the output folder")
    run.add_argument(
        "--checkpoint-every",
        metavar="N",
        type=whole(1),
        help="joint steps (in which both chefs act once) between checkpoints (default: 250000)",
    )
    add_settings(parser.add_argument_group("the training"), config)
    return parser


def _train(options: argparse.Namespace) -> int:
    method = find_method(options.method)
    from overcooked_bench.baselines.presets import config_names, load_config
    from overcooked_bench.baselines.running.partners import scoring_pools
    from overcooked_bench.baselines.running.place import EVERY
    from overcooked_bench.baselines.training import default_folder, train_method

    known = config_names(options.method)
    parser = method_parser(options.method, method.Config, known)
    given = vars(parser.parse_args(options.options))
    wants_help, name = given.pop("help", False), given.pop("config", "")
    if wants_help:
        shown = load_config(options.method, name, **{"layout": "", **given})
        show_defaults(parser, shown)
        parser.print_help()
        return 0
    output, resume, every = given.pop("output", None), given.pop("resume", False), given.pop("checkpoint_every", EVERY)
    if "layout" not in given:
        parser.error("the following arguments are required: --layout")
    settings = load_config(options.method, name, **given)
    for protocol, pool in scoring_pools(settings.partner_references, settings.people):
        print(
            f"warning: protocol {protocol} scores with the pool {pool}; an agent that is trained or chosen with it, or "
            "made from the same people, has met its partners. train-v1 and human-train are made to train with, dev-v1 "
            "to choose by",
            file=sys.stderr,
        )
    folder = Path(output) if output else default_folder(options.method, name, settings)
    found = train_method(options.method, name or known[0], settings, folder, resume, every)
    if found is None:
        print(f"stopped, and saved in {folder}; the same command with --resume goes on from there", file=sys.stderr)
        return STOPPED
    outcome, summary = found
    own, theirs = summary.with_itself, summary.with_partners
    print(
        f"{outcome.files.weights}: return with itself {own.mean:.1f} [{own.low:.1f}, {own.high:.1f}] points over "
        f"{own.episodes} episodes, after {summary.steps:,} joint steps in {summary.seconds:.0f} s"
        + (f", {summary.restarts} restarts" if summary.restarts else "")
    )
    if theirs:
        print(
            f"with its partners {theirs.mean:.1f} [{theirs.low:.1f}, {theirs.high:.1f}] points over "
            f"{theirs.episodes} episodes"
        )
    return 0

"""`overcooked-bench play`: people play with agents, or with each other, in a browser."""

import argparse
import sys
from typing import Any, Final

from overcooked_bench.commands.common import (
    add_act_timeout,
    add_command,
    add_isolate,
    add_layouts,
    add_output,
    positive,
    whole,
)
from overcooked_bench.errors import WrongUse

_OF_NO_STUDY: Final = ("agents", "layouts", "games", "seat", "pace", "horizon")
"""What the plan of a study says itself, or keeps elsewhere."""


def add_play(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "play",
        _play,
        "play with an agent, or with another person, in a browser; games of people who agree are kept",
        "overcooked-bench play my_agent.py --games ours.games.jsonl",
    )
    parser.add_argument(
        "agents", metavar="AGENT", nargs="*", help="agents to offer beside those that `overcooked-bench list` shows"
    )
    parser.add_argument(
        "--study", metavar="PLAN", help="be the server of a study, whose YAML file this is; docs/studies.md says more"
    )
    add_output(parser, "studies/<name>, for --study")
    add_layouts(parser)
    parser.add_argument(
        "--seat", type=int, choices=(0, 1), help="the chef that the page suggests: 0 (blue) or 1 (orange)"
    )
    parser.add_argument(
        "--games",
        metavar="FILE",
        help="add the games of people who agree to this games file (*.games.jsonl); nothing is kept without it",
    )
    parser.add_argument("--pace", metavar="MS", type=positive, help="milliseconds per step (default: 150)")
    parser.add_argument("--horizon", metavar="STEPS", type=whole(1), help="length of a game (default: 400)")
    parser.add_argument(
        "--countdown", metavar="SECONDS", type=whole(0), default=3, help="before the first step (default: 3)"
    )
    parser.add_argument(
        "--cooking",
        choices=("auto", "manual"),
        default="auto",
        help="whether a full pot starts by itself (auto, default) or an empty-handed chef starts it (manual)",
    )
    parser.add_argument(
        "--host", metavar="ADDRESS", default="127.0.0.1", help="where to listen (default: 127.0.0.1, this machine only)"
    )
    parser.add_argument("--port", metavar="N", type=whole(0), default=0, help="port (default: a free one)")
    parser.add_argument(
        "--token",
        metavar="TEXT",
        default="",
        help="end of the address, to keep it over restarts",
    )
    add_isolate(parser)
    add_act_timeout(parser)


def _play(options: argparse.Namespace) -> int:
    from overcooked_bench.agents.isolation.settings import isolate
    from overcooked_bench.human.server.house import Terms
    from overcooked_bench.human.server.offers import Cast
    from overcooked_bench.human.server.serving import LOOPBACK, Place, serve
    from overcooked_bench.human.server.studies import open_study
    from overcooked_bench.kitchen.layout import Layout, layout_names

    isolation = isolate(options.isolate, options.act_timeout) if options.isolate else None
    if options.host not in (LOOPBACK, "localhost", "::1"):
        print("Anyone who knows the address below can play, and the connection is not encrypted.", file=sys.stderr)
    print("Loading ...", file=sys.stderr)

    def opened(address: str) -> None:
        print(f"{address}\nopen this address in a browser; Ctrl-C stops the server", flush=True)

    place = Place(options.host, options.port, options.token)
    if options.study:
        if given := [name for name in _OF_NO_STUDY if getattr(options, name) not in (None, [])]:
            raise WrongUse(f"{given[0]} is for the plan of a study to say; with --study, --output DIR names its folder")
        study = open_study(options.study, options.output, options.cooking, options.countdown, isolation)
        terms, cast, games, log = study
        serve(terms, cast, games, place, opened, log)
        return 0
    if options.output:
        raise WrongUse("--output is the folder of a study; --games FILE names a games file")
    layouts = tuple(Layout.named(name).name for name in options.layouts or layout_names())
    pace, horizon = options.pace / 1000 if options.pace else Terms.pace, options.horizon or Terms.horizon
    terms = Terms(layouts, pace, horizon, options.countdown, options.cooking, options.seat)
    serve(terms, Cast(tuple(options.agents), options.cooking, isolation), options.games, place, opened)
    return 0

"""`overcooked-bench play`: people play with agents, or with each other, in a browser."""

import argparse
import sys
from typing import Any

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
    parser.add_argument(
        "--pace", metavar="MS", type=positive, default=150.0, help="milliseconds per step (default: 150)"
    )
    parser.add_argument(
        "--horizon", metavar="STEPS", type=whole(1), default=400, help="length of a game (default: 400)"
    )
    parser.add_argument(
        "--countdown", metavar="SECONDS", type=float, default=3.0, help="before the first step (default: 3)"
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
    from overcooked_bench.human.server.offers import Cast, layouts_of
    from overcooked_bench.human.server.serving import LOOPBACK, Place, serve
    from overcooked_bench.human.server.studies import open_study

    isolation = isolate(options.isolate, options.act_timeout) if options.isolate else None
    countdown = max(0.0, options.countdown)
    if options.host not in (LOOPBACK, "localhost", "::1"):
        print("Anyone who knows the address below can play, and the connection is not encrypted.", file=sys.stderr)
    print("Loading ...", file=sys.stderr)

    def opened(address: str) -> None:
        print(f"{address}\nopen this address in a browser; Ctrl-C stops the server", flush=True)

    place = Place(options.host, options.port, options.token)
    if options.study:
        if options.agents or options.layouts or options.games or options.seat is not None:
            raise WrongUse("the plan of a study says who plays where; give --output DIR for its record, and no others")
        terms, cast, games, log = open_study(options.study, options.output, options.cooking, countdown, isolation)
        serve(terms, cast, games, place, opened, log)
        return 0
    layouts = tuple(layout.name for layout in layouts_of(options.layouts))
    terms = Terms(layouts, options.pace / 1000, options.horizon, countdown, options.cooking, options.seat)
    serve(terms, Cast(tuple(options.agents), options.cooking, isolation), options.games, place, opened)
    return 0

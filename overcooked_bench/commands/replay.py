"""`overcooked-bench replay`: show a recorded episode."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command


def add_replay(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "replay",
        _replay,
        "show a recorded episode in the terminal or as a GIF",
        "overcooked-bench replay scores/greedy-dev --layout cramped_room --worst --gif worst.gif",
    )
    parser.add_argument("score", metavar="DIR", help="the folder of a score, or its episodes.sqlite")
    parser.add_argument("--layout", metavar="NAME", help="only episodes on this layout")
    parser.add_argument("--partner", metavar="NAME", help="only episodes with this partner")
    parser.add_argument("--seat", type=int, choices=(0, 1), help="only episodes with the scored agent on this seat")
    parser.add_argument("--episode", metavar="N", type=int, help="only episodes from the N-th start state (from 0)")
    parser.add_argument(
        "--training-seed", metavar="N", type=int, help="only episodes of this training seed of the agent"
    )
    parser.add_argument(
        "--worst", action="store_true", help="the matching episode with the lowest return (default: the first match)"
    )
    parser.add_argument("--gif", metavar="FILE", help="write a GIF instead of playing in the terminal")
    parser.add_argument("--fps", metavar="N", type=float, default=8, help="steps per second (default: 8)")
    parser.add_argument("--every", metavar="N", type=int, default=1, help="show only every N-th step")


def _replay(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.games.recording import find_recording

    recording = find_recording(
        options.score,
        layout=options.layout,
        partner=options.partner,
        seat=options.seat,
        episode=options.episode,
        training_seed=options.training_seed,
        worst=options.worst,
    )
    if options.gif:
        recording.save_gif(options.gif, fps=options.fps, every=options.every)
        print(f"{options.gif}  {recording.title}")
    else:
        print(recording.title)
        recording.show(fps=options.fps, every=options.every)
    return 0

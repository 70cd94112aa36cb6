"""`overcooked-bench replay`: show a recorded episode or game."""

import argparse
from typing import TYPE_CHECKING, Any, Final

from overcooked_bench.commands.common import add_command, whole
from overcooked_bench.errors import WrongUse

if TYPE_CHECKING:
    from overcooked_bench.evaluation.games.recording import Recording
    from overcooked_bench.human.watched import WatchedGame

_OF_SCORES: Final = ("layout", "partner", "seat", "episode", "training_seed", "worst")
"""What chooses among the episodes of a score."""


def add_replay(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "replay",
        _replay,
        "show a recorded episode in the terminal, as a page or as a GIF",
        "overcooked-bench replay scores/greedy-v1 --layout cramped_room --worst --page worst.html",
    )
    parser.add_argument(
        "source", metavar="DIR|FILE", help="the folder of a score, its episodes.sqlite, or a games file (*.games.jsonl)"
    )
    parser.add_argument("--game", metavar="N", type=whole(0), help="the N-th game of a games file (from 0)")
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
    parser.add_argument("--page", metavar="FILE", help="write an HTML page that plays it, instead of the terminal")
    parser.add_argument("--gif", metavar="FILE", help="write a GIF instead of playing in the terminal")
    parser.add_argument("--fps", metavar="N", type=float, default=8, help="steps per second (default: 8)")
    parser.add_argument("--every", metavar="N", type=int, default=1, help="show only every N-th step")


def _replay(options: argparse.Namespace) -> int:
    found = _game(options) if str(options.source).endswith(".jsonl") else _episode(options)
    if options.page:
        found.save_page(options.page)
        print(f"{options.page}  {found.title}")
    elif options.gif:
        found.save_gif(options.gif, fps=options.fps, every=options.every)
        print(f"{options.gif}  {found.title}")
    else:
        print(found.title)
        found.show(fps=options.fps, every=options.every)
    return 0


def _game(options: argparse.Namespace) -> "WatchedGame":
    from overcooked_bench.human.watched import find_game

    chosen = vars(options)
    if given := [name for name in _OF_SCORES if chosen[name] is not None and chosen[name] is not False]:
        flag = "--" + given[0].replace("_", "-")
        raise WrongUse(f"{flag} chooses among the episodes of a score; --game N chooses a game of a games file")
    return find_game(options.source, options.game or 0)


def _episode(options: argparse.Namespace) -> "Recording":
    from overcooked_bench.evaluation.games.recording import find_recording

    if options.game is not None:
        raise WrongUse("--game chooses a game of a games file (*.games.jsonl); a score's episodes have --layout, ...")
    return find_recording(options.source, **{name: getattr(options, name) for name in _OF_SCORES})

"""`overcooked-bench export`: turns a model of stable-baselines3 into a submission."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command, whole


def add_export(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "export",
        _export,
        "turn a model of stable-baselines3 into a submission, without unpickling anything",
        "overcooked-bench export model.zip my-ppo --layout cramped_room",
    )
    parser.add_argument(
        "model", metavar="MODEL", help="what `model.save(...)` wrote, or one of our own policies (.safetensors)"
    )
    parser.add_argument(
        "folder", metavar="DIR", help="the submission; further layouts and training seeds are added to it"
    )
    parser.add_argument(
        "--layout", metavar="LAYOUT", required=True, help="the layout that it was trained on: a shipped name or a file"
    )
    parser.add_argument(
        "--training-seed",
        metavar="N",
        type=whole(0),
        default=0,
        help="which of your independent training runs this is, counted from 0 (default: 0)",
    )
    parser.add_argument(
        "--cooking",
        choices=("auto", "manual"),
        default="auto",
        help="the cooking mode that it was trained under (default: auto)",
    )
    parser.add_argument("--observation", metavar="NAME", help="what it observes, where its shape leaves that open")
    parser.add_argument(
        "--raw-observations",
        action="store_true",
        help="it was trained in a VecNormalize that left observations as they are (norm_obs=False)",
    )
    parser.add_argument(
        "--activation", choices=("relu", "tanh"), help="its activation function, where the model does not say"
    )


def _export(options: argparse.Namespace) -> int:
    from overcooked_bench.leaderboard.export.folder import export

    written = export(
        options.model,
        options.folder,
        options.layout,
        training_seed=options.training_seed,
        cooking=options.cooking,
        observation=options.observation,
        activation=options.activation,
        raw_observations=options.raw_observations,
    )
    print(f"{written}: written; to see what is still to be filled in:")
    print(f"  overcooked-bench submission check {options.folder}")
    return 0

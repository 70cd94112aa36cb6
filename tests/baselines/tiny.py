"""A training run of a second, for the tests of the baselines."""

from pathlib import Path
from typing import Any

import torch

from overcooked_bench.baselines.learning.algorithms import make_learner
from overcooked_bench.baselines.learning.learner import Learner
from overcooked_bench.baselines.running.run import make_env
from overcooked_bench.baselines.running.seeds import USER, derive_seed
from overcooked_bench.baselines.self_play import METHOD, Config

MADE = Path(__file__).parents[1] / "data" / "human" / "made.games.jsonl"
"""Games of six made-up pairs on cramped_room, 120 steps each."""
UPDATE = 64
"""Joint steps between two updates."""
STEPS = 5 * UPDATE
SEED = derive_seed(USER, "cramped_room", METHOD, 0)
"""What the command line makes of its default seed."""
SETTINGS: dict[str, Any] = {
    "layout": "cramped_room",
    "steps": STEPS,
    "num_kitchens": 4,
    "rollout": UPDATE // 4,
    "epochs": 2,
    "minibatches": 2,
    "hidden": (16,),
    "horizon": 40,
}
"""Episodes end in the middle of a rollout."""


def tiny(**others: Any) -> Config:
    return Config(**(SETTINGS | others))


def tiny_learner(config: Config, seed: int) -> Learner:
    """A learner of self-play, untrained."""
    return make_learner(config, make_env(config, self_play=True), seed)


def self_play(*others: str) -> list[str]:
    """The command that trains so."""
    flags = [
        text
        for name, value in SETTINGS.items()
        for text in (f"--{name.replace('_', '-')}", *(map(str, value) if isinstance(value, tuple) else [str(value)]))
    ]
    return ["train", "self-play", *flags, *others]


def learned(path: Any) -> dict[str, torch.Tensor]:
    """What a checkpoint has learned: weights and the state of Adam, by name."""
    content = torch.load(path, weights_only=True)
    moments = content["optimizer"]["state"]
    return {**content["policy"], **{f"{i}.{name}": value for i in moments for name, value in moments[i].items()}}


def same(ours: dict[str, torch.Tensor], theirs: dict[str, torch.Tensor]) -> bool:
    """Whether they are equal bit by bit."""
    return ours.keys() == theirs.keys() and all(tensor.equal(theirs[name]) for name, tensor in ours.items())

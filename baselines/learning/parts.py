"""Runs that consist of several runs: each part in a folder of its own, finished parts are not trained again."""

from collections.abc import Sequence
from pathlib import Path

from overcooked_bench.agents.policies.policy import Policy, PolicyFiles, load_policy
from overcooked_bench.evaluation.pools.half import Checkpoints

from ..self_play import Config as SelfPlay
from ..self_play import train as train_self_play
from .run import CONFIG_FILE, Outcome
from .seeds import part_of
from .settings import Settings


def begun(folder: Path) -> bool:
    """Tells whether a part was begun, so that it has to be resumed."""
    return (folder / CONFIG_FILE).exists()


def self_play_agents(configs: Sequence[SelfPlay], folder: Path, seed: int, every: int) -> list[Outcome] | None:
    """Trains self-play agents that are not finished yet, one after the other.

    Args:
        configs: One for each agent.
        folder: Agent i lies in `<folder>/sp-<i>`.
        seed: Of the whole run; agent i has a seed of its own, derived from it.
        every: Joint steps between checkpoints.

    Returns:
        One outcome for each agent, or None where training was interrupted.
    """
    outcomes = []
    for i, config in enumerate(configs):
        place = folder / f"sp-{i}"
        outcome = train_self_play(config, place, part_of(seed, f"self-play {i}"), resume=begun(place), every=every)
        if outcome is None:
            return None
        outcomes.append(outcome)
    return outcomes


def checkpoints(outcome: Outcome, settings: Settings) -> Checkpoints:
    """Returns the policies that a run saved on the way, and its final one, ready to be measured."""
    saved = {share: files.weights for share, files in outcome.snapshots.items()}
    return Checkpoints({**saved, 1.0: outcome.files.weights}, settings.horizon)


def loaded(files: Sequence[PolicyFiles]) -> list[Policy]:
    """Reads frozen policies."""
    return [load_policy(one.weights) for one in files]

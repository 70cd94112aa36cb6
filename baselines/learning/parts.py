"""Runs that consist of several runs: each part in a folder of its own, finished parts are not trained again."""

from collections.abc import Sequence
from pathlib import Path

from overcooked_bench.agents.policies.policy import Policy, PolicyFiles, load_policy

from ..self_play import Config as SelfPlay
from ..self_play import train as train_self_play
from .freeze import returns_with_itself
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


def half_trained(outcome: Outcome, settings: Settings, episodes: int = 20) -> tuple[float, PolicyFiles]:
    """Picks the snapshot whose return with itself is nearest to half of the final policy's, the untrained one aside.

    Source: Strouse et al. 2021, fictitious co-play.

    Returns:
        The share of the steps at which it was saved, and its files.
    """
    half = float(outcome.returns.mean()) / 2
    means = {
        share: float(returns_with_itself(files, settings, episodes).mean())
        for share, files in sorted(outcome.snapshots.items())
        if share > 0
    }
    share = min(means, key=lambda share: abs(means[share] - half))
    return share, outcome.snapshots[share]


def loaded(files: Sequence[PolicyFiles]) -> list[Policy]:
    """Reads frozen policies."""
    return [load_policy(one.weights) for one in files]

"""Runs that consist of several runs: each part in a folder of its own, finished parts are not trained again."""

from collections.abc import Sequence

from overcooked_bench.agents.policies.policy import Policy, PolicyFiles, load_policy
from overcooked_bench.evaluation.pools.half import Checkpoints

from ..learning.settings import Settings
from ..self_play import Config as SelfPlay
from ..self_play import train as train_self_play
from .place import Place
from .run import Outcome


def self_play_agents(configs: Sequence[SelfPlay], place: Place) -> list[Outcome] | None:
    """Trains self-play agents that are not finished yet, one after the other.

    Args:
        configs: One for each agent.
        place: Of the whole run; agent i is trained in `<folder>/sp-<i>` with a seed of its own, derived from the run's.

    Returns:
        One outcome for each agent, or None if training was interrupted.
    """
    outcomes = []
    for i, config in enumerate(configs):
        outcome = train_self_play(config, place.part(f"sp-{i}", f"self-play {i}"))
        if outcome is None:
            return None
        outcomes.append(outcome)
    return outcomes


def checkpoints(outcome: Outcome, settings: Settings) -> Checkpoints:
    """Returns the policies that a run saved on the way, and its final one, ready to be measured."""
    saved = {share: one.files.weights for share, one in outcome.snapshots.items()}
    return Checkpoints({**saved, 1.0: outcome.files.weights}, settings.horizon)


def loaded(files: Sequence[PolicyFiles]) -> list[Policy]:
    """Reads frozen policies."""
    return [load_policy(one.weights) for one in files]

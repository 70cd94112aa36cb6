"""The partners of a training run, from the names that a user gives."""

from collections.abc import Sequence

import numpy as np

from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import Policy, PolicyFiles, load_policy
from overcooked_bench.agents.pools.lineage import SET_A
from overcooked_bench.agents.pools.manifest import PoolError, people_of, read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, is_pool
from overcooked_bench.evaluation.games.play import play_episodes
from overcooked_bench.evaluation.protocol import load_protocol, protocol_names
from overcooked_bench.kitchen.layout import Layout

from ..learning.freeze import Returns
from ..learning.settings import Settings


def partner_names(given: Sequence[str], settings: Settings, only_final: bool = False) -> tuple[str, ...]:
    """Spells out the partners: a pool's name or folder stands for all its agents on the layout.

    Args:
        given: Pools, and whatever else `find` takes.
        settings: The learner's.
        only_final: Leaves out the agents of a pool that were saved on the way.

    Raises:
        PoolError: A pool is damaged, has no agents here, or is of another cooking mode.
    """
    layout = Layout.load(settings.layout).name
    names: list[str] = []
    for name in given:
        if not is_pool(name):
            names.append(name)
            continue
        pool = Pool.load(name)
        if pool.cooking != settings.cooking:
            raise PoolError(f"pool {name!r} is of cooking {pool.cooking!r}; train with --cooking {pool.cooking}")
        if not pool.agents(layout):
            raise PoolError(f"pool {name!r} has no agents for {layout!r}; its layouts are {', '.join(pool.layouts)}")
        agents = [agent for agent in pool.agents(layout) if agent.trained.done == 1 or not only_final]
        names += [f"{name}/{layout}/{agent.name}" for agent in agents]
    return tuple(names)


def scoring_pools(given: Sequence[str], people: Sequence[str] = ()) -> list[tuple[str, str]]:
    """Finds pools that a shipped protocol scores with and that somebody who trains or chooses so has met.

    Args:
        given: The partners of the training or of a choice: pools, and whatever else `find` takes.
        people: Those whose games the agent or its partners are made from; partners made from them are met, too, unless
            they are of set A, which several pools have partners of: with these the agent is at home.

    Returns:
        Pairs of a protocol's and its pool's name.
    """
    pools = {name.partition("/")[0] for name in given} | {Pool.load(name).name for name in given if is_pool(name)}
    protocols = [load_protocol(name) for name in protocol_names()]
    scoring = [(protocol.name, str(protocol.play.pool)) for protocol in protocols if protocol.play.pool]
    return [(name, pool) for name, pool in scoring if pool in pools or _people_meet(people, pool)]


def _people_meet(people: Sequence[str], pool: str) -> bool:
    hidden = {*people} - {*SET_A}
    return bool(hidden) and not hidden.isdisjoint(people_of(read_manifest(find_pool(pool))))


def load_partners(names: Sequence[str], settings: Settings) -> list[Agent]:
    """Loads one agent for each name; frozen policies sample their actions.

    Raises:
        AgentError: There is no such agent.
        UnknownLayout: It cannot play this layout.
    """
    layout = Layout.load(settings.layout).name
    return [load_agent(name, layout, mode="sample") for name in names]


def sharing(partners: list[Agent], per_episode: int) -> list[Agent]:
    """Returns the `partners` argument of `OvercookedVecEnv`.

    Args:
        partners: Who can play.
        per_episode: How many are drawn for each episode; 0 lets all play at once.

    Raises:
        ValueError: A draw is asked for among agents that are not frozen policies.
    """
    if not per_episode:
        return partners
    if not all(isinstance(partner, NeuralAgent) for partner in partners):
        raise ValueError("per_episode draws among frozen policies; with other agents give 0, so that all play at once")
    return [SampledPartners(frozen_policies(partners), per_episode)]


def frozen_policies(partners: Sequence[Agent]) -> list[Policy]:
    """Returns the policies of those partners that are frozen ones."""
    return [policy for partner in partners if isinstance(partner, NeuralAgent) for policy in partner.policies]


def returns_with(files: PolicyFiles, partners: Sequence[Agent | Policy], settings: Settings, episodes: int) -> Returns:
    """Plays a frozen policy with each partner, both seats in turn.

    Args:
        files: The policy.
        partners: Who it plays with.
        settings: Of the kitchens.
        episodes: For each partner and seat.

    Returns:
        (2 P episodes,) soup reward of each, partner by partner, sampled actions, in points.
    """
    parts = []
    for k, partner in enumerate(partners):
        other = NeuralAgent(partner) if isinstance(partner, Policy) else partner
        ego = NeuralAgent(load_policy(files.weights))
        for pair in ((ego, other), (other, ego)):
            games = play_episodes(
                settings.layout,
                agents=pair,
                episodes=episodes,
                seed=k,
                cooking=settings.cooking,
                start=settings.start,
                horizon=settings.horizon,
            )
            parts.append(np.asarray(games.soup_reward, np.float64))
    return np.concatenate(parts)

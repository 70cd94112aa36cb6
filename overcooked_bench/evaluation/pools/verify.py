"""Verifies a pool: complete, independent, playable, and without near-duplicate agents.

Axes: P agents of a layout, S states.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import Policy, PolicyError
from overcooked_bench.agents.pools.lineage import Finding, check_lineages, shared_people
from overcooked_bench.agents.pools.manifest import PoolError, check_version, people_of, read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools
from overcooked_bench.agents.seated import SeatedFault
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.evaluation.games.roster import Partner, seat_partners
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult

SAME: Final = 0.01
"""Two agents whose action distributions are nearer than this on average, in total variation, count as one.

The agents of dev-v0 are 0.08 to 0.8 apart on their layouts.
"""
_EVERY: Final = 20
"""Steps between two states that agents are compared on."""


class Verdict(NamedTuple):
    """What `verify_pool` found.

    Attributes:
        pool: The pool, or None where it could not be read.
        findings: What was noticed; the pool is sound where none is grave.
        agents: How many agents were played.
        strangers: Names of the other pools with people, none of whom is among the people of this pool.
    """

    pool: Pool | None
    findings: tuple[Finding, ...]
    agents: int
    strangers: tuple[str, ...] = ()

    @property
    def sound(self) -> bool:
        """Whether nothing grave was found."""
        return not any(finding.grave for finding in self.findings)


def verify_pool(
    name_or_folder: str | Path,
    against: Sequence[str | Path] = (),
    horizon: int = 400,
    on_progress: Callable[[str, int, int], object] = lambda what, done, of: None,
) -> Verdict:
    """Verifies a pool.

    1. Every file is there and hashed as the manifest says, and no weights occur twice.
    2. Every scripted partner is known here, in the version that the pool means.
    3. The lineage rules of `check_lineages`, also against the shipped pools and entries of other names and those of
       `against`.
    4. Every trained agent is loaded and plays one episode with itself.
    5. No two trained agents act the same way on the states that were met; if some do, that is a warning.

    Args:
        name_or_folder: A shipped pool's name, or a folder.
        against: Further pools that it must have nothing in common with.
        horizon: Steps of the episode.
        on_progress: Called with a layout, how many are done, and how many there are.

    Raises:
        PoolError: There is no such pool, or one that it is held against cannot be read.
    """
    folder = find_pool(name_or_folder)
    further = [read_manifest(find_pool(other)) for other in against]
    try:
        pool = Pool.load(folder)
    except PoolError as error:
        return Verdict(None, (Finding(True, str(error)),), 0)
    others = [read_manifest(find_pool(name)) for name in shipped_pools() if name != pool.name]
    others += [load_entry(name).pool.manifest for name in shipped_entries() if name != pool.name]
    others += [other for other in further if other.hash not in {pool.hash, *(known.hash for known in others)}]
    findings, played = [*_versions(pool), *check_lineages(pool.manifest, others)], 0
    trained = [layout for layout in pool.layouts if pool.agents(layout)]
    for done, layout in enumerate(trained, start=1):
        try:
            findings += _compare(pool, layout, horizon)
            played += len(pool.agents(layout))
        except (PoolError, PolicyError, SeatedFault) as error:
            findings.append(Finding(True, f"{layout}: {error}"))
        on_progress(layout, done, len(trained))
    apart = [other.name for other in others if people_of(other) and not shared_people(pool.manifest, other)]
    return Verdict(pool, tuple(findings), played, tuple(apart) if people_of(pool.manifest) else ())


def _versions(pool: Pool) -> Iterator[Finding]:
    """Names the scripted partners that cannot be played as the pool means; each once, whatever its layouts."""
    for entry in {entry.sha256: entry for entry in pool.manifest.entries}.values():
        try:
            check_version(pool.manifest, entry)
        except PoolError as error:
            yield Finding(True, str(error))


def _compare(pool: Pool, layout: str, horizon: int) -> list[Finding]:
    """Plays every agent with itself, and names near-duplicates."""
    partners = [Partner(entry) for entry in pool.agents(layout)]
    names = [partner.name for partner in partners]
    policies = [pool.policy(layout, name) for name in names]
    who, seat = np.arange(len(names)), np.zeros(len(names), np.int64)
    onlookers = [_Onlooker(policy, 2 * len(names)) for policy in policies]

    def look(kitchens: Kitchens, result: StepResult | None = None) -> None:
        compared = kitchens.batch.clock[0] % _EVERY == 1
        for onlooker in onlookers:
            onlooker.look(kitchens, compared)

    with one_thread():
        parties = [
            *seat_partners(partners, who, seat, pool, pool.mode, layout),
            *seat_partners(partners, who, seat + 1, pool, pool.mode, layout),
        ]
        kitchens = make_kitchens(layout, len(names), parties, cooking=pool.cooking, horizon=horizon)
        kitchens.reset(seed=np.array([stream_key("verify", p.sha256, "start") for p in partners], np.uint64))
        streams = [[stream_key("verify", p.sha256, k) for k in range(2)] for p in partners]
        look(kitchens)
        play(kitchens, parties, np.array(streams, np.uint64), watch=look)
    return [
        Finding(
            False,
            f"{layout}: {', '.join(names[i] for i in group)} are near-duplicates (within {SAME:g} in total variation)",
        )
        for group in _alike([np.concatenate(onlooker.chances) for onlooker in onlookers])
    ]


class _Onlooker:
    """What a policy would do on each seat of others' games; one with memory follows them from their start.

    Args:
        policy: The policy.
        rows: Seats of all kitchens.

    Attributes:
        chances: (rows, 6) action probabilities at each step that is compared.
    """

    def __init__(self, policy: Policy, rows: int) -> None:
        self.chances: list[NDArray[np.float32]] = []
        self._architecture = policy.architecture
        self._assignment = PolicyStack([policy]).assign(np.zeros(rows, np.int64))

    def look(self, kitchens: Kitchens, compared: bool) -> None:
        """Takes in what the kitchens show; a policy without memory need not see what is not compared."""
        if compared or self._architecture.remembered:
            views = kitchens.observe(self._architecture.observation)
            chances = self._assignment.probabilities(views.reshape(-1, *self._architecture.observation_shape))
            if compared:
                self.chances.append(chances)


def _alike(chances: list[NDArray[np.float32]]) -> list[list[int]]:
    """Groups agents that are linked by near neighbours.

    Args:
        chances: (S, 6) action probabilities of each agent.

    Returns:
        Indices of the agents of each group of two or more.
    """
    group = list(range(len(chances)))
    for i, j in combinations(range(len(chances)), 2):
        if np.abs(chances[i] - chances[j]).sum(axis=1).mean() / 2 < SAME:
            group = [group[i] if g == group[j] else g for g in group]
    found = [[i for i, g in enumerate(group) if g == root] for root in sorted(set(group))]
    return [members for members in found if len(members) > 1]

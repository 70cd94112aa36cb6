"""The partners of a layout: who they are, and the agents that play them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.pools.manifest import PoolError, check_version
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import BehaviourReference, Entry, PolicyReference, ScriptedReference
from overcooked_bench.agents.seated import Seated
from overcooked_bench.evaluation.protocol import Protocol, ProtocolError
from overcooked_bench.kitchen.layout import MIRRORED, Layout

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent
    from overcooked_bench.agents.policies.policy import Architecture

Kind = Literal["trained", "scripted", "floor"]
FLOOR: Final = "floor"
"""The kind of partners that are listed separately and do not count in any score."""


@dataclass(frozen=True)
class Partner:
    """One partner on one layout.

    Attributes:
        entry: What the pool says about it.
    """

    entry: Entry

    @property
    def name(self) -> str:
        """Unique on its layout."""
        return self.entry.name

    @property
    def sha256(self) -> str:
        """Hash of what plays."""
        return self.entry.sha256

    @property
    def kind(self) -> Kind:
        """What scores call it: a floor, or else by what plays."""
        if self.entry.role == FLOOR:
            return FLOOR
        return "trained" if isinstance(self.entry.reference, PolicyReference) else "scripted"


def check_pool(pool: Pool, protocol: Protocol, layouts: Sequence[str]) -> None:
    """Makes sure that a pool can be played under a protocol.

    Raises:
        ProtocolError: Cooking or action mode differ, or a layout has no partners that count.
        PoolError: A scripted partner has another version here than the pool means.
    """
    for what, of_pool, of_protocol in (
        ("cooking", pool.cooking, protocol.play.cooking),
        ("mode", pool.mode, protocol.play.mode),
    ):
        if of_pool != of_protocol:
            raise ProtocolError(
                f"protocol {protocol.name!r} plays {what} {of_protocol!r}, but the pool {pool.name!r} was made for "
                f"{of_pool!r}; choose a pool of {of_protocol!r}"
            )
    bare = [layout for layout in layouts if all(partner.kind == FLOOR for partner in roster(pool, layout))]
    if bare:
        raise ProtocolError(
            f"the pool {pool.name!r} has no partners for {', '.join(bare)}; it covers {', '.join(pool.layouts)}. "
            "Choose among them with --layouts, or another pool with --pool"
        )
    for layout in layouts:
        for partner in roster(pool, layout):
            check_version(pool.manifest, partner.entry)


@lru_cache(maxsize=2)
def pool_as_hashed(folder: str, sha256: str) -> Pool:
    """Returns the pool of a folder, read once per process, as it was when playing began.

    Raises:
        PoolError: It was changed since then, or is damaged.
    """
    pool = Pool.load(folder)
    if pool.hash != sha256:
        raise PoolError(
            f"{folder}: the pool was changed while it was being played (SHA-256 {sha256[:12]}… when that "
            f"began, {pool.hash[:12]}… now); run it again, with another --output where some blocks are finished"
        )
    return pool


def roster(pool: Pool, layout: str) -> tuple[Partner, ...]:
    """Lists every partner that is played on a layout, by name."""
    plain = _plain(layout)
    return tuple(map(Partner, pool.partners(plain if plain in pool.layouts else Layout.load(plain).name)))


def seat_partners(
    partners: Sequence[Partner],
    who: NDArray[np.int64],
    seats: NDArray[np.int64],
    pool: Pool,
    mode: str,
    layout: str,
) -> list[Seated]:
    """Makes the agents that play the partners: one for all policies of an architecture, one for each scripted name.

    Args:
        partners: From `roster`.
        who: (N,) int64, index of the partner in each kitchen.
        seats: (N,) int64, the partner's seat in each kitchen.
        pool: Where trained partners come from.
        mode: How they act.
        layout: Where they play.
    """
    parties: list[Seated] = []
    home = _plain(layout)
    stacks: dict[Architecture, list[int]] = {}
    for index in np.unique(who).tolist():
        partner = partners[index]
        if isinstance(partner.entry.reference, PolicyReference):
            stacks.setdefault(pool.policy(home, partner.name).architecture, []).append(index)
        else:
            rows = np.flatnonzero(who == index)
            parties.append(Seated(_scripted(partner.entry, layout), partner.name, rows, seats[rows]))
    for indices in stacks.values():
        from overcooked_bench.agents.policies.neural import NeuralAgent

        rows = np.flatnonzero(np.isin(who, indices))
        rows = rows[np.argsort(who[rows], kind="stable")]
        policies = [pool.policy(home, partners[index].name) for index in indices]
        agent: Agent = NeuralAgent(policies, mode, index=np.searchsorted(indices, who[rows]))  # type: ignore[arg-type]
        names = ", ".join(partners[index].name for index in indices)
        parties.append(Seated(agent if home == layout else mirrored(agent), names, rows, seats[rows]))
    return parties


def _scripted(entry: Entry, layout: str) -> "Agent":
    """Makes a scripted partner; a behaviour, which may name cells, is shown a mirrored kitchen's image."""
    if isinstance(entry.reference, ScriptedReference):
        return _ready(entry.reference.agent, layout, layout)
    assert isinstance(entry.reference, BehaviourReference)
    return _ready(entry.reference.text, _plain(layout), layout)


@lru_cache(maxsize=64)
def _ready(reference: str, home: str, layout: str) -> "Agent":
    """Makes an agent once per process: a reset is all that it needs, and its paths take long to find."""
    agent = load_agent(reference, home)
    return agent if home == layout else mirrored(agent)


def _plain(layout: str) -> str:
    """Returns the layout that trained partners of a layout come from: a mirrored kitchen's is its image."""
    return layout.removesuffix(MIRRORED)

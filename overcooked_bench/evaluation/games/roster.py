"""The partners of a layout: who they are, and the agents that play them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import find, load_agent
from overcooked_bench.agents.pools.pool import Pool, PoolError
from overcooked_bench.agents.seated import Seated
from overcooked_bench.evaluation.protocol import Protocol, ProtocolError
from overcooked_bench.kitchen.layout import MIRRORED

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent
    from overcooked_bench.agents.policies.policy import Architecture

TRAINED: Final = "trained"
SCRIPTED: Final = "scripted"
FLOOR: Final = "floor"


@dataclass(frozen=True)
class Partner:
    """One partner on one layout.

    Attributes:
        name: Unique on its layout.
        sha256: Hash of the weights, or of the scripted agent's name.
        kind: "trained" and "scripted" count; "floor" is shown apart.
    """

    name: str
    sha256: str
    kind: str


def check_pool(pool: Pool, protocol: Protocol, layouts: Sequence[str]) -> None:
    """Makes sure that a pool can be played under a protocol.

    Raises:
        ProtocolError: Cooking or action mode differ, or a layout has no agents in it.
    """
    for what, of_pool, of_protocol in (
        ("cooking", pool.cooking, protocol.cooking),
        ("mode", pool.mode, protocol.mode),
    ):
        if of_pool != of_protocol:
            raise ProtocolError(
                f"protocol {protocol.name!r} plays {what} {of_protocol!r}, but the pool {pool.name!r} was made for "
                f"{of_pool!r}; choose a pool of {of_protocol!r}"
            )
    bare = [layout for layout in layouts if not pool.agents(_plain(layout))]
    if bare:
        raise ProtocolError(
            f"the pool {pool.name!r} has no agents for {', '.join(bare)}; it covers {', '.join(pool.layouts)}. "
            "Choose among them with --layouts, or another pool with --pool"
        )


@lru_cache(maxsize=2)
def pool_as_hashed(folder: str | None, sha256: str | None) -> Pool | None:
    """Gives the pool of a folder, read once a process, as it was when playing began; None for no folder.

    Raises:
        PoolError: It was changed since then, or is damaged.
    """
    if folder is None:
        return None
    pool = Pool.load(folder)
    if pool.hash != sha256:
        raise PoolError(
            f"{folder}: the pool was changed while it was being played (SHA-256 {str(sha256)[:12]}… when that "
            f"began, {pool.hash[:12]}… now); run it again, with another --output where some blocks are finished"
        )
    return pool


def roster(protocol: Protocol, pool: Pool | None, layout: str) -> tuple[Partner, ...]:
    """Lists every partner that is played on a layout, by name.

    Raises:
        ProtocolError: A trained and a scripted partner have the same name.
    """
    trained = [
        Partner(agent.name, agent.files.weights.sha256, TRAINED)
        for agent in (pool.agents(_plain(layout)) if pool else ())
    ]
    scripted = [Partner(name, find(name).sha256, SCRIPTED) for name in protocol.partners]
    floors = [Partner(name, find(name).sha256, FLOOR) for name in protocol.floors]
    partners = sorted(trained + scripted + floors, key=lambda partner: partner.name)
    for partner, following in pairwise(partners):
        if partner.name == following.name:
            raise ProtocolError(f"two partners on {layout} are named {partner.name!r}; rename the pool's agent")
    return tuple(partners)


def seat_partners(
    partners: Sequence[Partner],
    who: NDArray[np.int64],
    seats: NDArray[np.int64],
    pool: Pool | None,
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
        if partner.kind == TRAINED:
            assert pool is not None
            stacks.setdefault(pool.policy(home, partner.name).architecture, []).append(index)
        else:
            rows = np.flatnonzero(who == index)
            parties.append(Seated(_scripted(partner.name, layout), partner.name, rows, seats[rows]))
    for indices in stacks.values():
        from overcooked_bench.agents.mirror import mirrored
        from overcooked_bench.agents.policies.neural import NeuralAgent

        assert pool is not None
        rows = np.flatnonzero(np.isin(who, indices))
        rows = rows[np.argsort(who[rows], kind="stable")]
        policies = [pool.policy(home, partners[index].name) for index in indices]
        agent: Agent = NeuralAgent(policies, mode, index=np.searchsorted(indices, who[rows]))  # type: ignore[arg-type]
        names = ", ".join(partners[index].name for index in indices)
        parties.append(Seated(agent if home == layout else mirrored(agent), names, rows, seats[rows]))
    return parties


@lru_cache(maxsize=64)
def _scripted(name: str, layout: str) -> "Agent":
    """Makes a scripted partner once a process: a reset is all that it needs, and its paths are long to find."""
    return load_agent(name, layout)


def _plain(layout: str) -> str:
    """Gives the layout that trained partners of a layout come from: in a mirrored kitchen they are shown its image."""
    return layout.removesuffix(MIRRORED)

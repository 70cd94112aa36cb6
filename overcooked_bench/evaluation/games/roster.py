"""The partners of a layout: who they are, and the agents that play them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby, islice
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.pools.manifest import PoolError, check_version
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import BehaviourReference, Entry, PolicyReference, ScriptedReference
from overcooked_bench.agents.seated import Seated
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.pools.normalised import normalised, partner_shares
from overcooked_bench.evaluation.protocol import Play, Protocol, ProtocolError
from overcooked_bench.kitchen.layout import MIRRORED, Layout

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent
    from overcooked_bench.agents.policies.policy import Architecture, Policy

Kind = Literal["trained", "scripted", "floor"]
FLOOR: Final = "floor"
"""The kind of partners that are listed separately and do not count in any score."""
SELF: Final = "self"
"""The kind of a copy of the scored agent, which counts in no score."""
ITSELF: Final = "itself"
"""The name of that copy, and what its start states and its seeds depend on: all agents meet themselves in the same."""


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


@dataclass(frozen=True)
class Itself:
    """A copy of the scored agent, as its own partner.

    Attributes:
        sha256: Hash of the agent.
    """

    sha256: str
    name = ITSELF
    kind = SELF


def check_pool(pool: Pool, protocol: Protocol, layouts: Sequence[str]) -> None:
    """Makes sure that a pool can be played under a protocol.

    Raises:
        ProtocolError: Cooking or action mode differ, or a layout has no partners that count.
        PoolError: A scripted partner has another version here than the pool means, or partners have weights or bounds
            that they cannot be scored with.
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
        _check_measured(pool, layout, protocol)


def _check_measured(pool: Pool, layout: str, protocol: Protocol) -> None:
    """Computes shares, and N where it is reported, of made-up returns: what fails now would fail in the end."""
    entries = [partner.entry for partner in roster(pool, layout, protocol.play.per_stratum)]
    bounded, sides = [entry for entry in entries if entry.bounds], _sides(Layout.load(layout), protocol.play)
    returns = np.full((1, len(bounded), max(sides) + 1), np.nan)
    returns[..., sides] = 0.0
    try:
        partner_shares([entry for entry in entries if entry.role != FLOOR])
        if not protocol.report.metrics or {"n", "h50"} & set(protocol.report.metrics):
            normalised(returns, bounded)
    except WrongUse as error:
        raise PoolError(f"the pool {pool.name!r} on {layout}: {error}") from error


def _sides(layout: Layout, play: Play) -> list[int]:
    """Lists the regions that the scored agent can start in."""
    if play.start == "standard" and layout.start_cells:
        return [layout.regions[layout.start_cells[seat]] for seat in play.seats]
    able = layout.start_regions
    return np.flatnonzero(np.any([able.any(axis=1 - seat) for seat in play.seats], axis=0)).tolist()


@lru_cache(maxsize=16)
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


def roster(pool: Pool, layout: str, per_stratum: int | None = None) -> tuple[Partner, ...]:
    """Lists every partner that is played on a layout, by name.

    Args:
        pool: The partners.
        layout: Where.
        per_stratum: So many partners of each stratum, those of greatest weight, and no floors; all by default.
    """
    plain = _plain(layout)
    entries = pool.partners(plain if plain in pool.layouts else Layout.load(plain).name)
    if per_stratum is not None:
        ranked = sorted(entries, key=lambda entry: (entry.stratum, -(entry.weight or 0), entry.name))
        groups = groupby((entry for entry in ranked if entry.role != FLOOR), key=lambda entry: entry.stratum)
        kept = {entry.name for _, group in groups for entry in islice(group, per_stratum)}
        entries = tuple(entry for entry in entries if entry.name in kept)
    return tuple(map(Partner, entries))


def seat_partners(
    partners: Sequence[Partner | Itself],
    who: NDArray[np.int64],
    seats: NDArray[np.int64],
    pool: Pool,
    mode: str,
    layout: str,
) -> list[Seated]:
    """Makes the agents that play the partners: one for all policies of an architecture, one for each scripted name.

    Args:
        partners: From `roster`; for the agent itself nobody is made.
        who: (N,) int64, index of the partner in each kitchen.
        seats: (N,) int64, the partner's seat in each kitchen.
        pool: Where trained partners come from.
        mode: How they act.
        layout: Where they play.
    """
    present = {index: partners[index] for index in np.unique(who).tolist()}
    entries = {index: partner.entry for index, partner in present.items() if isinstance(partner, Partner)}
    trained = [index for index, entry in entries.items() if isinstance(entry.reference, PolicyReference)]
    policies = {index: pool.policy(_plain(layout), partners[index].name) for index in trained}
    parties = []
    for index, entry in entries.items():
        if index not in policies:
            rows = np.flatnonzero(who == index)
            parties.append(seat_scripted(entry, rows, seats[rows], layout))
    return parties + seat_policies(policies, who, seats, mode, layout)


def seat_scripted(entry: Entry, rows: NDArray[np.int64], seats: NDArray[np.int64], layout: str) -> Seated:
    """Makes the agent that plays a scripted entry in some kitchens; one process has one agent for each scripted entry.

    Args:
        entry: Of a scripted agent or a behaviour.
        rows: (B,) its kitchens; a kitchen is listed twice if it sits on both seats.
        seats: (B,) its seat in each.
        layout: Where it plays.
    """
    return Seated(_scripted(entry, layout), entry.name, rows, seats)


def seat_policies(
    policies: "Mapping[int, Policy]", who: NDArray[np.int64], seats: NDArray[np.int64], mode: str, layout: str
) -> list[Seated]:
    """Makes the agents that play frozen policies: one for all policies of an architecture.

    Args:
        policies: Index -> policy.
        who: (N,) int64, the index of who plays in each kitchen; kitchens of other indices get no agent.
        seats: (N,) int64, the seat in each kitchen.
        mode: How they act.
        layout: Where they play.
    """
    stacks: dict[Architecture, list[int]] = {}
    for index in np.unique(who).tolist():
        if index in policies:
            stacks.setdefault(policies[index].architecture, []).append(index)
    parties = []
    for indices in stacks.values():
        from overcooked_bench.agents.policies.neural import NeuralAgent

        rows = np.flatnonzero(np.isin(who, indices))
        rows = rows[np.argsort(who[rows], kind="stable")]
        stacked, index = [policies[i] for i in indices], np.searchsorted(indices, who[rows])
        agent: Agent = NeuralAgent(stacked, mode, index=index)  # type: ignore[arg-type]
        names = ", ".join(policy.name for policy in stacked)
        parties.append(Seated(agent if _plain(layout) == layout else mirrored(agent), names, rows, seats[rows]))
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

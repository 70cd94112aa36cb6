"""The block, the unit of play: every partner of a layout from every seat, in one batch, for one start state each."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, UnknownLayout
from overcooked_bench.agents.catalogue import find_unchanged
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.seated import Seated, SeatedFault
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.evaluation.games.episode import Episode, pack_actions, pack_state, side_of
from overcooked_bench.evaluation.games.play import Games, make_kitchens, play
from overcooked_bench.evaluation.games.roster import Partner, pool_as_hashed, roster, seat_partners
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.kitchen.layout import MIRRORED, Layout

EGO: Final = "the scored agent"
"""What faults call it; no partner has a name with a space."""


@dataclass(frozen=True)
class Block:
    """What is to be played; small enough to be sent anywhere.

    Attributes:
        agent: Name or path of the scored agent.
        agent_sha256: Hash of what it was when the score began.
        protocol: What is played.
        pool: Folder of the trained partners, or None.
        pool_sha256: Its hash when the score began, or None.
        seed: Of the whole score.
        layout: Where.
        training_seed: Which training run of the agent.
        episode: Index of the start states.
    """

    agent: str
    agent_sha256: str
    protocol: Protocol
    pool: str | None
    pool_sha256: str | None
    seed: int
    layout: str
    training_seed: int
    episode: int

    @property
    def key(self) -> tuple[str, int, int]:
        """(layout, training seed, episode)."""
        return self.layout, self.training_seed, self.episode


class Outcome(NamedTuple):
    """What became of a block.

    Attributes:
        key: (layout, training seed, episode).
        episodes: One for each partner and seat; empty where nothing was finished.
        adapted: Whether the agent was given the mirror image.
        unknown: Why the agent does not play this layout, or None.
        fault: What the agent did wrong, or None.
    """

    key: tuple[str, int, int]
    episodes: tuple[Episode, ...] = ()
    adapted: bool = False
    unknown: str | None = None
    fault: str | None = None


def play_block(block: Block) -> Outcome:
    """Plays a block; the result depends on the block alone.

    A fault of the scored agent comes back as an outcome, so that no other block is lost with it.

    Raises:
        AgentError: The agent was changed since the score began.
        PoolError: The pool was.
    """
    partners = roster(block.protocol, pool_as_hashed(block.pool, block.pool_sha256), block.layout)
    who, seats = _deal(block, partners)
    with one_thread():
        with calling("loading", LOADING):
            make = find_unchanged(block.agent, block.agent_sha256, block.protocol.mode).make
        try:
            try:
                games, adapted = _play(block, make, partners, who, seats, adapted=False), False
            except UnknownLayout:
                if not block.layout.endswith(MIRRORED):
                    raise
                games, adapted = _play(block, make, partners, who, seats, adapted=True), True
        except UnknownLayout as error:
            return Outcome(block.key, unknown=str(error))
        except AgentError as error:
            return Outcome(block.key, fault=f"{block.layout}, training seed {block.training_seed}: {error}")
        except SeatedFault as fault:
            if fault.who != EGO:  # a partner of ours
                raise
            return Outcome(block.key, fault=_blame(fault, block, partners, who, seats))
    return Outcome(block.key, tuple(_episodes(block, partners, who, seats, games)), adapted)


def _play(
    block: Block,
    make: Callable[[str, int], Agent],
    partners: Sequence[Partner],
    who: NDArray[np.int64],
    seats: NDArray[np.int64],
    adapted: bool,
) -> Games:
    protocol, layout = block.protocol, block.layout
    pool = pool_as_hashed(block.pool, block.pool_sha256)
    with _seeded(stream_key(*_belongs(block), block.training_seed)):
        with calling("make_agent", LOADING):
            ego = make(layout.removesuffix(MIRRORED) if adapted else layout, block.training_seed)
        parties = [
            Seated(mirrored(ego) if adapted else ego, EGO, np.arange(len(who)), seats),
            *seat_partners(partners, who, 1 - seats, pool, protocol.mode, layout),
        ]
        kitchens = make_kitchens(
            layout,
            len(who),
            parties,
            cooking=protocol.cooking,
            horizon=protocol.horizon,
            start=protocol.start,
            object_probability=protocol.object_probability,
        )
        starts = [stream_key(*_belongs(block), partner.sha256, "start") for partner in partners]
        kitchens.reset(seed=np.array(starts, np.uint64)[who])
        return play(kitchens, parties, _streams(block, partners, who, seats))


def _episodes(
    block: Block, partners: Sequence[Partner], who: NDArray[np.int64], seats: NDArray[np.int64], games: Games
) -> Iterator[Episode]:
    """Lays the rows out as episodes, by partner and seat."""
    layout = Layout.load(block.layout)
    for row in np.lexsort((seats, who)):
        partner, mine, theirs = partners[who[row]], int(seats[row]), 1 - int(seats[row])
        yield Episode(
            *(block.layout, block.training_seed, block.episode, partner.name, mine),
            side=side_of(layout, games.starts[row], mine),
            partner_sha256=partner.sha256,
            kind=partner.kind,
            soup_reward=float(games.soup_reward[row].sum()),
            ego_partial_reward=float(games.partial_reward[row, mine]),
            partner_partial_reward=float(games.partial_reward[row, theirs]),
            ego_soups=int(games.soups[row, mine]),
            partner_soups=int(games.soups[row, theirs]),
            start=pack_state(games.starts[row]),
            actions=pack_actions(games.actions[:, row]),
        )


def _belongs(block: Block) -> tuple[str, int, str, int]:
    """Gives what every stream of an episode depends on besides its partner."""
    return block.protocol.sha256, block.seed, block.layout, block.episode


def _deal(block: Block, partners: Sequence[Partner]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Deals the rows: (N,) partner and (N,) seat of the scored agent, in an order that tells it nothing."""
    hands = [(index, seat) for index in range(len(partners)) for seat in sorted(block.protocol.seats)]
    hands.sort(key=lambda hand: stream_key(*_belongs(block), partners[hand[0]].sha256, "row", hand[1]))
    who, seats = np.array(hands, np.int64).T
    return np.ascontiguousarray(who), np.ascontiguousarray(seats)


def _streams(
    block: Block, partners: Sequence[Partner], who: NDArray[np.int64], seats: NDArray[np.int64]
) -> NDArray[np.uint64]:
    """Gives the random stream of the agent on each seat: (N, 2); the roles' streams differ."""
    streams = np.empty((len(who), 2), np.uint64)
    for row, (index, seat) in enumerate(zip(who.tolist(), seats.tolist(), strict=True)):
        parts = (*_belongs(block), partners[index].sha256, seat)
        streams[row, seat] = stream_key(*parts, "ego")
        streams[row, 1 - seat] = stream_key(*parts, "partner")
    return streams


def _blame(
    fault: SeatedFault, block: Block, partners: Sequence[Partner], who: NDArray[np.int64], seats: NDArray[np.int64]
) -> str:
    if fault.row is None:
        names = ", ".join(partner.name for partner in partners)
        where = (
            f"partners {names} (one call plays them all), seats {' and '.join(map(str, sorted(block.protocol.seats)))}"
        )
    else:
        where = f"partner {partners[who[fault.row]].name}, seat {seats[fault.row]}"
    cell = f"{block.layout}, training seed {block.training_seed}, episode {block.episode}"
    return f"{cell}, {where}, {fault.when}: {fault.what}"


@contextmanager
def _seeded(key: int) -> Iterator[None]:
    """Seeds the global generators, for submissions that draw from them, and puts them back."""
    import random

    import torch

    states = random.getstate(), np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
    random.seed(key)
    np.random.seed(key % 2**32)  # noqa: NPY002
    torch.manual_seed(key)
    try:
        yield
    finally:
        random.setstate(states[0])
        np.random.set_state(states[1])  # noqa: NPY002
        torch.set_rng_state(states[2])

"""The block, the unit of play: every partner of a layout from every seat, in one batch, for one start state each."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import AgentFactory, UnknownLayout
from overcooked_bench.agents.catalogue import find_unchanged, runs_code
from overcooked_bench.agents.kinds import RUNS_CODE
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.saying import describe
from overcooked_bench.agents.seated import Seated, SeatedFault
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.turned import Turned
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.evaluation.games.episode import Episode, pack_actions, pack_state, side_of
from overcooked_bench.evaluation.games.play import Games, make_kitchens, play
from overcooked_bench.evaluation.games.roster import Partner, pool_as_hashed, roster, seat_partners
from overcooked_bench.evaluation.games.streams import Streams
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
        salt: The run's salt, which every stream depends on.
        pool: Folder of the pool.
        pool_sha256: Its hash when the score began.
        seed: Of the whole score.
        layout: Where.
        training_seed: Which training run of the agent.
        episode: Index of the start states.
        adapted: Whether the agent is given the mirror image, as it asked for (`asking.py`).
        turned: Whether the agent is handed its rows in reverse order, see `again.py`.
    """

    agent: str
    agent_sha256: str
    protocol: Protocol
    salt: str
    pool: str
    pool_sha256: str
    seed: int
    layout: str
    training_seed: int
    episode: int
    adapted: bool = False
    turned: bool = False

    @property
    def streams(self) -> Streams:
        """The random streams of its episodes."""
        return Streams(self.protocol.sha256, self.salt, self.seed, self.layout, self.episode)

    @property
    def key(self) -> tuple[str, int, int]:
        """(layout, training seed, episode)."""
        return self.layout, self.training_seed, self.episode


class Outcome(NamedTuple):
    """What became of a block.

    Attributes:
        key: (layout, training seed, episode).
        episodes: One for each partner and seat; empty where nothing was finished.
        fault: What the agent did wrong, or None.
    """

    key: tuple[str, int, int]
    episodes: tuple[Episode, ...] = ()
    fault: str | None = None


def play_block(block: Block) -> Outcome:
    """Plays a block; the result depends on the block alone.

    A fault of the scored agent comes back as an outcome, so that no other block is lost with it.

    Raises:
        AgentError: The agent was changed since the score began.
        PoolError: The pool was.
    """
    try:
        return _outcome(block)
    except OvercookedBenchError:
        raise
    except Exception as error:
        if not runs_code(block.agent):
            raise
        why = f"code outside of the agent failed ({describe(error)}): does the agent change what that code uses?"
        return Outcome(block.key, fault=f"{_cell(block)}: {why}")


def _outcome(block: Block) -> Outcome:
    partners = roster(pool_as_hashed(block.pool, block.pool_sha256), block.layout)
    who, seats = _deal(block, partners)
    with one_thread():
        with calling("loading", LOADING):
            entrant = find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode)
        try:
            games = _play(block, entrant.make, partners, who, seats)
        except UnknownLayout as error:
            why = f"it declines ({error}), although it plays this layout when asked before"
            return Outcome(block.key, fault=f"{block.layout}, training seed {block.training_seed}: {why}")
        except AgentError as error:
            return Outcome(block.key, fault=f"{block.layout}, training seed {block.training_seed}: {error}")
        except SeatedFault as fault:
            if fault.who != EGO and entrant.kind not in RUNS_CODE:  # a partner of ours
                raise
            return Outcome(block.key, fault=_blame(fault, block, partners, who, seats))
    return Outcome(block.key, tuple(_episodes(block, partners, who, seats, games)))


def _play(
    block: Block,
    make: AgentFactory,
    partners: Sequence[Partner],
    who: NDArray[np.int64],
    seats: NDArray[np.int64],
) -> Games:
    rules, layout, adapted = block.protocol.play, block.layout, block.adapted
    pool = pool_as_hashed(block.pool, block.pool_sha256)
    with _seeded(block.streams.of_process(block.training_seed)):
        with calling("make_agent", LOADING):
            ego = make(layout.removesuffix(MIRRORED) if adapted else layout, block.training_seed)
        player = mirrored(ego) if adapted else ego
        parties = [
            Seated(Turned(player) if block.turned else player, EGO, np.arange(len(who)), seats),
            *seat_partners(partners, who, 1 - seats, pool, rules.mode, layout),
        ]
        kitchens = make_kitchens(layout, len(who), parties, **rules.kitchens)
        streams = block.streams
        starts = np.array([streams.start(partner.sha256) for partner in partners], np.uint64)
        kitchens.reset(seed=starts[who])
        return play(kitchens, parties, streams.seeds([partners[index].sha256 for index in who], seats))


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


def _deal(block: Block, partners: Sequence[Partner]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Deals the rows: (N,) partner and (N,) seat of the scored agent, in an order that depends on nobody's hash."""
    hands = [(index, seat) for index in range(len(partners)) for seat in sorted(block.protocol.play.seats)]
    who, seats = np.array([hands[k] for k in block.streams.order(len(hands))], np.int64).T
    return np.ascontiguousarray(who), np.ascontiguousarray(seats)


def _blame(
    fault: SeatedFault, block: Block, partners: Sequence[Partner], who: NDArray[np.int64], seats: NDArray[np.int64]
) -> str:
    if fault.who != EGO:
        where = f"partner {fault.who}, which fails beside no other agent: does this one change what both use?"
    elif fault.row is None:
        names, every = ", ".join(partner.name for partner in partners), sorted(block.protocol.play.seats)
        where = f"partners {names} (one call plays them all), seats {' and '.join(map(str, every))}"
    else:
        where = f"partner {partners[who[fault.row]].name}, seat {seats[fault.row]}"
    return f"{_cell(block)}, {where}, {fault.when}: {fault.what}"


def _cell(block: Block) -> str:
    return f"{block.layout}, training seed {block.training_seed}, episode {block.episode}"


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

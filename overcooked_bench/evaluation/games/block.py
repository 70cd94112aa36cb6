"""The block, the unit of play: every partner of a layout from every seat, in one batch, for some start states each.

Axes: N rows of a batch: the start states one after the other, and for each of them every partner and seat.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, AgentFactory, UnknownLayout
from overcooked_bench.agents.catalogue import find_unchanged, runs_code
from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.agents.kinds import RUNS_CODE
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.saying import describe
from overcooked_bench.agents.seated import Seated, SeatedFault
from overcooked_bench.agents.seeding import seeded
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.turned import Turned
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.evaluation.games.episode import BlockKey, Episode, pack_actions, pack_state, side_of
from overcooked_bench.evaluation.games.play import Games, make_kitchens, play
from overcooked_bench.evaluation.games.roster import ITSELF, Itself, Partner, pool_as_hashed, roster, seat_partners
from overcooked_bench.evaluation.games.streams import Streams
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.kitchen.layout import MIRRORED, Layout

EGO: Final = "the scored agent"
"""What faults call it; no partner has a name with a space."""
COPY: Final = "a copy of the scored agent"


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
        episodes: Indices of the start states.
        adapted: Whether the agent is given the mirror image, as it asked for (`asking.py`).
        turned: Whether the agent is handed its rows in reverse order, see `again.py`.
        isolation: How a submission is isolated; None plays it in the process that plays the block.
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
    episodes: tuple[int, ...]
    adapted: bool = False
    turned: bool = False
    isolation: Isolation | None = None

    def streams(self, episode: int) -> Streams:
        """Returns the random streams of a start state."""
        return Streams(self.protocol.sha256, self.salt, self.seed, self.layout, episode)

    @property
    def keys(self) -> tuple[BlockKey, ...]:
        """(layout, training seed, episode) for each start state, as the store knows them."""
        return tuple((self.layout, self.training_seed, episode) for episode in self.episodes)

    @property
    def cell(self) -> str:
        """Which block this is, for messages."""
        first, *others = self.episodes
        which = f"s {first} to {others[-1]}" if others else f" {first}"
        return f"{self.layout}, training seed {self.training_seed}, episode{which}"


class Outcome(NamedTuple):
    """What became of a block.

    Attributes:
        block: The block.
        episodes: One for each start state, partner and seat; empty where nothing was finished.
        fault: What the agent did wrong, or None.
    """

    block: Block
    episodes: tuple[Episode, ...] = ()
    fault: str | None = None

    @property
    def by_key(self) -> Mapping[BlockKey, list[Episode]]:
        """The episodes of each start state."""
        found: dict[BlockKey, list[Episode]] = {key: [] for key in self.block.keys}
        for episode in self.episodes:
            found[episode.block].append(episode)
        return found


class _Rows(NamedTuple):
    """Who plays in each row of the batch.

    Attributes:
        episodes: (N,) int64, index of the start state.
        who: (N,) int64, index of the partner.
        seats: (N,) int64, seat of the scored agent.
    """

    episodes: NDArray[np.int64]
    who: NDArray[np.int64]
    seats: NDArray[np.int64]


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
        if block.isolation is not None or not runs_code(block.agent):
            raise
        why = f"code outside of the agent failed ({describe(error)}): does the agent change what that code uses?"
        return Outcome(block, fault=f"{block.cell}: {why}")


def met(block: Block, pool: Pool) -> tuple[Partner | Itself, ...]:
    """Lists everybody that the agent meets in a block, from each seat in each start state."""
    play = block.protocol.play
    partners = roster(pool, block.layout, play.per_stratum)
    return (*partners, Itself(block.agent_sha256)) if play.self_play else partners


def rows_of(block: Block) -> int:
    """Returns how many episodes a block has."""
    partners = met(block, pool_as_hashed(block.pool, block.pool_sha256))
    return len(block.episodes) * len(partners) * len(block.protocol.play.seats)


def _outcome(block: Block) -> Outcome:
    partners = met(block, pool_as_hashed(block.pool, block.pool_sha256))
    rows = _deal(block, partners)
    with one_thread():
        with calling("loading", LOADING):
            entrant = find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode, block.isolation)
        try:
            games = _play(block, entrant.make, partners, rows)
        except UnknownLayout as error:
            why = f"it declines ({error}), although it plays this layout when asked before"
            return Outcome(block, fault=f"{block.layout}, training seed {block.training_seed}: {why}")
        except AgentError as error:
            return Outcome(block, fault=f"{block.layout}, training seed {block.training_seed}: {error}")
        except SeatedFault as fault:
            if fault.who not in (EGO, COPY) and (block.isolation is not None or entrant.kind not in RUNS_CODE):
                raise  # a partner of ours failed, and no code of a submission is in this process
            return Outcome(block, fault=_blame(fault, block, partners, rows))
    return Outcome(block, tuple(_episodes(block, partners, rows, games)))


def _play(block: Block, make: AgentFactory, partners: Sequence[Partner | Itself], rows: _Rows) -> Games:
    rules, layout = block.protocol.play, block.layout
    pool = pool_as_hashed(block.pool, block.pool_sha256)
    number = len(rows.who)
    with seeded(block.streams(block.episodes[0]).of_process(block.training_seed)):
        player, with_itself = _make(block, make), _with_itself(partners, rows)
        parties = [
            Seated(Turned(player) if block.turned else player, EGO, np.arange(number), rows.seats),
            *seat_partners(partners, rows.who, 1 - rows.seats, pool, rules.mode, layout),
        ]
        if len(with_itself):
            parties.append(Seated(_make(block, make), COPY, with_itself, 1 - rows.seats[with_itself]))
        kitchens = make_kitchens(layout, number, parties, **rules.kitchens)
        hashes = [ITSELF if isinstance(partner, Itself) else partner.sha256 for partner in partners]
        starts, seeds = np.empty(number, np.uint64), np.empty((number, 2), np.uint64)
        for episode in block.episodes:
            streams, here = block.streams(episode), rows.episodes == episode
            starts[here] = np.array([streams.start(sha256) for sha256 in hashes], np.uint64)[rows.who[here]]
            seeds[here] = streams.seeds([hashes[index] for index in rows.who[here]], rows.seats[here])
        kitchens.reset(seed=starts)
        return play(kitchens, parties, seeds)


def _make(block: Block, make: AgentFactory) -> Agent:
    """Makes the scored agent, or a copy of it."""
    layout = block.layout.removesuffix(MIRRORED) if block.adapted else block.layout
    with calling("make_agent", LOADING):
        agent = make(layout, block.training_seed)
    return mirrored(agent) if block.adapted else agent


def _with_itself(partners: Sequence[Partner | Itself], rows: _Rows) -> NDArray[np.int64]:
    """Returns the rows in which the agent meets itself."""
    itself = [index for index, partner in enumerate(partners) if isinstance(partner, Itself)]
    return np.flatnonzero(np.isin(rows.who, itself))


def _episodes(block: Block, partners: Sequence[Partner | Itself], rows: _Rows, games: Games) -> Iterator[Episode]:
    """Lays the rows out as episodes, by start state, partner and seat."""
    layout = Layout.load(block.layout)
    for row in np.lexsort((rows.seats, rows.who, rows.episodes)):
        partner, mine = partners[rows.who[row]], int(rows.seats[row])
        yield Episode(
            *(block.layout, block.training_seed, int(rows.episodes[row]), partner.name, mine),
            side=side_of(layout, games.starts[row], mine),
            partner_sha256=partner.sha256,
            kind=partner.kind,
            soup_reward=float(games.soup_reward[row].sum()),
            ego_partial_reward=float(games.partial_reward[row, mine]),
            partner_partial_reward=float(games.partial_reward[row, 1 - mine]),
            ego_soups=int(games.soups[row, mine]),
            partner_soups=int(games.soups[row, 1 - mine]),
            start=pack_state(games.starts[row]),
            actions=pack_actions(games.actions[:, row]),
        )


def _deal(block: Block, partners: Sequence[Partner | Itself]) -> _Rows:
    """Deals the rows of each start state in an order of its own, which depends on nobody's hash."""
    hands = [(index, seat) for index in range(len(partners)) for seat in sorted(block.protocol.play.seats)]
    dealt = [(e, *hands[k]) for e in block.episodes for k in block.streams(e).order(len(hands))]
    return _Rows(*np.ascontiguousarray(np.array(dealt, np.int64).T))


def _blame(fault: SeatedFault, block: Block, partners: Sequence[Partner | Itself], rows: _Rows) -> str:
    cell = block.cell
    if fault.who == COPY:
        where = "its copy that it plays with"
    elif fault.who != EGO:
        where = f"partner {fault.who}, which fails beside no other agent: does this one change what both use?"
    elif fault.row is None:
        names, every = ", ".join(partner.name for partner in partners), sorted(block.protocol.play.seats)
        where = f"partners {names} (one call plays them all), seats {' and '.join(map(str, every))}"
    else:
        cell = replace(block, episodes=(int(rows.episodes[fault.row]),)).cell
        where = f"partner {partners[rows.who[fault.row]].name}, seat {rows.seats[fault.row]}"
    return f"{cell}, {where}, {fault.when}: {fault.what}"

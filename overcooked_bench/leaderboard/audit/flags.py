"""Looks for what is unusual in a result: for people to look at, no verdicts.

Axes: N rows (cells times partners), S training seeds.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.seated import Seated
from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.games.block import Block
from overcooked_bench.evaluation.games.episode import BlockKey, Episode
from overcooked_bench.evaluation.games.roster import FLOOR, SELF, pool_as_hashed, roster, seat_partners
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.scores import LayoutFacts, Scores
from overcooked_bench.leaderboard.audit.again import recorded
from overcooked_bench.leaderboard.audit.fed import follow
from overcooked_bench.leaderboard.audit.records import Flag

SIMILAR: Final = 0.9
"""Share of steps in which an agent acts as a partner would."""
UNEVEN: Final = 0.25
"""Difference of the seats' mean returns, as a share of the greater one."""
IDENTICAL: Final = 0.5
"""Share of cells that two training runs play with the same joint actions."""
_FEW: Final = 4
"""Cells of a block in which partners are asked."""


def similar_partners(block: Block, episodes: Sequence[Episode]) -> Iterator[Flag]:
    """Yields the partners whose likeliest actions are the scored agent's, in its own states and on its seat.

    Args:
        block: One block.
        episodes: Its recorded episodes, of which a few are looked at.
    """
    pool, play = pool_as_hashed(block.pool, block.pool_sha256), block.protocol.play
    partners = [one for one in roster(pool, block.layout, play.per_stratum) if one.kind != FLOOR]

    def seated(who: NDArray[np.int64], seats: NDArray[np.int64]) -> list[Seated]:
        return seat_partners(partners, who, seats, pool, "greedy", block.layout)

    yield from _similar(block, episodes, [f"partner {one.name}" for one in partners], seated)


def similar_entries(block: Block, episodes: Sequence[Episode]) -> Iterator[Flag]:
    """Yields the training runs of shipped entries whose likeliest actions are the scored agent's, likewise.

    The scored agent itself is left out, and so are entries of another cooking mode.

    Args:
        block: One block.
        episodes: Its recorded episodes, of which a few are looked at.
    """
    names, agents = [], []
    for entry in shipped_entries():
        loaded, found = load_entry(entry), find(entry, mode="greedy")
        if found.sha256 != block.agent_sha256 and loaded.pool.cooking == block.protocol.play.cooking:
            for run in range(len(loaded.runs.get(block.layout, ()))):
                names.append(f"entry {entry}, training run {run},")
                agents.append(found.make(block.layout, run))

    def seated(who: NDArray[np.int64], seats: NDArray[np.int64]) -> list[Seated]:
        rows = [np.flatnonzero(who == number) for number in range(len(agents))]
        return [Seated(agent, name, own, seats[own]) for agent, name, own in zip(agents, names, rows, strict=True)]

    yield from _similar(block, episodes, names, seated)


def _similar(
    block: Block,
    episodes: Sequence[Episode],
    names: Sequence[str],
    seated: Callable[[NDArray[np.int64], NDArray[np.int64]], Sequence[Seated]],
) -> Iterator[Flag]:
    """Yields those of some agents that act as recorded on the scored agent's seat.

    Args:
        block: One block.
        episodes: Its recorded episodes.
        names: Of K agents.
        seated: Seats agents, by (N,) number and (N,) seat.
    """
    cells = [episode for episode in episodes if episode.kind not in (FLOOR, SELF)][:_FEW]
    if not (names and cells):
        return
    rows = [cell for _ in names for cell in cells]
    who, seats = np.repeat(np.arange(len(names)), len(cells)), np.array([cell.seat for cell in rows])
    same = follow(block, rows, seated(who, seats))[np.arange(len(rows)), seats].reshape(len(names), len(cells))
    shares = same.mean(axis=1) / block.protocol.play.horizon
    for name, share in zip(names, shares.tolist(), strict=True):
        if share >= SIMILAR:
            said = f"acts as {name} would in {share:.0%} of steps (training seed {block.training_seed})"
            yield Flag("similarity", said, block.layout, share)


def above_ceilings(episodes: Sequence[Episode], layout: LayoutFacts) -> Iterator[Flag]:
    """Yields the partners with whom the mean return is above what the best known responder reached.

    Args:
        episodes: All of one layout.
        layout: Its partners and their bounds.
    """
    for label in layout.partners:
        for bound in label.bounds or ():
            returns = [one.soup_reward for one in episodes if one.partner == label.name and one.side == bound.side]
            reached = t_interval(returns) if len(returns) > 1 else None
            if reached is not None and reached.low is not None and reached.low > bound.ceiling:
                said = (
                    f"{reached.value:.1f} points with {label.name} from side {bound.side}, ceiling {bound.ceiling:.1f}"
                )
                yield Flag("above the ceiling", said, layout.layout, reached.value)


def uneven_seats(scores: Scores) -> Iterator[Flag]:
    """Yields the layouts on which the seats' mean returns differ much."""
    for layout in scores.layouts:
        means = [row.value for row in scores.select("mean", layout=layout.layout, partner=None) if row.seat is not None]
        if means and max(means) >= layout.soup_points and max(means) - min(means) > UNEVEN * max(means):
            said = f"{max(means):.1f} points from one seat, {min(means):.1f} from the other"
            yield Flag("seat gap", said, layout.layout, max(means) - min(means))


def identical_runs(found: Mapping[BlockKey, Sequence[Episode]]) -> Iterator[Flag]:
    """Yields the pairs of training seeds that play the same.

    Args:
        found: Episodes by block.
    """
    runs: dict[int, dict[tuple[object, ...], bytes]] = {}
    for (layout, run, number), episodes in found.items():
        played = runs.setdefault(run, {})
        played |= {(layout, number, one.partner, one.seat): one.actions for one in episodes}
    for first, second in combinations(sorted(runs), 2):
        common = runs[first].keys() & runs[second].keys()
        same = sum(runs[first][cell] == runs[second][cell] for cell in common) / max(len(common), 1)
        if same >= IDENTICAL:
            said = f"training seeds {first} and {second} play {same:.0%} of cells with the same joint actions"
            yield Flag("identical runs", said, None, same)


def same_as_partner(scores: Scores) -> Iterator[Flag]:
    """Yields the partners that are the scored agent itself."""
    for layout in scores.layouts:
        for label in layout.partners:
            if label.counts and label.is_ego:
                yield Flag("similarity", f"it is partner {label.name}", layout.layout, 1.0)


def one_of_each(blocks: Sequence[Block]) -> list[Block]:
    """Returns the first block of each layout and training seed, with a single start state."""
    first = {(block.layout, block.training_seed): replace(block, episodes=block.episodes[:1]) for block in blocks[::-1]}
    return list(first.values())


def of_episodes(store: Store, scores: Scores) -> Iterator[Flag]:
    """Yields what is unusual about the episodes of a store: returns above ceilings, and identical training runs."""
    found = recorded(store, sorted(store.blocks()))
    for layout in scores.layouts:
        mine = [one for key, episodes in found.items() if key[0] == layout.layout for one in episodes]
        yield from above_ceilings(mine, layout)
    yield from identical_runs(found)

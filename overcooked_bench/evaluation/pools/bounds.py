"""The bounds of partners: what `stay` or `random` reaches with each, and what the best known responder does.

A responder is chosen by some episodes and measured in others, so that its ceiling owes nothing to luck.

Axes: P partners, N pairs of a responder and a partner, E start states, each played from both seats.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.pools.meeting import play_pairs
from overcooked_bench.evaluation.pools.pairs import Played, points_from
from overcooked_bench.evaluation.pools.players import Player

FLOORS: Final[tuple[Literal["stay", "random"], ...]] = ("stay", "random")


class Plan(NamedTuple):
    """How much is played.

    Attributes:
        tried: Episodes per seat of every responder.
        finalists: How many play on, for each partner and side.
        chosen_by: Episodes per seat of those.
        measured: Fresh episodes per side, an even number.
    """

    tried: int = 2
    finalists: int = 6
    chosen_by: int = 20
    measured: int = 100


PLAN: Final = Plan()


def measure_bounds(
    layout: str,
    partners: Sequence[Player],
    responders: Sequence[Player],
    seed: int = 0,
    workers: int = 1,
    on_progress: Callable[[str, int, int], object] = lambda what, done, of: None,
    plan: Plan = PLAN,
    horizon: int = 400,
    play: Callable[..., Played] = play_pairs,
) -> list[tuple[Bound, ...]]:
    """Measures the floor and the ceiling of each partner, for each side that the other agent can start on.

    The floor is the better of `stay` and `random`. The ceiling is the mean of the best responder: among those given and
    a copy of the partner, all play a few episodes, the best ones more, by which one is chosen for each side. It is then
    measured in fresh episodes.

    Args:
        layout: A shipped layout.
        partners: P players.
        responders: Whose play with each partner is compared; of several with one hash the first one counts.
        seed: Of all streams.
        workers: Processes.
        on_progress: Called with "try", "choose" or "measure", pairs that are done, and all pairs of this stage.
        plan: How much is played.
        horizon: Steps of an episode.
        play: Plays the pairs instead of `play_pairs`, with the same arguments.

    Returns:
        P tuples, one `Bound` per side.

    Raises:
        WrongUse, PoolError: As `meet`.
    """
    known = list({player.sha256: player for player in reversed(responders)}.values())[::-1]
    floors = [Player.scripted(name, layout) for name in FLOORS]
    players = [*known, *floors, *partners]
    places = {player.sha256: i for i, player in enumerate(known)}
    first_floor, first = len(known), len(known) + len(floors)
    own = [places.get(partner.sha256, first + p) for p, partner in enumerate(partners)]

    def stage(what: str, pairs: Iterable[tuple[int, int]], episodes: int) -> _Results:
        listed = sorted(set(pairs), key=lambda pair: pair[::-1])
        played = play(
            layout,
            players,
            listed,
            episodes,
            seed,
            workers,
            horizon,
            lambda done, of: on_progress(what, done, of),
            f"bounds/{what}",
        )
        return _Results({pair: i for i, pair in enumerate(listed)}, *played)

    everybody = [(p, first + p, sorted({*range(len(known)), own[p]})) for p in range(len(partners))]
    tried = stage("try", ((r, partner) for _, partner, able in everybody for r in able), plan.tried)
    sides = np.unique(tried.sides).tolist()
    finals = {
        (p, side): sorted(able, key=lambda r: -tried.of((r, partner), side).mean())[: plan.finalists]
        for p, partner, able in everybody
        for side in sides
    }
    compared = stage("choose", ((r, first + p) for (p, _), best in finals.items() for r in best), plan.chosen_by)
    chosen = {
        (p, side): max(sorted(best), key=lambda r: compared.of((r, first + p), side).mean())
        for (p, side), best in finals.items()
    }
    fresh = stage(
        "measure",
        [
            *((r, first + p) for (p, _), r in chosen.items()),
            *((first_floor + f, first + p) for p in range(len(partners)) for f in range(len(floors))),
        ],
        plan.measured * len(sides) // 2,
    )
    return [
        tuple(
            _bound(
                side,
                [fresh.of((first_floor + f, first + p), side) for f in range(len(floors))],
                fresh.of((chosen[p, side], first + p), side),
                players[chosen[p, side]],
                plan.measured,
            )
            for side in sides
        )
        for p in range(len(partners))
    ]


class _Results(NamedTuple):
    """What pairs reached in one stage.

    Attributes:
        places: Pair -> its index.
        returns: (N, E, 2) points by seat of the responder.
        sides: (N, E, 2) side of the responder.
    """

    places: dict[tuple[int, int], int]
    returns: NDArray[np.float64]
    sides: NDArray[np.int64]

    def of(self, pair: tuple[int, int], side: int) -> NDArray[np.float64]:
        """Returns a pair's points where the responder started on a side, one mean per start state."""
        place = self.places[pair]
        return points_from(self.returns[place], self.sides[place], side)


def _bound(
    side: int, floors: Sequence[NDArray[np.float64]], returns: NDArray[np.float64], responder: Player, episodes: int
) -> Bound:
    means = [float(points.mean()) for points in floors]
    found = t_interval(returns, lowest=0.0)
    low, high = found.interval or (found.value, found.value)
    return Bound(
        side=side,
        floor=round(max(means), 3),
        floor_agent=FLOORS[means.index(max(means))],
        ceiling=round(found.value, 3),
        low=round(low, 3),
        high=round(high, 3),
        episodes=episodes,
        responder=responder.reference,
        responder_sha256=responder.sha256,
    )

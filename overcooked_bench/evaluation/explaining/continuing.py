"""Brings agents to a moment of a recorded episode by replaying it, and plays on from there.

Axes: N kitchens (rows), T steps, W steps from the moment.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.seated import Seated, Views
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.kitchen.tracks.track import Track


class Continued(NamedTuple):
    """What was played from the moments on.

    Attributes:
        states: N states at the moments.
        actions: (W, N, 2) uint8, joint actions from there.
        rewards: (W, N, 2) float64, points of the soups that each chef delivered.
        cells: (W + 1, N, 2) uint16, the cell of each chef before each of these steps, and after the last one.
        facing: (W + 1, N, 2) uint16, their directions then.
        taken: (W, N, 2) uint16, `StepResult.actions_taken`.
    """

    states: list[KitchenState]
    actions: NDArray[np.uint8]
    rewards: NDArray[np.float64]
    cells: NDArray[np.uint16]
    facing: NDArray[np.uint16]
    taken: NDArray[np.uint16]

    @property
    def points(self) -> NDArray[np.float64]:
        """(N,) points of the team within the W steps."""
        points: NDArray[np.float64] = self.rewards.sum(axis=(0, 2))
        return points

    def track(self, row: int) -> Track:
        """Returns what happened in a kitchen from its moment on."""
        return Track(
            self.cells[:, row],
            self.facing[:, row],
            self.actions[:, row],
            self.taken[:, row],
            self.rewards[:, row].sum(axis=0),
        )


def play_on(
    kitchens: Kitchens,
    parties: Sequence[Seated],
    seeds: NDArray[np.uint64],
    recorded: NDArray[np.uint8],
    moments: NDArray[np.int64],
    steps: int,
) -> Continued:
    """Replays recorded episodes up to a moment of each, and lets agents play on from there.

    Agents start their episodes with the recorded ones. Until the moment they are shown what they would have seen on
    their seats, and are asked, but the recorded joint actions are played: whatever an agent keeps of what it sees (the
    memory of a network, a clock, its trust in a partner) is then what it would have if it had lived through this
    episode on this seat. The exception is an agent that relies on its own answers having been carried out.

    Args:
        kitchens: Of `make_kitchens`, in the episodes' start states.
        parties: Together they sit on every seat of every kitchen once.
        seeds: (N, 2) uint64, the random stream of the agent on each seat.
        recorded: (T, N, 2) uint8, the recorded joint actions; those from the moment on are not looked at.
        moments: (N,) int64, steps before the moment.
        steps: W, steps from there; no moment is later than W steps before the horizon.

    Raises:
        SeatedFault: An agent raised, answered with something other than one action per row, or asks for an observation
            that this kitchen does not have.
        UnknownLayout: An agent cannot play this layout.
    """
    n, length = kitchens.num_kitchens, int(moments.max()) + steps
    for party in parties:
        party.reset(kitchens.layout.name, seeds[party.rows, party.seats])
        party.fit(kitchens)
    cells, facing = np.empty((2, length + 1, n, 2), np.uint16)
    taken, actions = np.empty((length, n, 2), np.uint16), np.empty((length, n, 2), np.uint8)
    rewards, joint = np.empty((length, n, 2)), np.empty((n, 2), np.int64)
    states: dict[int, KitchenState] = {}
    views = Views(kitchens)
    for step in range(length):
        states |= {row: kitchens.state(row) for row in np.flatnonzero(moments == step).tolist()}
        cells[step], facing[step] = kitchens.batch.position, kitchens.batch.facing
        views.renew()
        for party in parties:
            joint[party.rows, party.seats] = party.act(views.of(party))
        before = moments > step
        if before.any():
            joint[before] = recorded[step, before]
        result = kitchens.step(joint)
        assert result.actions_taken is not None
        actions[step], rewards[step], taken[step] = joint, result.soup_reward, result.actions_taken
    cells[length], facing[length] = kitchens.batch.position, kitchens.batch.facing
    after, rows = moments + np.arange(steps + 1)[:, None], np.arange(n)
    return Continued(
        states=[states[row] for row in range(n)],
        actions=actions[after[:-1], rows],
        rewards=rewards[after[:-1], rows],
        cells=cells[after, rows],
        facing=facing[after, rows],
        taken=taken[after[:-1], rows],
    )

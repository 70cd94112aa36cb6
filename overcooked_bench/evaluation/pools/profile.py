"""What a frozen policy reaches and does with a copy of itself.

Axes: E episodes.
"""

from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import sample_actions
from overcooked_bench.agents.policies.neural import Mode, PolicyStack
from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.agents.pools.records import Profile, SeatProfile, SelfPlay
from overcooked_bench.agents.seated import Seated
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.kitchen.codes import PICKED_UP, PLATED, POTTED, PUT_DOWN, SERVED
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult

EPISODES: Final = 100
_COUNTED: Final = {
    "pots": POTTED,
    "plates": PLATED,
    "deliveries": SERVED,
    "counter_drops": PUT_DOWN,
    "counter_pickups": PICKED_UP,
}
"""Counts of `SeatProfile` -> the bit of `StepResult.actions_taken`."""
_BITS: Final = np.array(list(_COUNTED.values()), np.uint16)[:, None, None]


class Measured(NamedTuple):
    """What `measure` gives.

    Attributes:
        returns: (E,) float64, the team's points.
        self_play: Their mean with its interval.
        profile: What was done.
    """

    returns: NDArray[np.float64]
    self_play: SelfPlay
    profile: Profile


def measure(
    policy: Policy,
    mode: Mode = "sample",
    episodes: int = EPISODES,
    seed: int = 0,
    start: str = "random",
    horizon: int = 400,
) -> Measured:
    """Plays a policy with itself on its own layout, in its own cooking mode, all episodes in one batch.

    Args:
        policy: Who sits on both seats.
        mode: How it acts.
        episodes: E, two at least.
        seed: Start states and random streams of episode i depend on (seed, i) alone: every policy meets the same ones.
        start: "random" or "standard".
        horizon: Steps of an episode.

    Raises:
        ValueError: Fewer than two episodes, which give no interval.
    """
    if episodes < 2:
        raise ValueError(f"episodes={episodes}; give two at least, one has no interval")
    twins, rows = _Twins(policy, mode), np.arange(episodes)
    party = Seated(twins, "the pair of the same agent", np.tile(rows, 2), np.repeat(np.arange(2), episodes))
    architecture = policy.architecture
    kitchens = make_kitchens(
        architecture.layout,
        episodes,
        [party],
        cooking=architecture.cooking,
        start=start,
        horizon=horizon,
    )
    kitchens.reset(seed=np.array([stream_key("profile", seed, i, "start") for i in range(episodes)], np.uint64))
    streams = [[stream_key("profile", seed, i, seat) for seat in range(2)] for i in range(episodes)]
    deeds = Deeds(episodes)
    with one_thread():
        games = play(kitchens, [party], np.array(streams, np.uint64), watch=deeds.watch)
    counts = deeds.means()
    seats = tuple(
        SeatProfile(
            **_interval(games.soup_reward[:, seat]),
            partial_reward=_rounded(games.partial_reward[:, seat].mean()),
            **{name: _rounded(count[seat]) for name, count in counts.items()},
        )
        for seat in range(2)
    )
    returns = games.soup_reward.sum(axis=1)
    profile = Profile(entropy=_rounded(twins.entropy / horizon), seats=(seats[0], seats[1]))
    return Measured(returns, SelfPlay(**_interval(returns), episodes=episodes), profile)


class _Twins:
    """One policy on any number of seats, which adds up how undecided it was."""

    def __init__(self, policy: Policy, mode: Mode) -> None:
        self._stack, self._mode = PolicyStack([policy]), mode
        self.observation: str = policy.architecture.observation
        self.entropy = 0.0  # nats, mean over rows, summed over steps

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        self._rows, self._seeds, self._step = self._stack.assign(np.zeros(len(seeds), np.int64)), seeds, 0

    def act(self, observations: Any) -> NDArray[np.int64]:
        chances = self._rows.probabilities(observations)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.entropy -= float(np.nan_to_num(chances * np.log(chances)).sum(axis=1, dtype=np.float64).mean())
        step, self._step = self._step, self._step + 1
        if self._mode == "sample":
            return sample_actions(chances, self._seeds, step)
        actions: NDArray[np.int64] = chances.argmax(axis=1)
        return actions


class Deeds:
    """Counts what chefs do; `watch` is called after each step of kitchens that say what was done.

    Args:
        episodes: E.
    """

    def __init__(self, episodes: int) -> None:
        self._counts = np.zeros((len(_COUNTED), episodes, 2), np.int64)

    def watch(self, kitchens: Kitchens, result: StepResult) -> None:
        """Takes a step in."""
        assert result.actions_taken is not None
        self._counts += result.actions_taken & _BITS != 0

    def means(self) -> dict[str, NDArray[np.float64]]:
        """Returns the mean per episode by seat, (2,), under the names of `SeatProfile`."""
        return dict(zip(_COUNTED, self._counts.mean(axis=1), strict=True))


def _interval(values: NDArray[np.float64]) -> dict[str, float]:
    found = t_interval(values)
    assert found.interval
    low, high = found.interval
    return {"mean": _rounded(found.value), "low": _rounded(low), "high": _rounded(high)}


def _rounded(value: float) -> float:
    """Leaves out what nobody reads, and what differs between machines."""
    return round(float(value), 4)

"""Which policy of a training run is its half-trained one; the same for every pool and every learner.

Source: Strouse et al. 2021, fictitious co-play.
"""

from collections.abc import Collection, Mapping
from pathlib import Path

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.evaluation.pools.profile import Measured, measure


class Checkpoints:
    """The policies of one training run; each is measured once, with itself, over the episodes of `measure`.

    Args:
        policies: Share of the training, from 0 (untrained) to 1 (final) -> the policy's file.
        horizon: Steps per episode.
    """

    def __init__(self, policies: Mapping[float, Path], horizon: int) -> None:
        self._policies, self._horizon = policies, horizon
        self._measured: dict[float, Measured] = {}

    def measured(self, share: float) -> Measured:
        """Returns what the policy at a share of the training reaches and does with itself."""
        if share not in self._measured:
            self._measured[share] = measure(load_policy(self._policies[share]), horizon=self._horizon)
        return self._measured[share]

    def half(self, but: Collection[float] = ()) -> float:
        """Returns the share at which the return with itself is nearest to half of the final one.

        The untrained policy is no candidate, nor is the final one; of two equally near, the earlier one is chosen.

        Args:
            but: Shares that are no candidates either.

        Raises:
            ValueError: No candidate.
        """
        candidates = sorted(share for share in self._policies if 0 < share < 1 and share not in but)
        if not candidates:
            raise ValueError("a half-trained policy is one of those saved between the start and the end; save some")
        wanted = self.measured(1.0).self_play.mean / 2
        return min(candidates, key=lambda share: abs(self.measured(share).self_play.mean - wanted))

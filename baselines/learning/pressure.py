"""The diversity bonus: a policy's divergence from a population, as a reward and as a term of the loss.

Source: thesis, 7.2.2 and Tables 7.1 and 7.2. The divergence is D_KL(trained || member), natural logarithm, averaged
over the members, on the same state; it is to be maximised.

Axes: B samples, K members.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
import torch

from overcooked_bench.agents.policies.policy import Architecture, Policy

_CHUNK: Final = 4096
FLOOR: Final = -20.0
"""Least log-probability of a member: one of 0 would make the divergence infinite."""


def kl_divergence(logs: torch.Tensor, others: torch.Tensor) -> torch.Tensor:
    """Computes D_KL(P || Q) of each row, in nats.

    Since the divergence is linear in log Q, the mean over several Q is that of their mean log-probabilities.

    Args:
        logs: (B, A) log-probabilities of P, the policy being trained.
        others: (B, A) log-probabilities of Q, or their mean over several Q.

    Returns:
        (B,).
    """
    return (logs.exp() * (logs - others)).sum(-1)


def clipped(divergence: torch.Tensor, coefficient: float, clip: float) -> torch.Tensor:
    """Weighs a divergence, and bounds the product above; beyond the bound the gradient is 0."""
    return (coefficient * divergence).clamp(max=clip)


def member_logs(members: Sequence[Policy], observations: Callable[[int, int], torch.Tensor], size: int) -> torch.Tensor:
    """Averages the log-probabilities of frozen policies.

    Args:
        members: K policies of one observation, of any architectures.
        observations: Returns the whole observations of the samples from one index up to another, float32.
        size: B.

    Returns:
        (B, 6), each log-probability at least `FLOOR`.
    """
    groups: dict[Architecture, list[Policy]] = defaultdict(list)
    for member in members:
        groups[member.architecture].append(member)
    stacks = [
        (
            architecture,
            {name: torch.from_numpy(np.stack([p.weights[name] for p in group])) for name in group[0].weights},
            len(group),
        )
        for architecture, group in groups.items()
    ]
    parts = []
    with torch.no_grad():
        for begin in range(0, size, _CHUNK):
            shown = observations(begin, min(begin + _CHUNK, size))
            total: Any = 0
            for architecture, weights, count in stacks:
                logits = architecture.forward(weights, shown.unsqueeze(0).expand(count, *shown.shape))
                total = total + torch.log_softmax(logits, -1).clamp(min=FLOOR).sum(0)
            parts.append(total / len(members))
    return torch.cat(parts)


class Pressure:
    """What pushes a learner away from a population.

    Args:
        members: The population's frozen policies.
        spread: Turns compact observations (B, L) into whole ones, float32.
        reward_coefficient: Of the reward.
        reward_clip: The reward of one step at most.
        loss_coefficient: Of the loss term.
        loss_clip: The term of one sample at most.

    Attributes:
        others: (T, R, 6) mean log-probabilities of the members on the last rollout.
    """

    others: torch.Tensor

    def __init__(
        self,
        members: Sequence[Policy],
        spread: Callable[[torch.Tensor], torch.Tensor],
        *,
        reward_coefficient: float = 0.0,
        reward_clip: float = 0.0,
        loss_coefficient: float = 0.0,
        loss_clip: float = 0.0,
    ) -> None:
        self._members, self._spread = members, spread
        self._reward, self._loss = (reward_coefficient, reward_clip), (loss_coefficient, loss_clip)

    def watch(self, seen: torch.Tensor, logs: torch.Tensor) -> np.ndarray[Any, Any]:
        """Takes in a rollout.

        Args:
            seen: (T, R, L) compact observations.
            logs: (T, R, 6) log-probabilities of the policy that played it.

        Returns:
            (T, R) float32, what is added to the rewards.
        """
        flat = seen.flatten(0, 1).cpu()
        others = member_logs(self._members, lambda begin, end: self._spread(flat[begin:end]), len(flat))
        self.others = others.view(*logs.shape)
        rewards: np.ndarray[Any, Any] = clipped(kl_divergence(logs.cpu(), self.others), *self._reward).numpy()
        return rewards

    def bonus(self, logs: torch.Tensor, others: torch.Tensor) -> torch.Tensor:
        """Computes the term that the loss is lowered by: the mean over samples of the clipped divergence.

        Args:
            logs: (M, 6) of the policy as it is now.
            others: (M, 6) from `others`.
        """
        return clipped(kl_divergence(logs, others), *self._loss).mean()

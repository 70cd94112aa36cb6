"""What keeps a learner as likely as its clone on what people did: a term of PPO's loss on their own steps.

The divergence on the learner's own steps alone does not: a learner leaves the states of people, and what it changes
elsewhere changes what it would do there.

Source: Rajeswaran et al. 2018, "Learning complex dexterous manipulation with deep reinforcement learning and
demonstrations" (DAPG: demonstrations go on to be learned from during reinforcement learning).
"""

import torch

from ..learning.networks import TrunkPolicy
from .clone import log_likelihoods
from .examples import Examples


class Lesson:
    """The divergence of the clone from the learner, D_KL(clone || learner), on steps drawn from recorded games.

    Args:
        clone: The policy as it was cloned.
        rows: Steps that it was cloned from.
        coefficient: Weight of the divergence in the loss.
        batch: Steps that are drawn for each minibatch, by torch's generator, which checkpoints keep.
    """

    def __init__(self, clone: TrunkPolicy, rows: Examples, coefficient: float, batch: int) -> None:
        self._seen, self._logs = rows.seen, log_likelihoods(clone, rows)
        self._coefficient, self._batch = coefficient, batch

    def __call__(self, policy: TrunkPolicy) -> torch.Tensor:
        """Computes the term."""
        rows = torch.randint(len(self._seen), (self._batch,))
        wanted = self._logs[rows].to(policy.device)
        logs = policy.judge(self._seen[rows].to(policy.device))[0]
        divergence = (wanted.exp() * (wanted - logs)).sum(1)
        return self._coefficient * divergence.mean()

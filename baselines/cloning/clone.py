"""Behaviour cloning: a network learns to say what a person does next.

Source: Carroll et al. 2019, "On the Utility of Learning about Humans for Human-AI Coordination", section 4 (clones of
the same recorded games). Held-out people decide when to stop, not held-out steps, which their neighbours give away.
"""

from collections.abc import Callable
from dataclasses import dataclass

import torch

from ..learning.networks import TrunkPolicy
from ..learning.settings import PartnerSettings, SettingsError
from .examples import Examples

_CHUNK = 8192  # rows


@dataclass(frozen=True, kw_only=True)
class CloneSettings(PartnerSettings):
    """Settings of cloning, beside those of the network and of PPO."""

    clone_learning_rate: float = 1e-3
    """Adam's learning rate in cloning."""
    clone_weight_decay: float = 0.1
    """Decoupled weight decay in cloning."""
    clone_batch: int = 256
    """Steps of one chef in a minibatch of cloning."""
    clone_epochs: int = 60
    """Passes over the games at most."""
    clone_patience: int = 10
    """Passes without a better likelihood of the held-out pairs after which cloning stops."""

    def __post_init__(self) -> None:
        """Checks the cloning too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        for name in ("clone_batch", "clone_epochs", "clone_patience"):
            if getattr(self, name) < 1:
                raise SettingsError(f"{name}={getattr(self, name)}; give a number from 1")
        if self.clone_learning_rate <= 0:
            raise SettingsError(f"clone_learning_rate={self.clone_learning_rate}; give a number above 0")
        if self.clone_weight_decay < 0:
            raise SettingsError(f"clone_weight_decay={self.clone_weight_decay}; give a number from 0")


@dataclass(frozen=True)
class Fitted:
    """How cloning went.

    Attributes:
        epochs: Passes over the examples up to the weights that were kept.
        nats: Mean negative log-likelihood per step of the held-out pairs, under these weights.
    """

    epochs: int
    nats: float


def log_likelihoods(policy: TrunkPolicy, examples: Examples) -> torch.Tensor:
    """Returns the (N, 6) log-probabilities of all actions, in main memory."""
    with torch.no_grad():
        return torch.cat([policy.judge(seen.to(policy.device))[0].cpu() for seen in torch.split(examples.seen, _CHUNK)])


def nats_per_step(logs: torch.Tensor, examples: Examples) -> float:
    """Returns the mean negative log-likelihood of what was done, each pair of people weighing the same.

    Args:
        logs: (N, 6) log-probabilities.
        examples: N rows.
    """
    said = -logs.gather(1, examples.actions.unsqueeze(1)).squeeze(1).double().numpy()
    return float(sum(said[examples.pairs == name].mean() for name in examples.people) / len(examples.people))


def fit(
    policy: TrunkPolicy,
    drawn: Examples,
    held_out: Examples,
    settings: CloneSettings,
    seed: int,
    on_epoch: Callable[[int, float], object] = lambda epoch, nats: None,
) -> Fitted:
    """Trains a policy until it foretells held-out people no better; the critic learns the returns beside it.

    The critic reads what the trunk makes for the actor, and leaves the trunk as it is.

    Args:
        policy: Fresh; in the end it has the best weights.
        drawn: What to learn from.
        held_out: Of other people.
        settings: How; the optimizer is Adam with decoupled weight decay (Loshchilov and Hutter 2019).
        seed: Of the order of the rows.
        on_epoch: Called after each pass with its number and the `nats` of the held-out pairs.
    """
    order = torch.Generator().manual_seed(seed)
    optimizer = torch.optim.AdamW(
        policy.parameters(), settings.clone_learning_rate, weight_decay=settings.clone_weight_decay, eps=1e-5
    )
    best, kept = Fitted(0, nats_per_step(log_likelihoods(policy, held_out), held_out)), _weights(policy)
    for epoch in range(1, settings.clone_epochs + 1):
        for rows in torch.split(torch.randperm(len(drawn), generator=order), settings.clone_batch):
            seen, actions, returns = (
                part[rows].to(policy.device) for part in (drawn.seen, drawn.actions, drawn.returns)
            )
            logs, values = _judge(policy, seen)
            loss = torch.nn.functional.nll_loss(logs, actions)
            loss = loss + torch.nn.functional.mse_loss(values, returns) / 1000  # points squared
            optimizer.zero_grad()
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
        nats = nats_per_step(log_likelihoods(policy, held_out), held_out)
        on_epoch(epoch, nats)
        if nats < best.nats:
            best, kept = Fitted(epoch, nats), _weights(policy)
        if epoch - best.epochs >= settings.clone_patience:
            break
    policy.load_state_dict(kept)
    return best


def _judge(policy: TrunkPolicy, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    x = policy.features_extractor.features(seen)
    return torch.log_softmax(policy.action_net(x), 1), policy.value_net(x.detach()).squeeze(1)


def _weights(policy: TrunkPolicy) -> dict[str, torch.Tensor]:
    return {name: tensor.detach().clone() for name, tensor in policy.state_dict().items()}

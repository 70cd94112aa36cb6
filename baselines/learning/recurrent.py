"""RecurrentPPO of sb3-contrib over our trunk: an actor with one LSTM layer, and a critic without one.

sb3-contrib is an extra, so this module is only imported where it trains.
"""

from collections.abc import Mapping
from typing import Any

import torch
from sb3_contrib import RecurrentPPO
from sb3_contrib.common.recurrent.policies import RecurrentActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.type_aliases import PyTorchObs

from overcooked_bench.agents.policies.architecture import Architecture
from overcooked_bench.agents.policies.lstm import Lstm
from overcooked_bench.envs.sb3 import OvercookedVecEnv

from .arguments import ppo_arguments
from .networks import MlpTrunk, named, policy_kwargs
from .settings import Settings


class RecurrentTrunkPolicy(RecurrentActorCriticPolicy):
    """sb3-contrib's policy over an `MlpTrunk`, without SB3's preprocessing of observations."""

    features_extractor: MlpTrunk

    def extract_features(
        self, obs: PyTorchObs, features_extractor: BaseFeaturesExtractor | None = None
    ) -> torch.Tensor:
        """Returns the trunk's values for whole uint8 observations."""
        assert isinstance(obs, torch.Tensor)
        return self.features_extractor(obs)  # type: ignore[no-any-return]

    def frozen(self, told: Mapping[str, Any]) -> tuple[Architecture, dict[str, torch.Tensor]]:
        """Returns the actor as a `Lstm`; see `freeze.Freezable`."""
        trunk, lstm = self.features_extractor, self.lstm_actor
        tensors = dict(lstm.named_parameters())
        head = [part for part in self.mlp_extractor.policy_net if isinstance(part, torch.nn.Linear)]
        architecture = Lstm(
            **told,
            trunk=trunk.widths,
            units=lstm.hidden_size,
            head=tuple(part.out_features for part in head),
        )
        weights = {
            **trunk.weights(),
            "lstm.input.weight": tensors["weight_ih_l0"],
            "lstm.memory.weight": tensors["weight_hh_l0"],
            "lstm.bias": tensors["bias_ih_l0"] + tensors["bias_hh_l0"],
            **named("head", head),
            **named("action", [self.action_net], numbered=False),
        }
        return architecture, {name: tensor.detach().cpu().clone() for name, tensor in weights.items()}


def make_recurrent(
    settings: Settings, env: OvercookedVecEnv, seed: int, units: int, head: tuple[int, ...]
) -> RecurrentPPO:
    """Makes RecurrentPPO's learner, untrained.

    Args:
        settings: The run's.
        env: Its kitchens.
        seed: Seed of the learner's random numbers.
        units: Units of the actor's LSTM. The critic has none: it sees the whole kitchen.
        head: Widths of the layers after the LSTM, and of as many layers of the critic.
    """
    torch.set_num_threads(settings.threads)
    return RecurrentPPO(
        RecurrentTrunkPolicy,
        env,
        **ppo_arguments(settings, seed),
        policy_kwargs={
            **policy_kwargs(settings),
            "net_arch": list(head),
            "lstm_hidden_size": units,
            "enable_critic_lstm": False,
        },
    )

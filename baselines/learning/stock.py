"""PPO of stable-baselines3 as it comes, with its own loops, policy class and preprocessing, on the kitchens.

No loop and no layer is shared with `learner.py` and `networks.py`: actor and critic of the fully connected network have
layers of their own (SB3's `MlpPolicy`), and all inputs are multiplied, those that never change too.
"""

from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor

from overcooked_bench.agents.policies.architectures import CONVOLUTIONS
from overcooked_bench.envs.sb3 import OvercookedVecEnv

from .arguments import ppo_arguments
from .settings import Settings


class Convolutions(BaseFeaturesExtractor):
    """The network of Carroll et al. 2019: three convolutions, then dense layers, all shared by actor and critic.

    Args:
        observation_space: One grid, (planes, H, W).
        filters: Filters of each convolution.
        hidden: Widths of the dense layers.
    """

    def __init__(self, observation_space: spaces.Box, filters: int, hidden: tuple[int, ...]) -> None:
        super().__init__(observation_space, hidden[-1])
        layers: list[torch.nn.Module] = []
        planes, height, width = observation_space.shape
        for size, padding in CONVOLUTIONS:
            layers += [torch.nn.Conv2d(planes, filters, size, padding=padding), torch.nn.LeakyReLU()]
            planes, height, width = filters, height + 2 * padding - size + 1, width + 2 * padding - size + 1
        layers.append(torch.nn.Flatten())
        entering = planes * height * width
        for leaving in hidden:
            layers += [torch.nn.Linear(entering, leaving), torch.nn.LeakyReLU()]
            entering = leaving
        self.layers = torch.nn.Sequential(*layers)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Returns the features, (B, width of the last layer), of (B, planes, H, W) float32."""
        return self.layers(observations.contiguous(memory_format=torch.channels_last))  # type: ignore[no-any-return]


def make_stock_ppo(settings: Settings, env: OvercookedVecEnv, seed: int) -> PPO:
    """Makes SB3's learner, untrained."""
    torch.set_num_threads(settings.threads)
    model = PPO(
        "MlpPolicy",
        env,
        **ppo_arguments(settings, seed),
        policy_kwargs=_policy_kwargs(settings),
    )
    model.policy.to(memory_format=torch.channels_last)  # convolutions take a third less time
    return model


def _policy_kwargs(settings: Settings) -> dict[str, Any]:
    if settings.network == "mlp":
        return {"net_arch": {"pi": list(settings.hidden), "vf": list(settings.hidden)}}
    return {
        "features_extractor_class": Convolutions,
        "features_extractor_kwargs": {"filters": settings.filters, "hidden": settings.hidden},
        "net_arch": [],
    }


def stock_weights(policy: ActorCriticPolicy) -> dict[str, torch.Tensor]:
    """Returns the actor's tensors under the names of the frozen architectures `mlp` (of tanh) and `cnn`."""
    extractor, actor = policy.features_extractor, policy.mlp_extractor.policy_net
    modules = [*(extractor.layers if isinstance(extractor, Convolutions) else ()), *actor]
    named = {
        **{f"conv.{i}": layer for i, layer in enumerate(m for m in modules if isinstance(m, torch.nn.Conv2d))},
        **{f"trunk.{i}": layer for i, layer in enumerate(m for m in modules if isinstance(m, torch.nn.Linear))},
        "action": policy.action_net,
    }
    return {
        f"{name}.{part}": tensor.detach().cpu().clone()
        for name, layer in named.items()
        for part, tensor in layer.named_parameters()
    }

"""One trunk for actor and critic: the features extractor of the baselines, and its way to a frozen policy."""

from itertools import pairwise
from math import prod
from typing import Any

import numpy as np
import torch
from gymnasium import spaces
from numpy.typing import NDArray
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.type_aliases import PyTorchObs

from overcooked_bench.agents.policy import Mlp


class Trunk(BaseFeaturesExtractor):
    """Fully connected layers over the flattened observation, shared by actor and critic.

    SB3's own `net_arch` gives actor and critic separate layers, at twice the cost.

    Args:
        observation_space: What the policy sees.
        live: Indices of the inputs that can change; only they are read.
        hidden: Width of each layer.
    """

    live: torch.Tensor

    def __init__(self, observation_space: spaces.Box, live: NDArray[np.int64], hidden: tuple[int, ...]) -> None:
        super().__init__(observation_space, hidden[-1])
        self.register_buffer("live", torch.from_numpy(live))
        self.layers = torch.nn.ModuleList([torch.nn.Linear(a, b) for a, b in pairwise((len(live), *hidden))])

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Gives the last layer's values, (B, hidden[-1])."""
        x = observations.flatten(1).index_select(1, self.live).float()  # (B, live)
        for layer in self.layers:
            x = torch.relu(layer(x))  # (B, width)
        return x

    def linears(self) -> list[torch.nn.Linear]:
        """Lists the layers; the first one reads the live inputs."""
        return [layer for layer in self.layers if isinstance(layer, torch.nn.Linear)]


class TrunkPolicy(ActorCriticPolicy):
    """SB3's policy without its preprocessing: the trunk itself turns the few live inputs into floats."""

    def extract_features(
        self, obs: PyTorchObs, features_extractor: BaseFeaturesExtractor | None = None
    ) -> torch.Tensor:
        """Gives the trunk's values for uint8 observations."""
        return self.features_extractor(obs)  # type: ignore[no-any-return]


def policy_kwargs(live: NDArray[np.int64], hidden: tuple[int, ...]) -> dict[str, Any]:
    """Gives SB3's `policy_kwargs` for a `TrunkPolicy`."""
    return {
        "features_extractor_class": Trunk,
        "features_extractor_kwargs": {"live": live, "hidden": hidden},
        "net_arch": [],
        "optimizer_kwargs": {"eps": 1e-5},
    }


def frozen_actor(
    policy: ActorCriticPolicy, observation: str, layout: str, cooking: str, hidden: tuple[int, ...]
) -> tuple[Mlp, dict[str, torch.Tensor]]:
    """Gives the architecture and the actor's weights of a policy with a trunk, as `save_policy` takes them.

    The first layer is spread over the whole observation again, with zeros where the trunk does not look.
    """
    trunk = policy.features_extractor
    assert isinstance(trunk, Trunk)
    head = policy.action_net
    assert isinstance(head, torch.nn.Linear)
    named = {**{f"trunk.{i}": layer for i, layer in enumerate(trunk.linears())}, "action": head}
    weights: dict[str, torch.Tensor] = {}
    for name, layer in named.items():
        weights[f"{name}.weight"], weights[f"{name}.bias"] = layer.weight.detach().clone(), layer.bias.detach().clone()
    narrow = weights["trunk.0.weight"]  # (hidden[0], live)
    weights["trunk.0.weight"] = narrow.new_zeros(len(narrow), prod(policy.observation_space.shape or ()))
    weights["trunk.0.weight"][:, trunk.live] = narrow
    architecture = Mlp(
        observation=observation,  # type: ignore[arg-type]
        observation_shape=policy.observation_space.shape or (),
        layout=layout,
        cooking=cooking,  # type: ignore[arg-type]
        hidden=hidden,
        activation="relu",
    )
    return architecture, weights

"""The networks that are trained: one trunk for actor and critic, fed with the inputs that can change alone.

Axes: B samples, L live inputs, I inputs of a whole observation.
"""

from itertools import pairwise
from typing import Any

import torch
from gymnasium import spaces
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.type_aliases import PyTorchObs

from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation

from .inputs import fixed_inputs
from .settings import Settings


class Trunk(BaseFeaturesExtractor):
    """What actor and critic share; SB3's own `net_arch` gives each its own layers, at twice the cost.

    Args:
        observation_space: What the policy sees.
        settings: The run's.
        width: Of the features.
    """

    live: torch.Tensor

    def __init__(self, observation_space: spaces.Box, settings: Settings, width: int) -> None:
        super().__init__(observation_space, width)
        live = find_observation(settings.observation).live(Layout.load(settings.layout)).places
        self.register_buffer("live", torch.from_numpy(live), persistent=False)

    def compact(self, observations: torch.Tensor) -> torch.Tensor:
        """Picks the live inputs, (B, L), out of whole observations."""
        return observations.flatten(1).index_select(1, self.live)

    def forward(self, observations: torch.Tensor) -> torch.Tensor:
        """Returns the features, (B, width), of whole observations."""
        return self.features(self.compact(observations))

    def features(self, seen: torch.Tensor) -> torch.Tensor:
        """Returns the features, (B, width), of compact observations (B, L)."""
        raise NotImplementedError

    def weights(self) -> dict[str, torch.Tensor]:
        """Returns the tensors under the names that the frozen architecture has for them."""
        raise NotImplementedError


class MlpTrunk(Trunk):
    """Fully connected layers over the live inputs."""

    def __init__(self, observation_space: spaces.Box, settings: Settings) -> None:
        super().__init__(observation_space, settings, settings.hidden[-1])
        self.widths = settings.hidden
        self.layers = _dense((len(self.live), *settings.hidden))

    def features(self, seen: torch.Tensor) -> torch.Tensor:
        """Returns the last layer's values; see `Trunk.features`."""
        x = seen.float()
        for layer in self.layers:
            x = torch.relu(layer(x))
        return x

    def weights(self) -> dict[str, torch.Tensor]:
        """The first layer is spread over the whole observation again, with zeros where the trunk does not look."""
        weights = named("trunk", self.layers)
        narrow = weights["trunk.0.weight"]  # (width, L)
        whole = narrow.new_zeros(len(narrow), self._observation_space_size())
        whole[:, self.live] = narrow
        return weights | {"trunk.0.weight": whole}

    def _observation_space_size(self) -> int:
        return spaces.flatdim(self._observation_space)


class CnnTrunk(Trunk):
    """Three convolutions, the last one without padding, then fully connected layers (Carroll et al. 2019, appendix A).

    The first convolution is computed as one matrix product from the live inputs, with a matrix put together out of the
    kernel, plus the convolution of the inputs that never change, once for a whole batch: the same numbers at a
    fraction of the multiplications. A value that many cells show, such as urgency, has the convolution of these cells
    as its row of the matrix.

    Where past states are stacked (`stack_states`), all states share the convolutions, and the older ones then pass one
    small layer that the current one does not (thesis, 7.4).
    """

    taps: torch.Tensor
    everywhere: torch.Tensor
    images: torch.Tensor

    def __init__(self, observation_space: spaces.Box, settings: Settings) -> None:
        super().__init__(observation_space, settings, settings.hidden[-1])
        *states, planes, height, width = observation_space.shape or ()
        self._states = states[0] if states else 1
        self._image = planes, height, width
        layout = Layout.load(settings.layout)
        one = planes * height * width  # inputs of one state: all states have the same live ones
        sources = torch.from_numpy(find_observation(settings.observation).live(layout).shown[:one])
        everywhere = torch.nonzero(sources[sources >= 0].bincount() > 1).flatten()
        fixed = torch.from_numpy(fixed_inputs(layout, settings.observation)[:one])
        images = [fixed, *((sources == i).float() for i in everywhere)]
        self.register_buffer("taps", _taps(sources, self._image), persistent=False)
        self.register_buffer("everywhere", everywhere, persistent=False)
        self.register_buffer("images", torch.stack(images).view(-1, *self._image), persistent=False)
        filters = settings.filters
        self.first = torch.nn.Conv2d(planes, filters, 5, padding=2)
        self.second = torch.nn.Conv2d(filters, filters, 3, padding=1)
        self.third = torch.nn.Conv2d(filters, filters, 3)
        flat = filters * (height - 2) * (width - 2)
        self.previous = torch.nn.Linear(flat, settings.previous) if states else None
        joined = flat + (self._states - 1) * settings.previous
        self.layers = _dense((joined, *settings.hidden))

    def features(self, seen: torch.Tensor) -> torch.Tensor:
        """Returns the last layer's values; see `Trunk.features`."""
        x = self._convolve(seen.reshape(len(seen) * self._states, -1)).view(len(seen), self._states, -1)
        if self.previous is None:
            x = x[:, 0]
        else:
            older = torch.nn.functional.leaky_relu(self.previous(x[:, 1:]))
            x = torch.cat((x[:, 0], older.flatten(1)), 1)
        for layer in self.layers:
            x = torch.nn.functional.leaky_relu(layer(x))
        return x

    def weights(self) -> dict[str, torch.Tensor]:
        """Returns `conv.*`, `previous.*` and `trunk.*`."""
        previous = {} if self.previous is None else named("previous", [self.previous], numbered=False)
        return {**named("conv", (self.first, self.second, self.third)), **previous, **named("trunk", self.layers)}

    def _convolve(self, seen: torch.Tensor) -> torch.Tensor:
        """Returns the flattened output of the convolutions, (B, F H' W'), of single states (B, L)."""
        first = self.first
        assert first.bias is not None
        _, height, width = self._image
        kernel = torch.nn.functional.pad(first.weight.flatten(1), (0, 1)).t().contiguous()  # (C 25 + 1, F), 0s at last
        matrix = kernel.index_select(0, self.taps.flatten()).view(len(self.taps), -1)  # (L, H W F)
        shown = torch.nn.functional.conv2d(self.images, first.weight, padding=2).permute(0, 2, 3, 1)
        still = (shown[0] + first.bias).flatten()
        matrix.index_add_(0, self.everywhere, shown[1:].flatten(1))
        x = torch.nn.functional.leaky_relu_(torch.addmm(still, seen.float(), matrix))
        x = x.view(len(seen), height, width, -1).permute(0, 3, 1, 2)  # (B, F, H, W), channels last in memory
        x = torch.nn.functional.leaky_relu_(self.second(x))
        return torch.nn.functional.leaky_relu_(self.third(x).flatten(1))


class TrunkPolicy(ActorCriticPolicy):
    """SB3's policy over a `Trunk`, without SB3's preprocessing of observations."""

    features_extractor: Trunk

    def extract_features(
        self, obs: PyTorchObs, features_extractor: BaseFeaturesExtractor | None = None
    ) -> torch.Tensor:
        """Returns the trunk's values for whole uint8 observations."""
        assert isinstance(obs, torch.Tensor)
        return self.features_extractor(obs)  # type: ignore[no-any-return]

    def compact(self, observations: torch.Tensor) -> torch.Tensor:
        """Returns what `judge` reads, (B, L)."""
        return self.features_extractor.compact(observations)

    def judge(self, seen: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Returns the log-probabilities of all actions, (B, 6), and the values, (B,), of compact observations."""
        x = self.features_extractor.features(seen)
        return torch.log_softmax(self.action_net(x), 1), self.value_net(x).squeeze(1)

    def actor_weights(self) -> dict[str, torch.Tensor]:
        """Returns the actor's tensors under the names of its frozen architecture."""
        assert isinstance(self.action_net, torch.nn.Linear)
        assert self.action_net.out_features == NUM_ACTIONS
        weights = self.features_extractor.weights() | named("action", [self.action_net], numbered=False)
        return {name: tensor.detach().cpu().clone() for name, tensor in weights.items()}


TRUNKS: dict[str, type[Trunk]] = {"mlp": MlpTrunk, "cnn": CnnTrunk}
"""The value of `network` -> what computes it."""


def policy_kwargs(settings: Settings) -> dict[str, Any]:
    """Returns SB3's `policy_kwargs` for a `TrunkPolicy`."""
    return {
        "features_extractor_class": TRUNKS[settings.network],
        "features_extractor_kwargs": {"settings": settings},
        "net_arch": [],
        "optimizer_kwargs": {"eps": 1e-5, "fused": True},
    }


def _dense(widths: tuple[int, ...]) -> torch.nn.ModuleList:
    return torch.nn.ModuleList([torch.nn.Linear(a, b) for a, b in pairwise(widths)])


def named(name: str, layers: Any, numbered: bool = True) -> dict[str, torch.Tensor]:
    """Returns the tensors of layers as `<name>.<i>.weight` and `.bias`, or without the number."""
    return {
        f"{name}{f'.{i}' if numbered else ''}.{part}": getattr(layer, part)
        for i, layer in enumerate(layers)
        for part in ("weight", "bias")
    }


def _taps(sources: torch.Tensor, image: tuple[int, int, int]) -> torch.Tensor:
    """Says which entry of a 5x5 kernel leads from each live input to each output cell.

    Args:
        sources: (C H W,) position of each input among the L live ones, -1 where it never changes.
        image: C, H, W.

    Returns:
        (L, H W) indices into a kernel flattened to (C 25), C 25 where none does, and for values shown in several cells.
    """
    planes, height, width = image
    taps = torch.full((int(sources.max()) + 1, height * width), planes * 25)
    for i in range(len(taps)):
        cells = torch.nonzero(sources == i).flatten().tolist()
        if len(cells) > 1:
            continue
        plane, y, x = cells[0] // (height * width), cells[0] // width % height, cells[0] % width
        for out in range(height * width):
            dy, dx = y - out // width + 2, x - out % width + 2
            if 0 <= dy < 5 and 0 <= dx < 5:
                taps[i, out] = plane * 25 + dy * 5 + dx
    return taps

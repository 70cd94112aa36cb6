"""The networks of frozen policies by name, and those without memory.

Axes: K policies, R rows of each policy.
"""

from collections.abc import Mapping
from math import prod
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.policies.architecture import (
    Architecture,
    action_shapes,
    check_widths,
    dense_shapes,
    layer,
    narrowed_layer,
)
from overcooked_bench.agents.policies.lstm import Lstm
from overcooked_bench.agents.policies.nature import NatureCnn

if TYPE_CHECKING:
    import torch

CONVOLUTIONS: Final = ((5, 2), (3, 1), (3, 0))
"""Kernel size and padding of the convolutions of `Cnn`."""


class Mlp(Architecture, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="mlp"):
    """Fully connected layers over the flattened observation.

    Attributes:
        hidden: Width of each hidden layer.
        activation: Activation function after each hidden layer.
    """

    hidden: tuple[int, ...] = (128, 128)
    activation: Literal["relu", "tanh"] = "tanh"

    def __post_init__(self) -> None:
        """Checks the hidden layers too.

        Raises:
            ValueError: Names the field.
        """
        Architecture.__post_init__(self)
        check_widths("hidden", self.hidden)

    def tensor_shapes(self) -> dict[str, tuple[int, ...]]:
        """Returns `trunk.<i>.weight` (out, in) and `trunk.<i>.bias` (out,) of each layer, then `action.*`."""
        return _trunk_shapes(prod(self.observation_shape), self.hidden)

    def forward(self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor") -> "torch.Tensor":
        """Computes K policies at once; see `Architecture.forward`."""
        import torch

        activation = torch.relu if self.activation == "relu" else torch.tanh
        values = inputs.flatten(2)
        for i in range(len(self.hidden)):
            values = activation(layer(weights, f"trunk.{i}", values))
        return layer(weights, "action", values)

    def narrowed(
        self, weights: Mapping[str, NDArray[np.float32]]
    ) -> tuple[Mapping[str, NDArray[np.float32]], NDArray[np.int64] | None]:
        """Drops the inputs that the first layers of all policies multiply by 0, such as those that never change."""
        return narrowed_layer(weights, "trunk.0.weight")


class Cnn(Architecture, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="cnn"):
    """Three convolutions over the grid, then fully connected layers; leaky ReLU of slope 0.01, torch's own, after each.

    If past states are stacked (`stack_states`), all states pass through the same convolutions. The older ones then pass
    through one small layer that they share, and the current state does not; the current state's values and those of
    the older ones, newest first, are concatenated.

    Source: Carroll et al. 2019, appendix A (convolutions 5x5, 3x3 and 3x3, the last without padding); thesis, 7.4
    (the small layer). Neither gives the slope or the small layer's width.

    Attributes:
        filters: Filters of each convolution.
        hidden: Width of each fully connected layer.
        previous: Width of the small layer, 16 in the baselines; 0 if no past states are stacked.
    """

    filters: int = 25
    hidden: tuple[int, ...] = (64, 64, 64)
    previous: int = 0

    def __post_init__(self) -> None:
        """Checks the layers too.

        Raises:
            ValueError: Names the field.
        """
        Architecture.__post_init__(self)
        check_widths("hidden", self.hidden)
        shape, stacked = self.observation_shape, len(self.observation_shape) == 4
        if len(shape) not in (3, 4) or min(shape[-2:]) < 3:
            raise ValueError(
                f"observation_shape is {list(shape)}; convolutions need a grid of at least 3x3: "
                "[channels, height, width], or [states, channels, height, width]"
            )
        if self.filters < 1:
            raise ValueError(f"filters is {self.filters}; give a number from 1")
        if (self.previous >= 1) != stacked or self.previous < 0:
            raise ValueError(
                f"previous is {self.previous} with {self.observation!r}; "
                "give a width from 1, such as 16, where past states are stacked, and 0 with others"
            )

    def tensor_shapes(self) -> dict[str, tuple[int, ...]]:
        """Returns `conv.<i>.weight` (out, in, k, k) and `.bias`, `previous.*` if any, `trunk.<i>.*` and `action.*`."""
        *states, channels, height, width = self.observation_shape
        shapes: dict[str, tuple[int, ...]] = {}
        for i, (size, padding) in enumerate(CONVOLUTIONS):
            shapes[f"conv.{i}.weight"] = (self.filters, self.filters if i else channels, size, size)
            shapes[f"conv.{i}.bias"] = (self.filters,)
            height, width = height + 2 * padding - size + 1, width + 2 * padding - size + 1
        joined = flat = self.filters * height * width
        if states:
            shapes |= {"previous.weight": (self.previous, flat), "previous.bias": (self.previous,)}
            joined = flat + (states[0] - 1) * self.previous
        return shapes | _trunk_shapes(joined, self.hidden)

    def forward(self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor") -> "torch.Tensor":
        """Computes K policies at once; see `Architecture.forward`.

        Convolves policy by policy: a grouped convolution is slower here with more than a few rows.
        """
        import torch
        from torch.nn.functional import leaky_relu

        policies, rows = inputs.shape[:2]
        values = torch.stack(
            [self._convolve({name: w[k] for name, w in weights.items()}, inputs[k]) for k in range(policies)]
        )
        if self.previous:
            states = values.view(policies, rows, self.observation_shape[0], -1)
            older = leaky_relu(layer(weights, "previous", states[:, :, 1:].flatten(1, 2)))
            values = torch.cat((states[:, :, 0], older.view(policies, rows, -1)), 2)
        for i in range(len(self.hidden)):
            values = leaky_relu(layer(weights, f"trunk.{i}", values))
        return layer(weights, "action", values)

    def _convolve(self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor") -> "torch.Tensor":
        """Returns one policy's flattened images: (R, *observation_shape) -> (R S, F H' W') with S states per row."""
        from torch.nn.functional import conv2d, leaky_relu

        images = inputs.reshape(-1, *self.observation_shape[-3:])
        for i, (_, padding) in enumerate(CONVOLUTIONS):
            images = leaky_relu(conv2d(images, weights[f"conv.{i}.weight"], weights[f"conv.{i}.bias"], padding=padding))
        return images.flatten(1)


ARCHITECTURES: Final[dict[str, type[Architecture]]] = {
    "mlp": Mlp,
    "cnn": Cnn,
    "lstm": Lstm,
    "nature_cnn": NatureCnn,
}
"""The value of `architecture` in the JSON file -> its class."""


def _trunk_shapes(inputs: int, hidden: tuple[int, ...]) -> dict[str, tuple[int, ...]]:
    return dense_shapes("trunk", inputs, hidden) | action_shapes(hidden[-1])

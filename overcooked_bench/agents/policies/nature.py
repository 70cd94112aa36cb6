"""The convolutional network of stable-baselines3's `CnnPolicy`.

Axes: K policies, R rows of each policy.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, Literal

from overcooked_bench.agents.policies.architecture import (
    Architecture,
    action_shapes,
    check_widths,
    dense_shapes,
    layer,
)

if TYPE_CHECKING:
    import torch

NATURE_CONVOLUTIONS: Final = ((32, 8, 4), (64, 4, 2), (64, 3, 1))
"""Filters, kernel size and stride of each convolution; none is padded."""

SMALLEST: Final = 36
"""Least height and width of the grid."""


class NatureCnn(Architecture, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="nature_cnn"):
    """Three convolutions with strides and a fully connected layer, ReLU after each, then `hidden` layers.

    It needs grids of at least 36x36 cells, which no shipped layout has.

    Source: Mnih et al. 2015 (the convolutions); stable-baselines3, `NatureCNN`.

    Attributes:
        features: Width of the layer after the convolutions.
        hidden: Width of each further layer; none by default.
        activation: Activation function after each of them.
    """

    features: int = 512
    hidden: tuple[int, ...] = ()
    activation: Literal["relu", "tanh"] = "tanh"

    def __post_init__(self) -> None:
        """Checks the layers too.

        Raises:
            ValueError: Names the field.
        """
        Architecture.__post_init__(self)
        check_widths("features", (self.features,))
        check_widths("hidden", self.hidden, least=0)
        shape = self.observation_shape
        if len(shape) != 3 or min(shape[1:]) < SMALLEST:
            raise ValueError(
                f"observation_shape is {list(shape)}; these convolutions need [channels, height, width] with at least "
                f"{SMALLEST} rows and columns"
            )

    def tensor_shapes(self) -> dict[str, tuple[int, ...]]:
        """Returns `conv.<i>.weight` (out, in, k, k) and `.bias`, `features.*`, `trunk.<i>.*` and `action.*`."""
        channels, height, width = self.observation_shape
        shapes: dict[str, tuple[int, ...]] = {}
        for i, (filters, size, stride) in enumerate(NATURE_CONVOLUTIONS):
            shapes |= {f"conv.{i}.weight": (filters, channels, size, size), f"conv.{i}.bias": (filters,)}
            channels, height, width = filters, (height - size) // stride + 1, (width - size) // stride + 1
        return {
            **shapes,
            "features.weight": (self.features, channels * height * width),
            "features.bias": (self.features,),
            **dense_shapes("trunk", self.features, self.hidden),
            **action_shapes((self.features, *self.hidden)[-1]),
        }

    def forward(self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor") -> "torch.Tensor":
        """Computes K policies at once; see `Architecture.forward`."""
        import torch
        from torch.nn.functional import conv2d

        images = []
        for k, values in enumerate(inputs):
            for i, (_, _, stride) in enumerate(NATURE_CONVOLUTIONS):
                convolved = conv2d(values, weights[f"conv.{i}.weight"][k], weights[f"conv.{i}.bias"][k], stride=stride)
                values = torch.relu(convolved)
            images.append(values.flatten(1))
        activation = torch.relu if self.activation == "relu" else torch.tanh
        values = torch.relu(layer(weights, "features", torch.stack(images)))
        for i in range(len(self.hidden)):
            values = activation(layer(weights, f"trunk.{i}", values))
        return layer(weights, "action", values)

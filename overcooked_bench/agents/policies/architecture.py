"""What all frozen networks have in common: each is described by one JSON object and computes K policies at once.

Inputs are the unscaled numbers of `Kitchens.observe`: nearly all channels hold zeros and ones, and the few that count
(contents of pots, remaining cook time) are as small as in the reference encoding.

Axes: K policies, R rows of each policy, M numbers that a row remembers.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Final, Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import NUM_ACTIONS

if TYPE_CHECKING:
    import torch

FORMAT: Final = 1


class Architecture(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="architecture"):
    """Describes a policy; subclasses add their network.

    Attributes:
        observation: The policy's observation, a name of `kitchen.observations.registry.OBSERVATIONS`.
        observation_shape: Shape of one such observation, channels first.
        layout: The layout it was trained on, as `reset` names it.
        cooking: The cooking mode it was trained under.
        format: Version of this file format.
    """

    observation: str
    observation_shape: tuple[int, ...]
    layout: str
    cooking: Literal["auto", "manual"]
    format: int = FORMAT

    def __post_init__(self) -> None:
        """Checks the values.

        Raises:
            ValueError: Names the field.
        """
        if self.format != FORMAT:
            raise ValueError(f"format is {self.format}; this version reads format {FORMAT}")
        if not self.observation_shape or min(self.observation_shape) < 1:
            raise ValueError(f"observation_shape is {list(self.observation_shape)}; give numbers from 1")

    @property
    def remembered(self) -> int:
        """Numbers that a row keeps from one step of an episode to the next, M; 0 where only the observation counts."""
        return 0

    def tensor_shapes(self) -> dict[str, tuple[int, ...]]:
        """Returns the shape of every tensor of the weights file."""
        raise NotImplementedError

    def forward(self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor") -> "torch.Tensor":
        """Computes K policies without memory at once.

        Args:
            weights: By name, (K, *shape) float32.
            inputs: (K, R, *observation_shape) float32, unscaled.

        Returns:
            (K, R, 6) float32, logits.
        """
        raise NotImplementedError

    def advance(
        self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor", memory: "torch.Tensor"
    ) -> "tuple[torch.Tensor, torch.Tensor]":
        """Computes one step of K policies with memory at once; those for which `remembered` is not 0.

        Args:
            weights: By name, (K, *shape) float32.
            inputs: (K, R, *observation_shape) float32, unscaled.
            memory: (K, R, M) float32 of the step before, zeros in an episode's first step.

        Returns:
            (K, R, 6) float32, logits, and the memory after this step, (K, R, M).
        """
        raise NotImplementedError

    def narrowed(
        self, weights: Mapping[str, NDArray[np.float32]]
    ) -> tuple[Mapping[str, NDArray[np.float32]], NDArray[np.int64] | None]:
        """Drops the inputs that no policy uses.

        Args:
            weights: By name, (K, *shape).

        Returns:
            Weights with which `forward` or `advance` returns the same from inputs (K, R, L), and the indices (L,) of
            these in the flattened observation; the unchanged weights and None if all inputs are needed.
        """
        return weights, None


def narrowed_layer(
    weights: Mapping[str, NDArray[np.float32]], name: str
) -> tuple[Mapping[str, NDArray[np.float32]], NDArray[np.int64] | None]:
    """Drops the inputs that a layer of all policies multiplies by 0, such as those that never change.

    Args:
        weights: By name, (K, *shape).
        name: The tensor of the layer that reads the flattened observation, (K, out, inputs).

    Returns:
        As `Architecture.narrowed` does.
    """
    first = weights[name]
    live = np.flatnonzero(first.any((0, 1)))
    if not 0 < len(live) < first.shape[2]:
        return weights, None
    return {**weights, name: first[:, :, live]}, live


def check_widths(name: str, widths: tuple[int, ...], least: int = 1) -> None:
    """Checks the widths of fully connected layers.

    Raises:
        ValueError: Fewer than `least` layers, or an empty one; names the field.
    """
    if len(widths) < least or min(widths, default=1) < 1:
        raise ValueError(f"{name} is {list(widths)}; give one width from 1 for each {name} layer")


def dense_shapes(name: str, inputs: int, widths: tuple[int, ...]) -> dict[str, tuple[int, ...]]:
    """Returns `<name>.<i>.weight` (out, in) and `<name>.<i>.bias` (out,) of fully connected layers."""
    shapes: dict[str, tuple[int, ...]] = {}
    for i, (wide_in, wide_out) in enumerate(zip((inputs, *widths), widths, strict=False)):
        shapes[f"{name}.{i}.weight"], shapes[f"{name}.{i}.bias"] = (wide_out, wide_in), (wide_out,)
    return shapes


def action_shapes(inputs: int) -> dict[str, tuple[int, ...]]:
    """Returns `action.weight` and `action.bias` of the layer that gives the logits."""
    return {"action.weight": (NUM_ACTIONS, inputs), "action.bias": (NUM_ACTIONS,)}


def layer(weights: "Mapping[str, torch.Tensor]", name: str, values: "torch.Tensor") -> "torch.Tensor":
    """Computes a fully connected layer of K policies: (K, R, in) -> (K, R, out)."""
    import torch

    return torch.baddbmm(weights[f"{name}.bias"].unsqueeze(1), values, weights[f"{name}.weight"].transpose(1, 2))

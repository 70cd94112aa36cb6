"""A network with memory: fully connected layers, an LSTM, fully connected layers.

Axes: K policies, R rows of each policy, H units of the LSTM.
"""

from collections.abc import Mapping
from math import prod
from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    import torch


class Lstm(Architecture, frozen=True, kw_only=True, forbid_unknown_fields=True, tag="lstm"):
    """Layers with ReLU over the flattened observation, one LSTM layer, then layers with tanh.

    It is the actor of sb3-contrib's `MlpLstmPolicy`: a features extractor, the LSTM, `net_arch`, the action layer.
    What a row remembers is the LSTM's output and its cells, 2 H numbers. The gates have torch's order: input, forget,
    cell, output.

    Source: Hochreiter and Schmidhuber 1997; Pleines et al. 2022, "Generalization, mayhems and limits in recurrent
    proximal policy optimization", which sb3-contrib follows.

    Attributes:
        trunk: Width of each layer before the LSTM; none by default.
        units: Units of the LSTM.
        head: Width of each layer after the LSTM; none by default.
    """

    trunk: tuple[int, ...] = ()
    units: int = 64
    head: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Checks the layers too.

        Raises:
            ValueError: Names the field.
        """
        Architecture.__post_init__(self)
        check_widths("trunk", self.trunk, least=0)
        check_widths("head", self.head, least=0)
        if self.units < 1:
            raise ValueError(f"units is {self.units}; give a number from 1")

    @property
    def remembered(self) -> int:
        """The LSTM's output, then its cells."""
        return 2 * self.units

    def tensor_shapes(self) -> dict[str, tuple[int, ...]]:
        """Returns `trunk.<i>.*`, `lstm.input.weight`, `lstm.memory.weight`, `lstm.bias`, `head.<i>.*` and `action.*`.

        The tensors of the LSTM are (4 H, in), (4 H, H) and (4 H,); torch's two biases are one here, their sum.
        """
        inputs = prod(self.observation_shape)
        return {
            **dense_shapes("trunk", inputs, self.trunk),
            "lstm.input.weight": (4 * self.units, (inputs, *self.trunk)[-1]),
            "lstm.memory.weight": (4 * self.units, self.units),
            "lstm.bias": (4 * self.units,),
            **dense_shapes("head", self.units, self.head),
            **action_shapes((self.units, *self.head)[-1]),
        }

    def advance(
        self, weights: "Mapping[str, torch.Tensor]", inputs: "torch.Tensor", memory: "torch.Tensor"
    ) -> "tuple[torch.Tensor, torch.Tensor]":
        """Computes one step of K policies at once; see `Architecture.advance`."""
        import torch

        values = inputs.flatten(2)
        for i in range(len(self.trunk)):
            values = torch.relu(layer(weights, f"trunk.{i}", values))
        output, cells = memory.chunk(2, 2)
        gates = torch.baddbmm(weights["lstm.bias"].unsqueeze(1), values, weights["lstm.input.weight"].transpose(1, 2))
        gates = torch.baddbmm(gates, output, weights["lstm.memory.weight"].transpose(1, 2))
        take, keep, new, show = gates.chunk(4, 2)
        cells = torch.sigmoid(keep) * cells + torch.sigmoid(take) * torch.tanh(new)
        values = output = torch.sigmoid(show) * torch.tanh(cells)
        for i in range(len(self.head)):
            values = torch.tanh(layer(weights, f"head.{i}", values))
        return layer(weights, "action", values), torch.cat((output, cells), 2)

    def narrowed(
        self, weights: Mapping[str, NDArray[np.float32]]
    ) -> tuple[Mapping[str, NDArray[np.float32]], NDArray[np.int64] | None]:
        """Drops the inputs that the first layers of all policies multiply by 0; see `Architecture.narrowed`."""
        return narrowed_layer(weights, "trunk.0.weight" if self.trunk else "lstm.input.weight")

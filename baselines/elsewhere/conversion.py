"""Turns an actor that was trained in JaxMARL into a frozen policy of ours; its actions have the same numbers.

Source: JaxMARL 0.2.0, `OvercookedActions`: up, down, right, left, stay, interact.
"""

import zipfile
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.policies.policy import Mlp, PolicyFiles, save_policy
from overcooked_bench.errors import WrongUse


class ConversionError(WrongUse):
    """A file of weights is missing, damaged, or of another network."""


def convert(file: Path, stem: Path, architecture: Mlp) -> PolicyFiles:
    """Writes the policy of an actor's weights, float16.

    Args:
        file: npz with `kernel_<i>` (in, out) and `bias_<i>` (out,) of each layer; the inputs of the first one are
            (H, W, channels), flattened.
        stem: Of the policy's two files.
        architecture: The policy's, with as many hidden layers.

    Raises:
        ConversionError: The file cannot be read.
        PolicyError: The weights do not fit the architecture.
    """
    try:
        with np.load(file, allow_pickle=False) as arrays:
            weights = converted(dict(arrays), architecture)
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise ConversionError(
            f"{file}: no weights of such a network ({error}); remove the run's folder and train it again"
        ) from None
    return save_policy(stem, architecture, weights)


def converted(arrays: Mapping[str, NDArray[np.float32]], architecture: Mlp) -> dict[str, NDArray[np.float32]]:
    """Returns tensors by the architecture's names: transposed, and the first one with the channels first.

    Raises:
        KeyError: A layer is missing.
        ValueError: The first layer has other inputs.
    """
    channels, height, width = architecture.observation_shape
    names = [*(f"trunk.{i}" for i in range(len(architecture.hidden))), "action"]
    tensors: dict[str, NDArray[np.float32]] = {}
    for i, name in enumerate(names):
        weight = arrays[f"kernel_{i}"].T
        if i == 0:
            grid = weight.reshape(len(weight), height, width, channels)
            weight = grid.transpose(0, 3, 1, 2).reshape(len(weight), -1)
        tensors |= {f"{name}.weight": weight, f"{name}.bias": arrays[f"bias_{i}"]}
    return tensors

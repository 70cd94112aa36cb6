"""A frozen policy on disk: `<name>.safetensors`, the actor's weights, and `<name>.json`, its architecture.

Both are parsed and checked, never unpickled. Torch is not needed to read or write them.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.policies.architecture import Architecture
from overcooked_bench.agents.policies.architectures import ARCHITECTURES, Cnn, Mlp
from overcooked_bench.documents import parse_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import FileError, read_regular, write_whole
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import Layout

__all__ = [
    "ARCHITECTURES",
    "Architecture",
    "Cnn",
    "Mlp",
    "Policy",
    "PolicyError",
    "PolicyFiles",
    "load_policy",
    "policy_files",
    "save_policy",
]

MOST_WEIGHTS: Final = 100_000_000
WEIGHTS_SUFFIX, ARCHITECTURE_SUFFIX = ".safetensors", ".json"
_HEADER_ROOM: Final = 1_000_000  # bytes of a weights file besides the weights
_MOST_JSON: Final = 1_000_000  # bytes of an architecture


class PolicyError(WrongUse):
    """A policy's files are missing, broken or do not fit each other; the message names the file and the remedy."""


@dataclass(frozen=True)
class Policy:
    """A frozen policy.

    Attributes:
        name: The stem of its files.
        architecture: Its network and what it was trained for.
        weights: Every tensor by name, float32.
        sha256: Hash of the weights file, hexadecimal.
    """

    name: str
    architecture: Architecture
    weights: Mapping[str, NDArray[np.float32]]
    sha256: str


class PolicyFiles(NamedTuple):
    """The files of a policy.

    Attributes:
        weights: `<name>.safetensors`.
        architecture: `<name>.json`.
    """

    weights: Path
    architecture: Path


def policy_files(path: str | Path) -> PolicyFiles:
    """Returns the pair of files of a policy, from either of them or from their common stem."""
    path = Path(path)
    if path.suffix in (WEIGHTS_SUFFIX, ARCHITECTURE_SUFFIX):
        path = path.with_suffix("")
    return PolicyFiles(*(path.with_name(path.name + suffix) for suffix in (WEIGHTS_SUFFIX, ARCHITECTURE_SUFFIX)))


def save_policy(
    stem: str | Path,
    architecture: Architecture,
    state_dict: Mapping[str, Any],
    dtype: type[np.float16] | type[np.float32] = np.float16,
) -> PolicyFiles:
    """Writes a policy; the same weights give the same bytes.

    Args:
        stem: Folder and name of the two files, without suffix. The folder is made.
        architecture: Which tensors there are.
        state_dict: Torch tensors or arrays by the names of `architecture.tensor_shapes()`, no others.
        dtype: What is stored.

    Raises:
        PolicyError: The tensors do not fit the architecture, or do not fit into the type; nothing is written.
    """
    from safetensors.numpy import save

    files = policy_files(stem)
    _check_architecture(architecture, files.architecture)
    tensors = {}
    for name, tensor in state_dict.items():
        array = np.asarray(tensor.detach().cpu().numpy() if hasattr(tensor, "detach") else tensor)
        with np.errstate(over="ignore"):
            tensors[name] = np.ascontiguousarray(array.astype(dtype))
    _check_tensors(architecture, tensors, files.weights)
    files.weights.parent.mkdir(parents=True, exist_ok=True)
    write_whole(files.weights, save(tensors))
    write_whole(files.architecture, msgspec.json.format(msgspec.json.encode(architecture), indent=2) + b"\n")
    return files


def load_policy(path: str | Path) -> Policy:
    """Reads and checks a policy.

    Args:
        path: Its `.safetensors` file, its `.json` file or their common stem.

    Raises:
        PolicyError: A file is missing or broken, or the two do not fit each other; names the file and the remedy.
    """
    from safetensors import SafetensorError
    from safetensors.numpy import load

    files = policy_files(path)
    architecture = _read_architecture(files.architecture)
    data = _read(files.weights, 4 * _count(architecture) + _HEADER_ROOM)
    try:
        tensors = load(data)
    except (SafetensorError, ValueError, KeyError, TypeError) as error:
        raise PolicyError(f"{files.weights}: not a safetensors file ({error}); write it with save_policy") from None
    _check_tensors(architecture, tensors, files.weights)
    weights = {name: tensors[name].astype(np.float32) for name in architecture.tensor_shapes()}
    return Policy(files.weights.stem, architecture, weights, hashlib.sha256(data).hexdigest())


def _read_architecture(file: Path) -> Architecture:
    remedy = "write it with save_policy"
    raw = parse_json(_read(file, _MOST_JSON), str(file), Any, PolicyError)
    named = raw.get("architecture") if isinstance(raw, dict) else None
    if not isinstance(named, str) or named not in ARCHITECTURES:
        known = ", ".join(map(repr, ARCHITECTURES))
        raise PolicyError(f"{file}: the entry 'architecture' is {named!r}; this version knows {known}")
    try:
        architecture = msgspec.convert(raw, ARCHITECTURES[named])
    except msgspec.ValidationError as error:
        raise PolicyError(f"{file}: {error}; {remedy}") from None
    _check_architecture(architecture, file)
    return architecture


def _check_architecture(architecture: Architecture, file: Path) -> None:
    from overcooked_bench.kitchen.observations.registry import find_observation

    if _count(architecture) > MOST_WEIGHTS:
        raise PolicyError(f"{file}: {_count(architecture)} weights; at most {MOST_WEIGHTS} are supported")
    try:
        layout = Layout.named(architecture.layout)
    except LayoutError as error:
        raise PolicyError(f"{file}: the entry 'layout': {error}") from None
    name = architecture.observation
    try:
        expected = find_observation(name).shape(layout)
    except WrongUse as error:
        raise PolicyError(f"{file}: the entry 'observation': {error}") from None
    if architecture.observation_shape != expected:
        raise PolicyError(
            f"{file}: observation_shape is {list(architecture.observation_shape)}; "
            f"{name!r} on this layout has {list(expected)}"
        )


def _check_tensors(architecture: Architecture, tensors: Mapping[str, NDArray[Any]], file: Path) -> None:
    shapes = architecture.tensor_shapes()
    if set(tensors) != set(shapes):
        missing, strange = sorted(set(shapes) - set(tensors)), sorted(set(tensors) - set(shapes))
        raise PolicyError(
            f"{file}: the tensors are not those of the architecture (missing: {', '.join(missing) or 'none'}; "
            f"unknown: {', '.join(strange) or 'none'}); save the actor alone, under the architecture's names"
        )
    for name, shape in shapes.items():
        tensor = tensors[name]
        if tensor.shape != shape:
            raise PolicyError(
                f"{file}: {name} has the shape {list(tensor.shape)}; the architecture says {list(shape)}; "
                f"correct the {ARCHITECTURE_SUFFIX} file, or save the policy again"
            )
        if tensor.dtype not in (np.float16, np.float32):
            raise PolicyError(f"{file}: {name} is {tensor.dtype}; store float16 or float32")
        if not np.isfinite(tensor).all():
            raise PolicyError(
                f"{file}: {name} holds numbers that are infinite, undefined or too large for {tensor.dtype}; "
                "a policy of a training run that diverged cannot be used"
            )


def _count(architecture: Architecture) -> int:
    return sum(prod(shape) for shape in architecture.tensor_shapes().values())


def _read(file: Path, most_bytes: int) -> bytes:
    try:
        return read_regular(file, most_bytes)
    except FileError as error:
        pair = f"<name>{WEIGHTS_SUFFIX} and <name>{ARCHITECTURE_SUFFIX}"
        raise PolicyError(f"{error}; a policy is a pair of regular files {pair}") from None

"""Reads a model that stable-baselines3 saved: its weights, and those of its settings that are plain text.

The file is a zip. `policy.pth` holds the weights, which torch reads without running code (`weights_only`). `data` is
JSON; what is pickled in it is passed over, and only the readable text next to it is used.
"""

import io
import os
import pickle
import re
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from overcooked_bench.documents import DocumentError, parse_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown

if TYPE_CHECKING:
    import torch

_WEIGHTS, _SETTINGS = "policy.pth", "data"
_MOST_BYTES: Final = 512 << 20
"""Bytes of the file, and of what is read of it."""

_PICKLED: Final = ":serialized:"


class ExportError(WrongUse):
    """A model cannot be exported; the message says why, and what to write or train instead."""


@dataclass(frozen=True)
class SavedModel:
    """A model as its file says, without what is pickled.

    Attributes:
        tensors: The policy's weights by name.
        policy_module: The Python module of the policy's class.
        policy_settings: The policy's keyword arguments, those that are not plain as text; None if they are missing.
        space: "Box", "Dict" or whatever else the observation space is.
        shape: Shape of an observation.
        dtype: Its type, such as "uint8"; an empty text if the file does not say.
        high: Its greatest number; None if the file does not say.
        in_vec_normalize: Whether the last training was in a VecNormalize.
        steps: Steps that it was trained for, as stable-baselines3 counts them: one for each row of its environment.
    """

    tensors: "Mapping[str, torch.Tensor]"
    policy_module: str
    policy_settings: Mapping[str, Any] | None
    space: str
    shape: tuple[int, ...]
    dtype: str
    high: float | None
    in_vec_normalize: bool
    steps: int


def read_model(file: str | Path) -> SavedModel:
    """Reads what `model.save(...)` of stable-baselines3 wrote.

    Raises:
        ExportError: It is something else, or was saved without what is needed.
    """
    where = shown(file)
    if not os.path.isfile(file):
        raise ExportError(f"{where}: no such file; give what `model.save(...)` of stable-baselines3 wrote")
    if os.path.getsize(file) > _MOST_BYTES:
        raise ExportError(f"{where}: larger than {_MOST_BYTES:,} bytes, the most that is read here")
    try:
        with zipfile.ZipFile(file) as whole:
            settings, weights = (_entry(whole, name) for name in (_SETTINGS, _WEIGHTS))
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, OSError, EOFError, KeyError) as error:
        raise ExportError(
            f"{where}: not a model of stable-baselines3 ({error}); give what `model.save(...)` wrote"
        ) from None
    try:
        data = parse_json(settings, f"{where}: {_SETTINGS}", dict[str, Any])
    except DocumentError as error:
        raise ExportError(str(error)) from None
    space = _mapping(data.get("observation_space"))
    return SavedModel(
        tensors=_tensors(weights, where),
        policy_module=str(_mapping(data.get("policy_class")).get("__module__", "")),
        policy_settings=_plain(data["policy_kwargs"]) if "policy_kwargs" in data else None,
        space=str(space.get(":type:", "")).rpartition(".")[2].rstrip("'>"),
        shape=_shape(space.get("_shape")),
        dtype=str(space.get("dtype", "")),
        high=_first_number(space.get("high")),
        in_vec_normalize=data.get("_last_original_obs") is not None,
        steps=_count(data.get("num_timesteps")),
    )


def _entry(whole: zipfile.ZipFile, name: str) -> bytes:
    with whole.open(name) as opened:
        data = opened.read(_MOST_BYTES + 1)
    if len(data) > _MOST_BYTES:
        raise zipfile.BadZipFile(f"{name} unpacks to more than {_MOST_BYTES:,} bytes")
    return data


def _tensors(data: bytes, where: str) -> "dict[str, torch.Tensor]":
    import torch

    try:
        found = torch.load(io.BytesIO(data), map_location="cpu", weights_only=True)
    except (pickle.UnpicklingError, RuntimeError, ValueError, TypeError, KeyError, EOFError, AttributeError) as error:
        reason = shown(str(error).partition("\n")[0])
        raise ExportError(f"{where}: {_WEIGHTS} does not hold plain weights ({reason}); save the model again") from None
    if not isinstance(found, dict) or not all(isinstance(tensor, torch.Tensor) for tensor in found.values()):
        raise ExportError(f"{where}: {_WEIGHTS} does not hold tensors by name; save the model again")
    return {str(name): tensor for name, tensor in found.items()}


def _mapping(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


def _plain(value: Any) -> dict[str, Any]:
    """Returns the readable part of a mapping; of what is pickled too, stable-baselines3 writes each entry as text."""
    return {key: entry for key, entry in _mapping(value).items() if key not in (":type:", _PICKLED)}


def _shape(text: Any) -> tuple[int, ...]:
    found = re.fullmatch(r"[\[(]([\d, ]*)[\])]", str(text))
    return tuple(int(number) for number in re.findall(r"\d{1,9}", found[1])) if found else ()


def _first_number(text: Any) -> float | None:
    found = re.search(r"-?\d+(?:\.\d*)?(?:e[+-]?\d+)?", str(text))
    return float(found[0]) if found else None


def _count(value: Any) -> int:
    return value if type(value) is int and value >= 0 else 0

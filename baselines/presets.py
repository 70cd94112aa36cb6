"""Named configurations of the training methods: `configs/<method>.yaml`, a mapping from names to settings.

A configuration says where it differs from the method's defaults; `extends: other` starts from another one of the file,
`extends: method:other` from one of another method's; `by_layout` has what differs on single layouts. A method without
such a file has one configuration, `default`.
"""

import types
from dataclasses import MISSING, fields
from functools import lru_cache
from importlib.resources import files
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

import msgspec

from overcooked_bench.documents import parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import MIRRORED, Layout
from overcooked_bench.shelf import guess

from .learning.settings import Settings
from .methods import check_method, find_method

AnySettings = TypeVar("AnySettings", bound=Settings)


class PresetError(WrongUse):
    """There is no such method or configuration, or its file is wrong; says what to write instead."""


class _Configuration(msgspec.Struct):
    """What every configuration may have besides settings, which are checked with the method's class."""

    extends: str | None = None
    by_layout: dict[str, dict[str, Any]] | None = None


def config_names(method: str) -> tuple[str, ...]:
    """Lists the configurations of a method; the first one is the default."""
    return tuple(_read(method))


def config_class(method: str) -> type[Settings]:
    """Gives the settings class of a method.

    Raises:
        WrongUse: There is no such method.
    """
    kind: type[Settings] = find_method(method).Config
    return kind


def load_config(method: str, name: str = "", /, **overrides: Any) -> Settings:
    """Makes the settings of a named configuration.

    Args:
        method: A training method.
        name: One of its configurations, the first one by default.
        overrides: Settings that replace the configuration's; `layout` is among them.

    Raises:
        PresetError: Unknown method, configuration or setting.
        ValueError: A setting is out of range.
    """
    kind = config_class(method)
    settings = {**named_settings(method, name, str(overrides.get("layout", ""))), **overrides}
    return kind(**checked(kind, settings, f"{method}, configuration {name or config_names(method)[0]!r}"))


def named_settings(
    method: str, name: str = "", layout: str = "", above: tuple[tuple[str, str], ...] = ()
) -> dict[str, Any]:
    """Gives what a configuration sets.

    Args:
        method: A training method.
        name: One of its configurations, or several joined by commas, of which later ones win.
        layout: Where it is to be used, as `Layout.load` takes it; a mirror image is set up as what it mirrors.
        above: The configurations that extend this one, as (method, name).

    Raises:
        PresetError: There is no such configuration, or it extends itself.
    """
    known = _read(method)
    settings: dict[str, Any] = {}
    for part in name.split(",") if name else [next(iter(known))]:
        if part not in known:
            raise PresetError(
                f"{method} has no configuration {part!r}; {guess(part, known)}there is {', '.join(known)}"
            )
        if (method, part) in above:
            raise PresetError(f"{method}: the configuration {part!r} extends itself; name another one")
        own = dict(known[part] or {})
        base = own.pop("extends", None)
        if base:
            other, _, configuration = base.rpartition(":")
            settings |= named_settings(other or method, configuration, layout, (*above, (method, part)))
        here = own.pop("by_layout", {})
        settings |= own | (here.get(_plain_name(layout), {}) if here else {})
    return settings


def _plain_name(layout: str) -> str:
    """Gives a layout's name; what cannot be loaded is refused elsewhere, with all other settings."""
    try:
        return Layout.load(layout).name.removesuffix(MIRRORED)
    except LayoutError:
        return ""


def checked(kind: type[Settings], settings: dict[str, Any], where: str) -> dict[str, Any]:
    """Gives settings as their class wants them: lists as tuples, whole numbers as floats where these are asked for.

    Raises:
        PresetError: A setting is unknown, missing or of another type.
    """
    hints = get_type_hints(kind)
    known = {f.name: hints[f.name] for f in fields(kind)}
    for key in settings:
        if key not in known:
            raise PresetError(f"{where}: unknown setting {key!r}; {guess(key, known)}there is {', '.join(known)}")
    for f in fields(kind):
        if f.default is MISSING and f.default_factory is MISSING and f.name not in settings:
            raise PresetError(f"{where}: the setting {f.name!r} is missing")
    return {key: _fitted(known[key], value, f"{where}, {key}") for key, value in settings.items()}


def _fitted(hint: Any, value: Any, where: str) -> Any:
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        if value is None and type(None) in inner:
            return None
        return _fitted(next(kind for kind in inner if kind is not type(None)), value, where)
    if origin is Literal and value in inner:
        return value
    if origin is tuple and isinstance(value, list | tuple):
        return tuple(_fitted(inner[0], entry, where) for entry in value)
    if origin is dict and isinstance(value, dict):
        return {_fitted(inner[0], k, where): _fitted(inner[1], v, where) for k, v in value.items()}
    if hint is float and isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    if isinstance(hint, type) and isinstance(value, hint) and not (hint is int and isinstance(value, bool)):
        return value
    raise PresetError(f"{where}: {value!r} is not {hint.__name__ if isinstance(hint, type) else hint}")


def _read(method: str) -> dict[str, Any]:
    check_method(method)
    file = files(__package__ or "").joinpath("configs", f"{method}.yaml")
    if not file.is_file():
        return {"default": {}}
    return _parsed(file.read_text(encoding="utf-8"), file.name)


@lru_cache
def _parsed(text: str, where: str) -> dict[str, Any]:
    document = parse_yaml(text, where, PresetError)
    document.convert(dict[str, _Configuration | None])
    if not document.data:
        raise document.error((), "no configurations; write `name: {setting: value}`")
    return document.data

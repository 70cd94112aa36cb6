"""Named configurations of the training methods: `configs/<method>.yaml`, a mapping from names to settings.

A configuration says where it differs from the method's defaults; `extends: other` starts from another one of the file,
`extends: method:other` from one of another method's; `by_layout` has what differs on single layouts. A method without
such a file has one configuration, `default`.
"""

from dataclasses import MISSING, fields
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any, TypeVar, get_type_hints

import msgspec

from overcooked_bench.documents import parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown
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
    """Returns the settings class of a method.

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
    """Returns what a configuration sets.

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
    """Returns a layout's name; what cannot be loaded is refused elsewhere, with all other settings."""
    try:
        return Layout.load(layout).name.removesuffix(MIRRORED)
    except LayoutError:
        return ""


def checked(kind: type[Settings], settings: dict[str, Any], where: str) -> dict[str, Any]:
    """Converts settings to the types of their class: lists to tuples, whole numbers to floats.

    Raises:
        PresetError: A setting is unknown, missing or of another type.
    """
    hints, known = get_type_hints(kind), {field.name: field for field in fields(kind)}
    for key in settings:
        if key not in known:
            raise PresetError(f"{where}: unknown setting {key!r}; {guess(key, known)}there is {', '.join(known)}")
    for field in known.values():
        if field.default is MISSING and field.default_factory is MISSING and field.name not in settings:
            raise PresetError(f"{where}: the setting {field.name!r} is missing")
    found = {}
    for key, value in settings.items():
        try:
            found[key] = msgspec.convert(value, hints[key], dec_hook=_path)
        except msgspec.ValidationError as error:
            raise PresetError(f"{where}, {key}: {shown(repr(value))} does not fit ({error})") from None
    return found


def _path(kind: type, value: Any) -> Path:
    if kind is not Path or not isinstance(value, str | Path):
        raise ValueError("Expected a path")
    return Path(value)


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

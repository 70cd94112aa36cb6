"""The page of the training methods' configurations, from `baselines/methods.py` and `baselines/configs`."""

from collections.abc import Iterator
from dataclasses import fields
from typing import Any, Final

from overcooked_bench.baselines.learning.settings import Settings
from overcooked_bench.baselines.methods import METHODS
from overcooked_bench.baselines.presets import config_class, config_names, load_config
from overcooked_bench.kitchen.layout import CLASSIC

PAGE: Final = "reference/methods.md"

_HEAD: Final = """# Configurations

`overcooked-bench train METHOD --config NAME` sets what is listed here: some settings of each method's first
configuration, and how the others differ from it. Where a setting depends on the layout, the values are those of
{layouts}, in this order. [](../training.md) describes the methods; `overcooked-bench train METHOD --help` describes
every setting.
"""


def pages() -> Iterator[tuple[str, str]]:
    """Yields the page and its text."""
    layouts = ",\n".join(", ".join(f"`{name}`" for name in part) for part in (CLASSIC[:3], CLASSIC[3:]))
    yield PAGE, "\n".join([_HEAD.format(layouts=layouts), *(line for method in METHODS for line in _method(method))])


def _method(method: str) -> Iterator[str]:
    first, *others = config_names(method)
    base = _settings(method, first)
    shown = ("steps", "num_kitchens", "rollout", "learning_rate", "network", "hidden", "observation", "start")
    yield f"## {method}\n\n{METHODS[method][0].upper()}{METHODS[method][1:]}.\n"
    yield "| configuration | settings |\n|---|---|"
    yield f"| `{first}` | {_listed({name: base[name] for name in shown if name in base})} |"
    for name in others:
        settings = _settings(method, name)
        yield f"| `{name}` | {_listed({key: value for key, value in settings.items() if value != base[key]})} |"
    yield ""


def _settings(method: str, name: str) -> dict[str, Any]:
    """Returns each setting of a configuration: one value, or one for each classic layout where they differ."""
    found: list[Settings] = [load_config(method, name, layout=layout) for layout in CLASSIC]
    names = [field.name for field in fields(config_class(method)) if field.name not in ("layout", "seed")]
    values = {one: [getattr(settings, one) for settings in found] for one in names}
    return {one: many[0] if all(each == many[0] for each in many) else many for one, many in values.items()}


def _listed(settings: dict[str, Any]) -> str:
    return ", ".join(f"`{name}` {_text(value)}" for name, value in settings.items()) or "-"


def _text(value: Any) -> str:
    if isinstance(value, list):
        return " / ".join(map(_text, value))
    if isinstance(value, tuple):
        return " ".join(map(_text, value)) or "none"
    if isinstance(value, float):
        return f"{value:.4g}"
    return f"{value:,}" if isinstance(value, int) and not isinstance(value, bool) else str(value) or "none"

"""The interface that agents implement, and helpers for writing an agent.

Names are imported when they are used, so that torch is loaded only if a network plays.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent, UnknownLayout, one_game_at_a_time
    from overcooked_bench.agents.catalogue import load_agent
    from overcooked_bench.agents.draws import sample_actions, uniforms

_HOMES = {
    "Agent": "agent",
    "UnknownLayout": "agent",
    "load_agent": "catalogue",
    "one_game_at_a_time": "agent",
    "sample_actions": "draws",
    "uniforms": "draws",
}

__all__ = ["Agent", "UnknownLayout", "load_agent", "one_game_at_a_time", "sample_actions", "uniforms"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

"""Score agents that cooperate with strangers: Overcooked kitchens, frozen partners, honest statistics.

Names are imported when they are used, so that `import overcooked_bench` stays quick.

PYTEST_DONT_REWRITE: pytest finds its plugin in here, and would warn a program that imported the package before it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from overcooked_bench.envs.registration import register_environments

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import UnknownLayout
    from overcooked_bench.agents.catalogue import load_agent
    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.envs.parallel import parallel_env
    from overcooked_bench.evaluation.comparing.compare import compare
    from overcooked_bench.evaluation.games.play import play_episodes
    from overcooked_bench.evaluation.pools.crossplay import cross_play
    from overcooked_bench.evaluation.score import score
    from overcooked_bench.evaluation.scores import read_scores
    from overcooked_bench.kitchen.errors import LayoutError
    from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
    from overcooked_bench.kitchen.layout import Layout
    from overcooked_bench.kitchen.state import Chef, KitchenState, Soup
    from overcooked_bench.scenarios.runner import run_scenarios

_HOMES = {
    "Chef": "kitchen.state",
    "KitchenState": "kitchen.state",
    "Kitchens": "kitchen.kitchens",
    "Layout": "kitchen.layout",
    "LayoutError": "kitchen.errors",
    "Pool": "agents.pools.pool",
    "Soup": "kitchen.state",
    "StepResult": "kitchen.kitchens",
    "UnknownLayout": "agents.agent",
    "compare": "evaluation.comparing.compare",
    "cross_play": "evaluation.pools.crossplay",
    "load_agent": "agents.catalogue",
    "parallel_env": "envs.parallel",
    "play_episodes": "evaluation.games.play",
    "read_scores": "evaluation.scores",
    "run_scenarios": "scenarios.runner",
    "score": "evaluation.score",
}

register_environments()

__all__ = [
    "Chef",
    "KitchenState",
    "Kitchens",
    "Layout",
    "LayoutError",
    "Pool",
    "Soup",
    "StepResult",
    "UnknownLayout",
    "compare",
    "cross_play",
    "load_agent",
    "parallel_env",
    "play_episodes",
    "read_scores",
    "run_scenarios",
    "score",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})

"""All observations by name: every `OBSERVATION` that a file in this folder defines."""

import pkgutil
from collections.abc import Iterable
from importlib import import_module
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen import observations as folder
from overcooked_bench.kitchen.observations.observation import Observation
from overcooked_bench.shelf import guess


def found() -> dict[str, Observation]:
    """Reads the folder; returns the observations in the order of their files' names."""
    modules = [
        import_module(f"{folder.__name__}.{module.name}")
        for module in pkgutil.iter_modules(folder.__path__)
        if f"{folder.__name__}.{module.name}" != __name__
    ]
    each: list[Observation] = [module.OBSERVATION for module in modules if hasattr(module, "OBSERVATION")]
    return {observation.name: observation for observation in each}


OBSERVATIONS: Final[dict[str, Observation]] = found()
"""Name -> observation."""


def find_observation(name: str) -> Observation:
    """Looks an observation up.

    Raises:
        WrongUse: There is no observation of this name.
    """
    if name not in OBSERVATIONS:
        raise WrongUse(
            f"no observation named {name!r}; {guess(name, OBSERVATIONS)}choose one of {', '.join(OBSERVATIONS)}"
        )
    return OBSERVATIONS[name]


def history_for(names: Iterable[str]) -> int:
    """Returns how many past states kitchens must keep to show all of these; other names need none."""
    return max((OBSERVATIONS[name].history for name in names if name in OBSERVATIONS), default=0)

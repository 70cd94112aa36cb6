"""Which numbers of an observation can ever change: the others are a bias that no layer needs to multiply."""

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation, history_for


def fixed_inputs(layout: Layout, observation: str) -> NDArray[np.float32]:
    """Returns the inputs that never change: (inputs,) float32, zero where an input is live."""
    kitchens = Kitchens(layout, 1, start="random", history=history_for([observation]))
    kitchens.reset(seed=0)
    shown = kitchens.observe(observation)[0, 0].reshape(-1).astype(np.float32)
    return np.where(find_observation(observation).live(layout).shown < 0, shown, np.float32(0))


def spreader(layout: Layout, observation: str, shape: tuple[int, ...]) -> Callable[[torch.Tensor], torch.Tensor]:
    """Makes the way back from live inputs, (B, L), to whole observations, (B, *shape) float32."""
    sources = torch.from_numpy(find_observation(observation).live(layout).shown)
    fixed = torch.from_numpy(fixed_inputs(layout, observation))
    where = sources.clamp(min=0)
    moving = (sources >= 0).float()

    def spread(seen: torch.Tensor) -> torch.Tensor:
        return (seen.float().index_select(1, where) * moving + fixed).view(-1, *shape)

    return spread

"""Which numbers of a grid observation can ever change: the others are a bias that no layer needs to multiply."""

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DIRECTIONS
from overcooked_bench.kitchen.kitchens import HISTORY, STACKED, Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations import CHANNELS, CHEF_CHANNELS, NUM_CHANNELS, ONION_CHANNELS, PAST_CHANNELS


def observed_channels(observation: str) -> tuple[int, ...]:
    """Gives the lossless channel that each plane of a grid observation shows, older states included."""
    past = PAST_CHANNELS * HISTORY
    return {
        "lossless": ONION_CHANNELS,
        "lossless26": tuple(range(NUM_CHANNELS)),
        "stack_channels": ONION_CHANNELS + past,
        "stack_states": ONION_CHANNELS * (1 + HISTORY),
    }[observation]


def live_inputs(layout: Layout, observation: str) -> NDArray[np.int64]:
    """Lists the inputs that play can change, as indices into the flattened observation (plane, y, x).

    Chefs stand on floor; contents are in pots; things lie on counters that a chef can face, or are carried over floor;
    urgency is the same in the whole plane, so one cell of it is enough. Tiles never change.
    """
    floor, pots = set(layout.positions(" ")), set(layout.positions("P"))
    reached = {(x + dx, y + dy) for x, y in floor for dx, dy in DIRECTIONS}
    things = floor | (set(layout.positions("X")) & reached)
    first = {min(floor)}
    cells = {
        **dict.fromkeys(CHANNELS[:CHEF_CHANNELS], floor),
        **dict.fromkeys(("onions_in_pot", "tomatoes_in_pot", "cook_time_remaining"), pots),
        **dict.fromkeys(("onions_in_soup", "tomatoes_in_soup", "soup_done"), things | pots),
        **dict.fromkeys(("dishes", "onions", "tomatoes"), things),
        "urgency": first,
    }
    area = layout.width * layout.height
    return np.array(
        [
            plane * area + y * layout.width + x
            for plane, channel in enumerate(observed_channels(observation))
            for x, y in sorted(cells.get(CHANNELS[channel], ()), key=lambda cell: (cell[1], cell[0]))
        ]
    )


def live_sources(layout: Layout, observation: str) -> NDArray[np.int64]:
    """Says where each input of an observation is found among the live ones.

    Returns:
        (inputs,) position in `live_inputs`, -1 where the input never changes.
    """
    live = live_inputs(layout, observation)
    channels = observed_channels(observation)
    area = layout.width * layout.height
    sources = np.full(len(channels) * area, -1)
    sources[live] = np.arange(len(live))
    for plane, channel in enumerate(channels):
        if CHANNELS[channel] == "urgency":
            cells = sources[plane * area : (plane + 1) * area]
            cells[:] = cells.max()
    return sources


def fixed_inputs(layout: Layout, observation: str) -> NDArray[np.float32]:
    """Gives the inputs that never change: (inputs,) float32, zero where an input is live."""
    kitchens = Kitchens(layout, 1, start="random", history=HISTORY if observation in STACKED else 0)
    kitchens.reset(seed=0)
    shown = kitchens.observe(observation)[0, 0].reshape(-1).astype(np.float32)
    return np.where(live_sources(layout, observation) < 0, shown, np.float32(0))


def spreader(layout: Layout, observation: str, shape: tuple[int, ...]) -> Callable[[torch.Tensor], torch.Tensor]:
    """Makes the way back from live inputs, (B, L), to whole observations, (B, *shape) float32."""
    sources = torch.from_numpy(live_sources(layout, observation))
    fixed = torch.from_numpy(fixed_inputs(layout, observation))
    where = sources.clamp(min=0)
    moving = (sources >= 0).float()

    def spread(seen: torch.Tensor) -> torch.Tensor:
        return (seen.float().index_select(1, where) * moving + fixed).view(-1, *shape)

    return spread

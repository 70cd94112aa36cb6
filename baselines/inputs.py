"""Which numbers of a grid observation can ever change: the others are a bias that no layer needs to multiply."""

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DIRECTIONS
from overcooked_bench.kitchen.kitchens import HISTORY
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

"""`lossless`: the 22 channels of kitchens without tomatoes."""

from typing import Final

from overcooked_bench.kitchen.observations.grid import ONION_CHANNELS, Grid

OBSERVATION: Final = Grid("lossless", [ONION_CHANNELS])

"""`lossless26`: all 26 channels of the reference encoding."""

from typing import Final

from overcooked_bench.kitchen.image import NUM_CHANNELS
from overcooked_bench.kitchen.observations.grid import Grid

OBSERVATION: Final = Grid("lossless26", [tuple(range(NUM_CHANNELS))])

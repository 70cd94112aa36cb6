"""Cuts a score into blocks, the same ones for any number of workers."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Final

import numpy as np

from overcooked_bench.evaluation.games.block import Block, rows_of

LEAST_ROWS: Final = 256
"""Rows of a batch where there are so many; with fewer, most of the time goes into calls instead of games."""


def cut(first: Block, layouts: Sequence[str], training_seeds: int) -> list[Block]:
    """Cuts a score into blocks, in an order in which all layouts and training seeds get ahead together.

    Args:
        first: A block of the score, whatever its layout, training seed and start states.
        layouts: What is played.
        training_seeds: Number of training runs of the agent.
    """
    play = first.protocol.play
    rows = [rows_of(replace(first, layout=layout, episodes=(0,))) for layout in layouts]
    groups = [group_starts(play.episodes, number) for number in rows]
    return [
        replace(first, layout=layout, training_seed=run, episodes=group)
        for at_a_time in zip_longest(*groups)
        for run in range(training_seeds)
        for layout, group in zip(layouts, at_a_time, strict=True)
        if group is not None
    ]


def group_starts(number: int, rows: int) -> list[tuple[int, ...]]:
    """Groups the indices of start states, each group as one batch.

    Args:
        number: Start states.
        rows: Rows that each of them has.

    Returns:
        Groups whose sizes differ by one at most, as many as have `LEAST_ROWS` rows each; otherwise one.
    """
    groups = np.array_split(np.arange(number), max(1, number * rows // LEAST_ROWS))
    return [tuple(group.tolist()) for group in groups if len(group)]

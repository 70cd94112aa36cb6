"""What the blocks cost so far, without a look at any score."""

from collections.abc import Mapping, Sequence

import numpy as np

from overcooked_bench.rendering.table import Table

from .records import BlockRecord
from .study import Study


def cost_table(study: Study, parts: Mapping[str, Mapping[str, Sequence[BlockRecord]]]) -> str:
    """Writes a table of CPU seconds per block, and of the core-hours that all planned blocks would take.

    Args:
        study: The recipe.
        parts: By name, the records of each layout.
    """
    rows = []
    for name, whole in parts.items():
        for layout, records in whole.items():
            if not records:
                continue
            arms = study.part(name).arms
            seconds = {arm: float(np.mean([record.by_arm[arm].seconds for record in records])) for arm in arms}
            scoring = float(np.mean([record.scoring_seconds for record in records]))
            block = sum(seconds.values()) + scoring
            planned = study.part(name).blocks[layout]
            failed = sum(bool(one.failed) for record in records for one in record.arms)
            rows.append(
                [
                    f"{name}, {layout}",
                    f"{len(records)} of {planned}",
                    ", ".join(f"{arm} {value:.0f}" for arm, value in seconds.items()),
                    f"{scoring:.0f}",
                    f"{block:.0f}",
                    f"{block * planned / 3600:.1f}",
                    f"{failed}",
                ]
            )
    heads = ["blocks", "there", "seconds per arm", "scoring", "whole block", "core-hours planned", "failed runs"]
    return Table(heads, rows).markdown()

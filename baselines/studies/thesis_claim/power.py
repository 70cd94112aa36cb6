"""What the study can see: `python -m overcooked_bench.baselines.studies.thesis_claim power` prints the plan's figures.

Assumed: differences per block are normal, and the two arms of a block have equal spreads and nothing in common.
"""

from typing import Final, NamedTuple

from overcooked_bench.rendering.table import Table

from .analysis import ALPHA, SMALLEST

SPREADS: Final = {
    ("forced_coordination", "home"): 0.093,
    ("forced_coordination", "away"): 0.050,
    ("counter_circuit", "home"): 0.055,
    ("counter_circuit", "away"): 0.109,
}
"""Standard deviation of N over training seeds of `self-play fast`: eight runs that had nothing to do with the pool.

Source: baselines/results/v1.json, as it was when the study was registered: entrants of the recipe "self-play fast
random mlp"; home is "N with own alone", away "N without own".
"""
_FACTORS: Final = (0.7, 1.0, 1.4)
"""Spreads of differences that are shown, as parts of the assumed one."""


class Power(NamedTuple):
    """What a test can see.

    Attributes:
        detects: Difference that a two-sided test finds, with the right sign, with a chance of 80 %.
        refutes: The chance of the verdict "refuted" where there is no difference.
        half: Expected half-width of the interval.
    """

    detects: float
    refutes: float
    half: float


def power(spread: float, blocks: int, alpha: float) -> Power:
    """Computes what a paired t test can see.

    Args:
        spread: Standard deviation of differences per block.
        blocks: n.
        alpha: Two-sided level of the test.

    Source: noncentral t distribution; Cohen 1988, "Statistical Power Analysis for the Behavioral Sciences".
    """
    from scipy.optimize import brentq
    from scipy.special import nctdtr, stdtrit

    freedom, error = blocks - 1, spread / blocks**0.5
    critical = float(stdtrit(freedom, 1 - alpha / 2))

    def found(size: float) -> float:
        return float(1 - nctdtr(freedom, size / error, critical))

    return Power(
        detects=float(brentq(lambda size: found(size) - 0.8, 0.0, 4 * critical * error)),
        refutes=float(nctdtr(freedom, -SMALLEST / error, -critical)),
        half=critical * error,
    )


def power_table(planned: dict[str, int]) -> str:
    """Writes the plan's table of power in Markdown.

    Args:
        planned: Layout -> blocks.
    """
    rows = []
    for (layout, side), seeds in SPREADS.items():
        for factor in _FACTORS:
            spread = factor * 2**0.5 * seeds
            first, last = (power(spread, planned[layout], alpha) for alpha in (ALPHA / 2, ALPHA))
            rows.append(
                [
                    f"{layout}, {side}",
                    f"{planned[layout]}",
                    f"{spread:.3f}" + " *" * (factor == 1),
                    f"{first.detects:.3f}",
                    f"{last.detects:.3f}",
                    f"{100 * first.refutes:.0f} %",
                    f"{100 * last.refutes:.0f} %",
                ]
            )
    heads = ["endpoint", "blocks", "sd of differences", "detects at .025", "at .05", "refutes at .025", "at .05"]
    return Table(heads, rows).markdown()

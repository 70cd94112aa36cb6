"""Balanced orders of conditions.

Source: Williams (1949), "Experimental designs balanced for the estimation of residual effects of treatments".
"""

from typing import Final

Orders = tuple[tuple[int, ...], ...]

MOST: Final = 64
"""Conditions at most."""


def williams(conditions: int) -> Orders:
    """Returns the orders of a Williams design.

    In all of them together, each condition is at each position equally often, and each follows each other one equally
    often.

    Args:
        conditions: n, from 1 to `MOST`.

    Returns:
        n orders of n conditions, numbered from 0; 2 n orders if n is odd and above 1.
    """
    n = conditions
    zigzag = [k // 2 if k % 2 == 0 else n - 1 - k // 2 for k in range(n)]
    square = tuple(tuple((first + shift) % n for first in zigzag) for shift in range(n))
    return square if n % 2 == 0 or n == 1 else square + tuple(order[::-1] for order in square)

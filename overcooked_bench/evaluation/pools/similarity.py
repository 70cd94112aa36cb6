"""How similar partners are, judged by how well they play with each other, and what follows for their weights.

Axes: P partners.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray


def similarity(means: ArrayLike, ceilings: ArrayLike) -> NDArray[np.float64]:
    """Returns the similarity of every two partners.

    Two partners are similar if they reach together what can be reached with them:
    s_ij = min(m_ij, m_ji) / min(ceiling_i, ceiling_j), clipped to [0, 1]; s_ii = 1.

    Args:
        means: (P, P) m, points per episode of the partners with one another; rows and columns may be agents and
            partners, or seats. The diagonal is not used.
        ceilings: (P,) points per episode of the best known responder to each, above 0.

    Returns:
        (P, P) symmetric, from 0 to 1.

    Raises:
        ValueError: Shapes that do not fit, a ceiling that is not above 0, or numbers that are not finite.
    """
    m, c = np.asarray(means, np.float64), np.asarray(ceilings, np.float64)
    if c.ndim != 1 or m.shape != (len(c), len(c)):
        raise ValueError(f"means of the shape {m.shape} and ceilings of the shape {c.shape}; give (P, P) and (P,)")
    if not (np.isfinite(m).all() and np.isfinite(c).all()):
        raise ValueError("some means or ceilings are not finite; give measured points")
    if (c <= 0).any():
        raise ValueError(f"the ceiling of partner {int(np.argmin(c))} is {c.min():g}; nothing can be reached with it")
    s = np.clip(np.minimum(m, m.T) / np.minimum.outer(c, c), 0.0, 1.0)
    np.fill_diagonal(s, 1.0)
    return s


def weights(s: ArrayLike) -> NDArray[np.float64]:
    """Returns the weight of each partner: w_i is proportional to 1 / sum_j s_ij.

    Partners that are the same for each other share the weight of one; partners that nobody is similar to weigh the
    same.

    Args:
        s: (P, P) of `similarity`.

    Returns:
        (P,) positive, with the sum 1.

    Raises:
        ValueError: Not a matrix of similarities.
    """
    raw = 1 / _checked(s).sum(axis=1)
    found: NDArray[np.float64] = raw / raw.sum()
    return found


def effective_number(s: ArrayLike) -> float:
    """Returns how many different partners there are: 1 / mean(s), 1 if all are the same, P if all differ entirely.

    Args:
        s: (P, P) of `similarity`.

    Raises:
        ValueError: Not a matrix of similarities.
    """
    return float(1 / _checked(s).mean())


def _checked(s: ArrayLike) -> NDArray[np.float64]:
    """Returns a matrix of similarities as an array.

    Raises:
        ValueError: It is not square, not symmetric, not between 0 and 1, or its diagonal is not 1.
    """
    matrix = np.asarray(s, np.float64)
    square = matrix.ndim == 2 and matrix.shape[0] == matrix.shape[1] > 0
    if not square or not ((matrix >= 0) & (matrix <= 1) & (matrix == matrix.T)).all() or (matrix.diagonal() != 1).any():
        raise ValueError(
            f"similarities of the shape {matrix.shape} that are not square, symmetric, from 0 to 1 with ones on the "
            "diagonal; give what similarity() returns"
        )
    return matrix

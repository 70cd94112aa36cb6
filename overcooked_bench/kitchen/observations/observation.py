"""What every observation says about itself; a file in this folder that defines `OBSERVATION` adds one."""

from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import Batch
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tables import Tables

PastState = tuple[NDArray[np.uint16], NDArray[np.uint8]]
"""Rows and images of N kitchens at an earlier step, as in `Batch`."""


class Live(NamedTuple):
    """What play can change in a flattened view of I numbers: L variables.

    Attributes:
        places: (L,) int64, ascending, one place where each variable is shown.
        shown: (I,) int64, the variable that each number shows, -1 where it never changes. Several numbers may show
            the same one.
    """

    places: NDArray[np.int64]
    shown: NDArray[np.int64]


class Observation:
    """One way to show a kitchen to a chef; subclasses say how.

    Attributes:
        name: What `Kitchens.observe` and agents call it.
        history: Past states that it shows besides the current one.
        dtype: Type of its numbers.
        can_mirror: Whether `mirrored` knows the view of the mirror image.
    """

    name: str
    history: int = 0
    dtype: ClassVar[np.dtype[Any]] = np.dtype(np.uint8)
    can_mirror: ClassVar[bool] = False

    def refuses(self, layout: Layout) -> str:
        """Returns why this layout cannot be shown in this way; an empty text where it can."""
        return ""

    def shape(self, layout: Layout) -> tuple[int, ...]:
        """Returns the shape of one chef's view."""
        raise NotImplementedError

    def low(self, layout: Layout) -> float:
        """Returns the least number that a view can hold."""
        return 0

    def high(self, layout: Layout) -> float:
        """Returns the greatest number that a view can hold."""
        raise NotImplementedError

    def prepare(self, layout: Layout, tables: Tables) -> Any:
        """Computes what `write` needs to know of a layout, once for a `Kitchens`; None where it needs nothing."""
        return None

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes the views of N kitchens; reads all else.

        Args:
            prepared: What `prepare` returned.
            batch: The kitchens now.
            past: At least `history` earlier states, the newest first; empty where none is needed.
            viewers: (N, V) int64 zeros and ones, whose views are wanted.
            out: (N, V, numbers of a view) `dtype`, every number of which is written.
        """
        raise NotImplementedError

    def mirrored(self, views: NDArray[Any]) -> NDArray[Any]:
        """Turns views, (..., *shape), into those of the mirror image, east and west exchanged: a fresh array."""
        raise NotImplementedError

    def live(self, layout: Layout) -> Live:
        """Says which numbers of a view play can change: all of them, unless a subclass knows better."""
        everything = np.arange(int(np.prod(self.shape(layout))))
        return Live(everything, everything)

"""`Observation`, the base of all observations; a file in this folder that defines `OBSERVATION` adds one."""

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
    """The L variables that can change during play in a flattened view of I numbers.

    Attributes:
        places: (L,) int64, ascending, one index at which each variable is shown.
        shown: (I,) int64, the variable that each number shows, -1 if it never changes. Several numbers may show
            the same one.
    """

    places: NDArray[np.int64]
    shown: NDArray[np.int64]


class Observation:
    """An observation of a kitchen by a chef; subclasses implement it.

    Attributes:
        name: Its name for `Kitchens.observe` and agents.
        history: Past states that it shows besides the current one.
        dtype: Type of its numbers.
        can_mirror: Whether `mirrored` is implemented.
    """

    name: str
    history: int = 0
    dtype: ClassVar[np.dtype[Any]] = np.dtype(np.uint8)
    can_mirror: ClassVar[bool] = False

    def refuses(self, layout: Layout) -> str:
        """Returns why a layout does not have this observation; an empty text if it has."""
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
        """Precomputes the data of a layout that `write` needs, once for a `Kitchens`; None if it needs nothing."""
        return None

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes the views of N kitchens; changes nothing else.

        Args:
            prepared: What `prepare` returned.
            batch: The kitchens now.
            past: At least `history` past states, the newest first; empty if none is needed.
            viewers: (N, V) int64 zeros and ones, the chefs whose views are wanted.
            out: (N, V, numbers of a view) `dtype`, every number of which is written.
        """
        raise NotImplementedError

    def mirrored(self, views: NDArray[Any]) -> NDArray[Any]:
        """Turns views, (..., *shape), into those of the mirror image, east and west exchanged: a fresh array."""
        raise NotImplementedError

    def live(self, layout: Layout) -> Live:
        """Returns the numbers of a view that can change during play: all of them unless a subclass overrides it."""
        everything = np.arange(int(np.prod(self.shape(layout))))
        return Live(everything, everything)

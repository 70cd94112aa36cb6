"""The conditions of scenarios as trees, with their value at one moment and their mirror image.

Axes: N kitchens (rows), all with chef A on the same seat.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import reduce
from operator import and_, eq, ge, gt, le, lt, ne, or_
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, HELD, POSITION
from overcooked_bench.kitchen.codes import (
    COUNTER,
    NUM_CELL_CODES,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    RECIPES,
    pot_recipe,
)
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.scenarios.language.counters import ITEMS, Counter, kinds

OPERATORS: Final = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
_FLIPPED: Final = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_FILLING: Final = np.array([sum(RECIPES[pot_recipe(c)]) if c >= POT_IDLE else 0 for c in range(NUM_CELL_CODES)])


class Moment(NamedTuple):
    """N kitchens at one moment.

    Attributes:
        layout: Their layout.
        rows: (N, ...) uint16, the rows of their batch.
        seat: Chef A's seat.
        counts: Counts so far, (N,) int64 each.
    """

    layout: Layout
    rows: NDArray[np.uint16]
    seat: int
    counts: Mapping[Counter, NDArray[np.int64]]

    def chef(self, name: str) -> int:
        """Returns the seat of "A" or "B"."""
        return self.seat if name == "A" else 1 - self.seat

    def position(self, name: str) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Returns a chef's x and y."""
        cell = self.rows[:, POSITION + self.chef(name)].astype(np.int64)
        return cell % self.layout.width, cell // self.layout.width

    def cell(self, x: int, y: int) -> NDArray[np.uint16]:
        """Returns the codes of the cell at (x, y)."""
        return self.rows[:, CELLS + y * self.layout.width + x]

    def pot(self, number: int) -> NDArray[np.uint16]:
        """Returns the codes of a pot, numbered from 1."""
        return self.cell(*self.layout.positions("P")[number - 1])


class Term:
    """A part of a condition. Subclasses are frozen dataclasses; `str` writes them as the language does."""

    def value(self, moment: Moment) -> NDArray[Any]:
        """Returns its value in each kitchen, (N,): bool for conditions, whole numbers for other terms."""
        raise NotImplementedError

    def mirrored(self, layout: Layout) -> "Term":
        """Returns the term that means the same in the mirror image of a layout."""
        return self

    def parts(self) -> Iterator["Term"]:
        """Lists itself and all its parts."""
        yield self


class Condition(Term):
    """A term that is true or false."""

    def mirrored(self, layout: Layout) -> "Condition":
        """Returns the condition that means the same in the mirror image of a layout."""
        return self

    @property
    def conjuncts(self) -> tuple["Condition", ...]:
        """The conditions that all have to hold."""
        return (self,)

    @property
    def counters(self) -> dict[Counter, int]:
        """The counters that it needs: counter -> a count that is equivalent to any greater one."""
        limits: dict[Counter, int] = {}
        for part in self.parts():
            if isinstance(part, Compare) and isinstance(part.left, Count):
                counter, number = part.left.counter, int(str(part.right))
                limits[counter] = max(limits.get(counter, 0), number + 1, 1)
        return limits


@dataclass(frozen=True)
class Number(Term):
    """A whole number."""

    number: int

    def value(self, moment: Moment) -> NDArray[Any]:
        """Itself."""
        return np.asarray(self.number)

    def __str__(self) -> str:
        return str(self.number)


@dataclass(frozen=True)
class Item(Term):
    """The name of an object."""

    name: str

    def value(self, moment: Moment) -> NDArray[Any]:
        """Its code."""
        return np.asarray(ITEMS[self.name])

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Count(Term):
    """How often something happened."""

    counter: Counter

    def value(self, moment: Moment) -> NDArray[Any]:
        """The count so far."""
        return moment.counts[self.counter]

    def mirrored(self, layout: Layout) -> "Count":
        """The same at the mirrored pot."""
        at = self.counter.at
        return self if at is None else Count(replace(self.counter, at=mirrored_pot(layout, at)))

    def __str__(self) -> str:
        return str(self.counter)


@dataclass(frozen=True)
class Coordinate(Term):
    """A chef's column ("x") or row ("y")."""

    chef: str
    axis: str

    def value(self, moment: Moment) -> NDArray[Any]:
        """Where the chef stands."""
        return moment.position(self.chef)["xy".index(self.axis)]

    def __str__(self) -> str:
        return f"{self.chef}.{self.axis}"


@dataclass(frozen=True)
class Distance(Term):
    """Columns plus rows between the chefs, ignoring walls and counters."""

    def value(self, moment: Moment) -> NDArray[Any]:
        """The distance, 1 side by side."""
        (ax, ay), (bx, by) = moment.position("A"), moment.position("B")
        return np.asarray(np.abs(ax - bx) + np.abs(ay - by))

    def __str__(self) -> str:
        return "dist(A, B)"


@dataclass(frozen=True)
class PotSize(Term):
    """The number of ingredients in a pot, cooked ones too."""

    pot: int

    def value(self, moment: Moment) -> NDArray[Any]:
        """0 to 3."""
        return np.asarray(_FILLING[moment.pot(self.pot)])

    def mirrored(self, layout: Layout) -> "PotSize":
        """The same of the mirrored pot."""
        return PotSize(mirrored_pot(layout, self.pot))

    def __str__(self) -> str:
        return f"pot({self.pot}).n"


@dataclass(frozen=True)
class Lying(Term):
    """The object on the counter at (x, y)."""

    x: int
    y: int

    def value(self, moment: Moment) -> NDArray[Any]:
        """Its code."""
        return kinds(moment.cell(self.x, self.y) - np.uint16(COUNTER))

    def mirrored(self, layout: Layout) -> "Lying":
        """The same on the mirrored counter."""
        return Lying(layout.width - 1 - self.x, self.y)

    def __str__(self) -> str:
        return f"counter({self.x}, {self.y})"


@dataclass(frozen=True)
class Holds(Condition):
    """Whether a chef holds a given object, or nothing."""

    chef: str
    item: str

    def value(self, moment: Moment) -> NDArray[Any]:
        """The hands, compared."""
        return np.asarray(kinds(moment.rows[:, HELD + moment.chef(self.chef)]) == ITEMS[self.item])

    def __str__(self) -> str:
        return f"{self.chef}.holds({self.item})"


@dataclass(frozen=True)
class At(Condition):
    """Whether a chef stands at (x, y)."""

    chef: str
    x: int
    y: int

    def value(self, moment: Moment) -> NDArray[Any]:
        """The position, compared."""
        x, y = moment.position(self.chef)
        return np.asarray((x == self.x) & (y == self.y))

    def mirrored(self, layout: Layout) -> "At":
        """The same at the mirrored cell."""
        return replace(self, x=layout.width - 1 - self.x)

    def __str__(self) -> str:
        return f"{self.chef}.at({self.x}, {self.y})"


@dataclass(frozen=True)
class PotIs(Condition):
    """Whether a pot is "cooking" or "ready"."""

    pot: int
    what: str

    def value(self, moment: Moment) -> NDArray[Any]:
        """The pot's code, compared."""
        code = moment.pot(self.pot)
        ready = code > POT_READY
        return np.asarray(ready if self.what == "ready" else (code > POT_COOKING) & ~ready)

    def mirrored(self, layout: Layout) -> "PotIs":
        """The same of the mirrored pot."""
        return replace(self, pot=mirrored_pot(layout, self.pot))

    def __str__(self) -> str:
        return f"pot({self.pot}).{self.what}"


@dataclass(frozen=True)
class Compare(Condition):
    """Two terms compared."""

    left: Term
    operator: str
    right: Term

    def value(self, moment: Moment) -> NDArray[Any]:
        """The comparison."""
        return np.asarray(OPERATORS[self.operator](self.left.value(moment), self.right.value(moment)))

    def mirrored(self, layout: Layout) -> "Compare":
        """The same comparison of mirrored terms; columns count from the other side."""
        if not (isinstance(self.left, Coordinate) and self.left.axis == "x"):
            return Compare(self.left.mirrored(layout), self.operator, self.right.mirrored(layout))
        right = Number(layout.width - 1 - self.right.number) if isinstance(self.right, Number) else self.right
        return Compare(self.left, _FLIPPED.get(self.operator, self.operator), right)

    def parts(self) -> Iterator[Term]:
        """Itself and both sides."""
        yield from (self, self.left, self.right)

    def __str__(self) -> str:
        return f"{self.left} {self.operator} {self.right}"


@dataclass(frozen=True)
class Not(Condition):
    """The opposite."""

    part: Condition

    def value(self, moment: Moment) -> NDArray[Any]:
        """The opposite."""
        return np.asarray(~self.part.value(moment))

    def mirrored(self, layout: Layout) -> "Not":
        """The opposite of the mirrored condition."""
        return Not(self.part.mirrored(layout))

    def parts(self) -> Iterator[Term]:
        """Itself and the condition that it negates."""
        yield self
        yield from self.part.parts()

    def __str__(self) -> str:
        return f"not {_bracketed(self.part)}"


@dataclass(frozen=True)
class Both(Condition):
    """All of several conditions (`and`)."""

    conditions: tuple[Condition, ...]

    @property
    def conjuncts(self) -> tuple[Condition, ...]:
        """Each of them."""
        return tuple(part for condition in self.conditions for part in condition.conjuncts)

    def value(self, moment: Moment) -> NDArray[Any]:
        """Whether all hold."""
        return np.asarray(reduce(and_, (condition.value(moment) for condition in self.conditions)))

    def mirrored(self, layout: Layout) -> "Both":
        """All of the mirrored conditions."""
        return Both(tuple(condition.mirrored(layout) for condition in self.conditions))

    def parts(self) -> Iterator[Term]:
        """Itself and all parts of all."""
        yield self
        for condition in self.conditions:
            yield from condition.parts()

    def __str__(self) -> str:
        return " and ".join(map(_bracketed, self.conditions))


@dataclass(frozen=True)
class Either(Condition):
    """At least one of several conditions (`or`)."""

    conditions: tuple[Condition, ...]

    def value(self, moment: Moment) -> NDArray[Any]:
        """Whether one holds."""
        return np.asarray(reduce(or_, (condition.value(moment) for condition in self.conditions)))

    def mirrored(self, layout: Layout) -> "Either":
        """One of the mirrored conditions."""
        return Either(tuple(condition.mirrored(layout) for condition in self.conditions))

    def parts(self) -> Iterator[Term]:
        """Itself and all parts of all."""
        yield self
        for condition in self.conditions:
            yield from condition.parts()

    def __str__(self) -> str:
        return " or ".join(map(str, self.conditions))


def mirrored_pot(layout: Layout, number: int) -> int:
    """Returns the number of a layout's pot in the mirror image; both count in reading order from 1."""
    x, y = layout.positions("P")[number - 1]
    return layout.mirrored().positions("P").index((layout.width - 1 - x, y)) + 1


def _bracketed(condition: Condition) -> str:
    return f"({condition})" if isinstance(condition, Both | Either) else str(condition)

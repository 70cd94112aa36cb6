"""Behaviours that do one part of the kitchen's work, each from what it sees now, so they resume after an interruption.

Only the behaviours that put objects on counters put anything down; the others stand still with what they cannot use.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from overcooked_bench.agents.behaviours.behaviour import Behaviour, Content, Scene, Sight
from overcooked_bench.agents.behaviours.timed import FROZEN, ask
from overcooked_bench.agents.behaviours.walking import SIGHTS, Manner, go, nearest, rest
from overcooked_bench.kitchen.codes import MAX_INGREDIENTS, STAY, Position


class Errand(NamedTuple):
    """The next place to go to.

    Attributes:
        cell: A tile to work at, or a floor cell to stand on.
        ready: Whether to interact once there, rather than wait for a soup.
    """

    cell: Position
    ready: bool = True


@dataclass(frozen=True)
class Job(Behaviour):
    """Does its errands one after the other, and something else while it has none.

    Attributes:
        errand: Finds the next errand, or None.
        manner: How it treats the other chef on its way.
        counters: The counters that it takes objects from or puts them on.
        item: The object that it fetches from a dispenser, if it fetches one kind only.
        then: What it does while it has no errand.
    """

    errand: "Finder"
    manner: Manner = "polite"
    counters: tuple[Position, ...] = ()
    item: str = "onion"
    then: Behaviour = FROZEN

    @property
    def sight(self) -> Sight:
        """Returns pots, its counters, what its manner depends on, and the sight of `then`."""
        return Sight(pots=True, counters=frozenset(self.counters)) | SIGHTS[self.manner] | self.then.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the cells of `then`."""
        return self.then.floor

    def phase(self, t: int) -> int:
        """Returns 0 or the phase of `then`: errands do not depend on the time."""
        return self.then.phase(t)

    def decide(self, scene: Scene) -> int:
        """Takes the next step of the errand."""
        errand = self.errand(self, scene)
        if errand is not None:
            return go(scene, self.manner, errand.cell, errand.ready)
        action = ask(self.then, scene, scene.time)
        return rest(scene, self.manner) if action == STAY else action


Finder = Callable[[Job, Scene], Errand | None]
"""A function that finds the next errand of a job."""


def carry(job: Job, scene: Scene) -> Errand | None:
    """Finishes with what it holds: puts an ingredient into a pot, plates a soup with a dish, serves a soup."""
    if scene.holding in ("onion", "tomato"):
        filled = {cell: n for cell, n in pots(scene) if isinstance(n, int) and n < MAX_INGREDIENTS}
        # The fullest of the nearest.
        cell = nearest(scene, job.manner, sorted(filled, key=lambda pot: -filled[pot]))
        return cell and Errand(cell)
    if scene.holding == "dish":
        ready = nearest(scene, job.manner, [cell for cell, what in pots(scene) if what == "ready"])
        if ready:
            return Errand(ready)
        cooking = nearest(scene, job.manner, [cell for cell, what in pots(scene) if what == "cooking"])
        return cooking and Errand(cooking, ready=False)
    if scene.holding == "soup":
        cell = nearest(scene, job.manner, scene.layout.positions("S"))
        return cell and Errand(cell)
    return None


def onions(job: Job, scene: Scene) -> Errand | None:
    """Fetches ingredients of its kind from the dispensers as long as a pot takes one."""
    if scene.holding is None and any(isinstance(n, int) and n < MAX_INGREDIENTS for _, n in pots(scene)):
        return fetch(job, scene, job.item)
    return carry(job, scene) if scene.holding == job.item else None


def plater(job: Job, scene: Scene) -> Errand | None:
    """Takes a dish once a soup is cooking, plates and serves."""
    if scene.holding is None and any(what in ("cooking", "ready") for _, what in pots(scene)):
        return fetch(job, scene, "dish")
    return carry(job, scene) if scene.holding in ("dish", "soup") else None


def receiver(job: Job, scene: Scene) -> Errand | None:
    """Takes ingredients that the pots can use, dishes and soups from its counters, and uses or serves them."""
    if scene.holding is not None:
        return carry(job, scene)
    cooked = [what for _, what in pots(scene)]
    useful = {"soup"} if scene.layout.positions("S") else set()
    if any(what in ("cooking", "ready") for what in cooked):
        useful.add("dish")
    if any(isinstance(n, int) and n < MAX_INGREDIENTS for n in cooked):
        useful |= {"onion", "tomato"}
    cell = nearest(scene, job.manner, [cell for cell in job.counters if scene.content(cell) in useful])
    return cell and Errand(cell)


def dumper(job: Job, scene: Scene) -> Errand | None:
    """Keeps fetching one kind of object and puts it on its counters, as long as they have room."""
    if scene.holding is not None:
        return lay(job, scene)
    return fetch(job, scene, job.item) if any(scene.content(cell) is None for cell in job.counters) else None


def lay(job: Job, scene: Scene) -> Errand | None:
    """Puts what it holds on one of its counters."""
    if scene.holding is None:
        return None
    cell = nearest(scene, job.manner, [cell for cell in job.counters if scene.content(cell) is None])
    return cell and Errand(cell)


@dataclass(frozen=True)
class Pace(Behaviour):
    """Walks from cell to cell in turn, by the clock; with one cell it goes there and stands still.

    Attributes:
        cells: Floor cells.
        every: Steps per cell.
        manner: How it treats the other chef on its way.
    """

    cells: tuple[Position, ...]
    every: int = 1
    manner: Manner = "polite"

    @property
    def sight(self) -> Sight:
        """Returns what its manner depends on."""
        return SIGHTS[self.manner]

    @property
    def floor(self) -> frozenset[Position]:
        """Its cells."""
        return frozenset(self.cells)

    def phase(self, t: int) -> int:
        """Returns the position in the round."""
        return t % (self.every * len(self.cells)) if len(self.cells) > 1 else 0

    def decide(self, scene: Scene) -> int:
        """Walks towards the cell whose turn it is."""
        return go(scene, self.manner, self.cells[scene.time // self.every], interact=False)


def pots(scene: Scene) -> list[tuple[Position, Content]]:
    """Lists the pots in sight with their content."""
    return [(cell, what) for cell, what in scene.contents if scene.layout.tile(cell) == "P"]


def fetch(job: Job, scene: Scene, item: str) -> Errand | None:
    """Goes to the nearest dispenser of an object."""
    tiles = {"onion": "O", "tomato": "T", "dish": "D"}[item]
    cell = nearest(scene, job.manner, scene.layout.positions(tiles))
    return cell and Errand(cell)

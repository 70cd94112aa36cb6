"""Does whatever is most useful next, including handing objects over to another part of the kitchen."""

from collections.abc import Sequence
from functools import lru_cache

from overcooked_bench.agents.behaviours.behaviour import Content, Scene
from overcooked_bench.agents.behaviours.jobs import Errand, Job, carry, fetch, pots
from overcooked_bench.agents.behaviours.walking import distance, nearest
from overcooked_bench.agents.planner.tables import FAR
from overcooked_bench.kitchen.codes import DIRECTIONS, MAX_INGREDIENTS, Position
from overcooked_bench.kitchen.layout import Layout


def helper(job: Job, scene: Scene) -> Errand | None:
    """Fills pots, plates and serves, with objects from dispensers or its counters; hands over what it cannot use.

    It hands over on one of its counters that another part of the kitchen reaches too.
    """
    if scene.holding is None:
        return _take(job, scene)
    errand = carry(job, scene)
    if errand or _reached(job, scene, "P" if scene.holding != "soup" else "S"):
        return errand
    return _at(nearest(scene, job.manner, [cell for cell in _shared(job, scene) if scene.content(cell) is None]))


def _take(job: Job, scene: Scene) -> Errand | None:
    soups = [cell for cell in job.counters if scene.content(cell) == "soup"]
    if soups and _reached(job, scene, "S"):
        return _at(nearest(scene, job.manner, soups))
    cooks, inside = _reached(job, scene, "P"), [what for _, what in pots(scene)]
    shared = [scene.content(cell) for cell in _shared(job, scene)]
    if not cooks and None not in shared:
        return None
    takes = any(isinstance(what, int) and what < MAX_INGREDIENTS for what in inside)
    dish = "ready" in inside or ("cooking" in inside and not takes)
    if not cooks and dish and "dish" in shared:
        dish = False
    if dish:
        return _nearest_of(job, scene, "dish", cooks) or (_nearest_of(job, scene, "onion", cooks) if takes else None)
    return _nearest_of(job, scene, "onion", cooks) if takes else None


def _nearest_of(job: Job, scene: Scene, item: Content, cooks: bool) -> Errand | None:
    """Returns the nearest dispenser or counter with an object; objects that it handed over are not taken back."""
    kept = set() if cooks else set(_shared(job, scene))
    found = [cell for cell in job.counters if scene.content(cell) == item and cell not in kept]
    dispenser = fetch(job, scene, str(item))
    return _at(nearest(scene, job.manner, found + ([dispenser.cell] if dispenser else [])))


def _at(cell: Position | None) -> Errand | None:
    return None if cell is None else Errand(cell)


def _reached(job: Job, scene: Scene, tile: str) -> bool:
    return any(distance(scene, "insist", cell) < FAR for cell in scene.layout.positions(tile))


def _shared(job: Job, scene: Scene) -> Sequence[Position]:
    between = _between(scene.layout)
    return [cell for cell in job.counters if cell in between and distance(scene, "insist", cell) < FAR]


@lru_cache(64)
def _between(layout: Layout) -> frozenset[Position]:
    """Lists the counters that two separate parts of the floor reach."""

    def beside(x: int, y: int) -> set[int]:
        return {layout.regions[x + dx, y + dy] for dx, dy in DIRECTIONS if (x + dx, y + dy) in layout.regions}

    return frozenset(cell for cell in layout.positions("X") if len(beside(*cell)) > 1)

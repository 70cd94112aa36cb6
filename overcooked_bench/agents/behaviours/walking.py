"""Moves scripted partners: they insist on their way, go around the other chef, or yield to it."""

from collections.abc import Iterable
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.behaviours.behaviour import Scene, Sight
from overcooked_bench.agents.planner.tables import BESIDE, FAR, NEXT, LayoutTables, make_tables
from overcooked_bench.kitchen.codes import ACTION_NAMES, DIRECTIONS, INTERACT, STAY, Position

Manner = Literal["insist", "polite", "yield"]
"""How a scripted partner treats the other chef: as if it were not there, as an obstacle, or as going first."""

SIGHTS: Final[dict[Manner, Sight]] = {
    "insist": Sight(),
    "polite": Sight(partner=True),
    "yield": Sight(partner=True, partner_facing=True),
}
"""What each manner depends on."""


def distance(scene: Scene, manner: Manner, cell: Position) -> int:
    """Returns the steps to a floor cell, or to the nearest one next to a tile; FAR or more if there is no way now."""
    plan, width = make_tables(scene.layout), scene.layout.width
    here, there = _index(scene.position, width), _index(cell, width)
    steps = int(plan.ways[here, there])
    if manner == "insist" or scene.partner is None:
        return steps
    around = int(_around(plan, scene)[here, there])
    return around if around < FAR else FAR + steps


def nearest(scene: Scene, manner: Manner, cells: Iterable[Position]) -> Position | None:
    """Returns the nearest of some cells, the first one of a tie, or None if none can ever be reached."""
    ranked = [(distance(scene, manner, cell), number, cell) for number, cell in enumerate(cells)]
    steps, _, cell = min(ranked, default=(2 * FAR, 0, None))
    return cell if steps < 2 * FAR and not (manner == "insist" and steps >= FAR) else None


def go(scene: Scene, manner: Manner, goal: Position, interact: bool) -> int:
    """Returns the next action on the way to a cell.

    Args:
        scene: What the behaviour sees.
        manner: How to treat the other chef. If there is no way around it, go up to it and wait.
        goal: A floor cell to stand on, or a tile to face.
        interact: Whether to interact with the tile once it is faced.
    """
    plan, width = make_tables(scene.layout), scene.layout.width
    here, there = _index(scene.position, width), _index(goal, width)
    partner = -1 if scene.partner is None or manner == "insist" else _index(scene.partner, width)
    if manner == "yield" and _is_asked(scene):
        return _aside(plan, here, partner)
    for direction in range(len(DIRECTIONS)):
        if plan.grid[BESIDE + direction, here] == there:
            if scene.facing != ACTION_NAMES[direction]:
                return direction
            return INTERACT if interact else STAY
    ways = plan.ways if partner < 0 else _around(plan, scene)
    if ways[here, there] >= FAR:
        ways = plan.ways
    for direction in range(len(DIRECTIONS)):
        n = plan.grid[NEXT + direction, here]
        if n >= 0 and n != partner and ways[n, there] < ways[here, there]:
            return direction
    return STAY


def rest(scene: Scene, manner: Manner) -> int:
    """Returns the action of a chef that has nothing to do: it stands still, or yields."""
    if manner == "yield" and _is_asked(scene) and scene.partner is not None:
        width = scene.layout.width
        return _aside(make_tables(scene.layout), _index(scene.position, width), _index(scene.partner, width))
    return STAY


def _is_asked(scene: Scene) -> bool:
    """Returns whether the other chef is in front and faces this chef."""
    if scene.partner is None or scene.partner_facing is None:
        return False
    dx, dy = DIRECTIONS[ACTION_NAMES.index(scene.partner_facing)]
    return (scene.partner[0] + dx, scene.partner[1] + dy) == scene.position


def _aside(plan: LayoutTables, here: int, partner: int) -> int:
    """Returns the step to the free cell that is farthest from the other chef; sideways in a tie."""
    best, action = 0, STAY
    for direction in range(len(DIRECTIONS)):
        n = plan.grid[NEXT + direction, here]
        if n >= 0 and n != partner and plan.ways[partner, n] > best:
            best, action = int(plan.ways[partner, n]), direction
    return action


def _around(plan: LayoutTables, scene: Scene) -> NDArray[np.int64]:
    assert scene.partner is not None
    ways: NDArray[np.int64] = plan.around[_index(scene.partner, scene.layout.width) if len(plan.around) > 1 else 0]
    return ways


def _index(cell: Position, width: int) -> int:
    return cell[1] * width + cell[0]

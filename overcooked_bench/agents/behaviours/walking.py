"""How a scripted partner gets somewhere: it insists on its way, goes round the other chef, or gives way to it."""

from collections.abc import Iterable
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.behaviours.behaviour import Scene, Sight
from overcooked_bench.agents.planner.tables import BESIDE, FAR, NEXT, LayoutTables, make_tables
from overcooked_bench.kitchen.codes import ACTION_NAMES, DIRECTIONS, INTERACT, STAY, Position

Manner = Literal["insist", "polite", "yield"]
"""Whether the other chef counts as air, as an obstacle, or as one who goes first."""

SIGHTS: Final[dict[Manner, Sight]] = {
    "insist": Sight(),
    "polite": Sight(mate=True),
    "yield": Sight(mate=True, mate_facing=True),
}
"""What each manner looks at."""


def distance(scene: Scene, manner: Manner, cell: Position) -> int:
    """Gives the steps to a floor cell, or to the nearest one beside a tile; FAR and more where none leads there now."""
    plan, width = make_tables(scene.layout), scene.layout.width
    here, there = _index(scene.position, width), _index(cell, width)
    steps = int(plan.ways[here, there])
    if manner == "insist" or scene.mate is None:
        return steps
    around = int(_around(plan, scene)[here, there])
    return around if around < FAR else FAR + steps


def nearest(scene: Scene, manner: Manner, cells: Iterable[Position]) -> Position | None:
    """Gives the nearest of some cells, the first of equals, or None where none can ever be reached."""
    ranked = [(distance(scene, manner, cell), number, cell) for number, cell in enumerate(cells)]
    steps, _, cell = min(ranked, default=(2 * FAR, 0, None))
    return cell if steps < 2 * FAR and not (manner == "insist" and steps >= FAR) else None


def go(scene: Scene, manner: Manner, goal: Position, interact: bool) -> int:
    """Gives the next action on the way to a cell.

    Args:
        scene: What is seen.
        manner: How to treat the other chef. Where there is no way round it, one goes up to it and waits.
        goal: A floor cell to stand on, or a tile to face.
        interact: Whether to interact with the tile once it is faced.
    """
    plan, width = make_tables(scene.layout), scene.layout.width
    here, there = _index(scene.position, width), _index(goal, width)
    mate = -1 if scene.mate is None or manner == "insist" else _index(scene.mate, width)
    if manner == "yield" and _is_asked(scene):
        return _aside(plan, here, mate)
    for direction in range(len(DIRECTIONS)):
        if plan.grid[BESIDE + direction, here] == there:
            if scene.facing != ACTION_NAMES[direction]:
                return direction
            return INTERACT if interact else STAY
    ways = plan.ways if mate < 0 else _around(plan, scene)
    if ways[here, there] >= FAR:
        ways = plan.ways
    for direction in range(len(DIRECTIONS)):
        n = plan.grid[NEXT + direction, here]
        if n >= 0 and n != mate and ways[n, there] < ways[here, there]:
            return direction
    return STAY


def rest(scene: Scene, manner: Manner) -> int:
    """Gives the action of one who has nothing to do: it stands, or gives way."""
    if manner == "yield" and _is_asked(scene) and scene.mate is not None:
        width = scene.layout.width
        return _aside(make_tables(scene.layout), _index(scene.position, width), _index(scene.mate, width))
    return STAY


def _is_asked(scene: Scene) -> bool:
    """Tells whether the other chef stands before one and looks at one."""
    if scene.mate is None or scene.mate_facing is None:
        return False
    dx, dy = DIRECTIONS[ACTION_NAMES.index(scene.mate_facing)]
    return (scene.mate[0] + dx, scene.mate[1] + dy) == scene.position


def _aside(plan: LayoutTables, here: int, mate: int) -> int:
    """Gives the step to the free cell that is farthest from the other chef; sideways where that is the same."""
    best, action = 0, STAY
    for direction in range(len(DIRECTIONS)):
        n = plan.grid[NEXT + direction, here]
        if n >= 0 and n != mate and plan.ways[mate, n] > best:
            best, action = int(plan.ways[mate, n]), direction
    return action


def _around(plan: LayoutTables, scene: Scene) -> NDArray[np.int64]:
    assert scene.mate is not None
    ways: NDArray[np.int64] = plan.around[_index(scene.mate, scene.layout.width) if len(plan.around) > 1 else 0]
    return ways


def _index(cell: Position, width: int) -> int:
    return cell[1] * width + cell[0]

"""Scenario files for the tests."""

from overcooked_bench.scenarios.language.loading import read_scenario
from overcooked_bench.scenarios.scenario import Scenario

YIELD = """\
id: T01-yield
category: convention
layout: coordination_ring
kitchen: |
  XXXPX
  X BAP
  D X X
  O   X
  XOSXX
A: {facing: up}
B: {facing: right, holds: onion, does: carry, insist: true}
pots: {1: 2 onions}
accept: B.pot >= 1 and A.holds(dish)
budget: 15
why: A stands in the way.
"""

POT = """\
id: T02-pot
category: state
layout: cramped_room
kitchen: |
  XXPXX
  O A O
  X  BX
  XDXSX
A: {facing: up, holds: onion}
B: {facing: down, does: frozen}
accept: A.pot >= 1
budget: 3
why: One step is enough.
"""


def scenario(text: str = POT, **changes: str) -> Scenario:
    """A scenario with some of its one-line keys written anew; an empty text takes the key out."""
    return read_scenario(edited(text, **changes), "test.yaml")


def edited(text: str = POT, **changes: str) -> str:
    lines = text.splitlines()
    for key, value in changes.items():
        at = next((i for i, line in enumerate(lines) if line.startswith(f"{key}:")), None)
        if at is not None:
            del lines[at]
        if value:
            lines.insert(len(lines) if at is None else at, f"{key}: {value}")
    return "\n".join(lines) + "\n"

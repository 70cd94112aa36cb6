"""Writes a first scenario: a file that works, with every key explained."""

from typing import Final

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Chef, KitchenState
from overcooked_bench.scenarios.language.picture import draw_picture

_TEXT: Final = """\
{id:<36}# the file's name without .scenario.yaml
{category:<36}# state, partner, memory, convention or horizon
{layout}
kitchen: |                          # A is tested, B its partner; on counters: o onion, d dish, s soup
{picture}
A: {{facing: down, holds: onion}}     # up, down, left or right; onion, dish or soup, or no `holds` at all
B: {{facing: down, does: frozen}}     # frozen, carry, onions, plater, goto, ...
# pots: {{1: 2 onions}}               # in reading order: `2 onions`, `cooking 8 left` or `ready`
accept: A.pot >= 1                  # what has to hold within the budget
# never: A.drop >= 1                # what must not hold before that
why: A holds an onion, the pot is empty, and B does nothing; A has to go and use it.
"""


def template(name: str, layout: str, category: str) -> str:
    """Writes a file that `read_scenario` reads.

    Args:
        name: The scenario's id.
        layout: A shipped layout's name.
        category: One of `CATEGORIES`.

    Raises:
        LayoutError: There is no such layout.
    """
    plan = Layout.load(layout)
    cells = plan.start_cells or plan.positions(" ")
    state = KitchenState((Chef(cells[0], "south"), Chef(cells[1], "south")), {})
    picture = "\n".join(f"  {row}" for row in draw_picture(plan, state, 0).split("\n"))
    keys = {"id": f"id: {name}", "category": f"category: {category}", "layout": f"layout: {layout}"}
    return _TEXT.format(**keys, picture=picture)

"""What people or agents do in their games, as tables."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.human.conduct import PER, Conduct
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tracks.ring import STRETCH
from overcooked_bench.rendering.table import Column, Table

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

RARE: Final = 0.1
"""Hand-overs of an object over a counter, per 400 steps, below which the table and the picture leave them out."""

_EVENTS: Final = {
    "ingredients": "food\ntaken",
    "dishes": "dishes\ntaken",
    "pots": "into\npots",
    "starts": "pots\nstarted",
    "plates": "soups\nplated",
    "deliveries": "soups\nserved",
    "counter_drops": "put\ndown",
    "counter_pickups": "picked\nup",
}
"""Events of `ChefConduct` -> the heading of their column."""

NOTE: Final = (
    f"Soups, hand-overs and events: per {PER} steps. In brackets: 95 % over pairs of people. Idle: share of the "
    "actions that are stay. Stuck: share of the steps in which the action is a direction, but the chef neither moves "
    "nor turns. Clockwise: share of the way around the kitchen's middle, as seen from above; to and fro within "
    f"{STRETCH} steps cancels out. Food and dishes: out of a dispenser; put down and picked up: on counters. "
    "Hand-over: one chef puts an object on a counter, and the other is the next to pick it up; counters and objects "
    f"with fewer than {RARE} are not listed."
)


def summary(found: Sequence[Conduct]) -> Table:
    """One row per layout: how much there is, soups, idle share, hand-overs and walking."""
    numbers = [Column(name, wrap=False) for name in ("soups", "idle, %", "hand-overs", "clockwise, %")]
    return Table(
        [Column("layout", left=True, wrap=False), "games", "pairs", "steps", *numbers],
        [
            [
                *(name(one.layout), str(one.games), str(one.pairs or "-"), f"{one.steps:,}", one.soups.text(1)),
                *(percent(one.idle), f"{one.hand_overs.value:.1f}", percent(one.clockwise)),
            ]
            for one in found
        ],
    )


def events(found: Sequence[Conduct]) -> Table:
    """One row per layout and chef: shares of its steps, and what it does per 400 steps."""
    shown = [key for key in _EVENTS if any(chef.events[key] for one in found for chef in one.chefs)]
    heads = "chef", "idle\n%", "stuck\n%", *(_EVENTS[key] for key in shown), "handed\nover"
    return Table(
        [Column("layout", left=True, wrap=False), *heads],
        [
            [
                *("" if seat else name(one.layout), str(seat)),
                *(f"{100 * chef.idle:.0f}", f"{100 * chef.stuck:.1f}"),
                *(f"{chef.events[key]:.1f}" for key in shown),
                f"{chef.hands_over:.1f}",
            ]
            for one in found
            for seat, chef in enumerate(one.chefs)
        ],
    )


def hand_overs(found: Sequence[Conduct]) -> Table:
    """One row per counter and object that changes hands there, without rare ones."""
    rows = []
    for one in found:
        frequent = [entry for entry in one.handed if sum(entry.rates) >= RARE]
        for row, entry in enumerate(frequent):
            x, y = entry.counter
            cells = f"({x}, {y})", entry.item, f"{100 * entry.share:.0f} %", *(f"{rate:.1f}" for rate in entry.rates)
            rows.append([name(one.layout) if not row else "", *cells])
    columns = [Column("counter (x, y)", left=True, wrap=False), Column("object", left=True, wrap=False)]
    return Table(["layout", *columns, "share", "by chef 0", "by chef 1"], rows)


def conduct_tables(found: Sequence[Conduct]) -> "Group":
    """Lays games out for the terminal: what is done on each layout, by each chef, and over which counters."""
    from rich.console import Group
    from rich.text import Text

    parts: list[RenderableType] = [summary(found).terminal(), Text(""), events(found).terminal(), Text("")]
    handed = hand_overs(found)
    if handed.rows:
        parts += [handed.terminal(), Text("")]
    return Group(*parts, Text(NOTE, style="dim"))


def name(layout: str) -> str:
    """Returns a layout's name for a table, a grid's size if it has none."""
    if "\n" not in layout:
        return layout
    plan = Layout.named(layout)
    return f"a grid, {plan.width} x {plan.height}"


def percent(share: Estimate | None) -> str:
    """Writes a share in percent with its interval."""
    if share is None:
        return "-"
    scaled = [None if number is None else 100 * number for number in share]
    return Estimate(100 * share.value, *scaled[1:]).text(0)

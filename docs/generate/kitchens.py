"""A page for each shipped layout: grid, rules, what is reached on it, and whether it separates agents."""

from collections.abc import Iterator
from typing import Final, NamedTuple

from PIL import Image

from docs.generate.measured import LayoutNumbers, reached, standings
from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import find_pool, shipped_pools
from overcooked_bench.envs.registration import env_id
from overcooked_bench.kitchen.codes import RECIPES, TILE_NAMES, Recipe
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout, layout_names
from overcooked_bench.rendering.picture import draw
from overcooked_bench.rendering.table import Column, Table
from overcooked_bench.scenarios.items import load_scenarios

CHALLENGE: Final = {
    "cramped_room": "Both chefs can do everything, and get into each other's way.",
    "asymmetric_advantages": "Each chef can cook alone in a room of its own, and the rooms differ in what is near.",
    "coordination_ring": "Both chefs have to walk around the same ring in the same direction.",
    "forced_coordination": "Neither chef can cook alone: one hands onions and dishes over, the other cooks and serves.",
    "counter_circuit": "The way around is long; the middle counters are a shorter way for two that use them together.",
    "bottleneck": "A corridor of one cell is between the ingredients and the pots.",
}
"""What is hard about a layout; a new one needs no line here."""

_CARROLL: Final = "One of the five kitchens of Carroll et al. 2019, whose code calls it `{}`; the grid is the same."
ORIGINS: Final = {
    "cramped_room": _CARROLL.format("simple"),
    "asymmetric_advantages": _CARROLL.format("unident_s"),
    "coordination_ring": _CARROLL.format("random1"),
    "forced_coordination": _CARROLL.format("random0"),
    "counter_circuit": _CARROLL.format("random3"),
    "bottleneck": "The grid is that of overcooked_ai's layout of this name.",
}
"""Where a layout comes from, if it is not of this project."""

_INDEX: Final = """# Kitchens

The best known return is the highest mean on record, in points per episode of 400 steps from random start cells: in a
manifest of a shipped pool, or of a [reference entry](../results/v1-entries.md). A kitchen *separates* agents if the
95 % intervals of N of two reference entries that were trained several times do not overlap there.

{table}

A grid of your own is a kitchen, too: `gymnasium.make("overcooked_bench:Overcooked/Custom-v0", layout=grid)`, and
`overcooked-bench score AGENT --protocol FILE` with a protocol that lists its file.

```{{toctree}}
:hidden:

{pages}
```
"""

_PAGE: Final = """# {name}

{challenge}

```{{image}} {name}.png
:alt: The kitchen {name} at its standard start; chef 0 is blue, chef 1 orange
:width: {width}px
```

```text
{grid}
```

`gymnasium.make("overcooked_bench:{env}")`; the mirror image is the layout `{name}-mirrored`.

## Rules

{rules}

## Regions

{regions}

## What is reached here

{reached}

## Does it separate agents?

{separates}

## History

{history}
"""


class Kitchen(NamedTuple):
    """What the pages say about a layout.

    Attributes:
        layout: The layout.
        numbers: What was measured on it.
    """

    layout: Layout
    numbers: LayoutNumbers


def pages() -> Iterator[tuple[str, str]]:
    """Yields each page and its text."""
    kitchens = [Kitchen(Layout.load(name), reached(name)) for name in layout_names()]
    heads = ("cells", "regions", "best known return", "separates agents")
    columns = [Column("kitchen", left=True), *map(Column, heads)]
    rows = [
        (
            f"[{layout.name}]({layout.name}.md)",
            f"{layout.width} x {layout.height}",
            str(1 + max(layout.regions.values())),
            f"{numbers.best.points:.1f}" if numbers.best else "-",
            _answer(layout.name),
        )
        for layout, numbers in kitchens
    ]
    names = "\n".join(layout_names())
    yield "kitchens/index.md", _INDEX.format(table=Table(columns, rows).markdown(), pages=names)
    for kitchen in kitchens:
        yield f"kitchens/{kitchen.layout.name}.md", _page(kitchen)


def pictures() -> Iterator[tuple[str, Image.Image]]:
    """Yields the path of each picture below `docs`, and the picture."""
    for name in layout_names():
        kitchen = Kitchens(name, 1, start="standard")
        kitchen.reset(seed=0)
        yield f"kitchens/{name}.png", Image.fromarray(draw(kitchen.layout, kitchen.state(0), tile_size=96))


def _page(kitchen: Kitchen) -> str:
    layout, name = kitchen.layout, kitchen.layout.name
    return _PAGE.format(
        name=name,
        challenge=CHALLENGE.get(name, "A kitchen of two chefs."),
        width=48 * layout.width,
        grid=layout.text,
        env=env_id(name),
        rules=_rules(layout),
        regions=_regions(layout),
        reached=_reached(kitchen),
        separates=_separates(name),
        history=_history(name),
    )


def _rules(layout: Layout) -> str:
    tiles = [f"{len(found)} x {TILE_NAMES[letter]}" for letter in "POTDS" if (found := layout.positions(letter))]
    orders = [_order(layout, recipe) for recipe in layout.orders]
    return "\n".join(
        [
            f"- Tiles: {', '.join(tiles)}; {len(layout.positions(' '))} floor cells.",
            f"- Orders: {'; '.join(orders)}.",
            '- With `cooking="auto"`, the default, a pot starts by itself at the third ingredient; with `"manual"`, an '
            "empty-handed interact starts it.",
            f"- Standard start cells, (x, y) from the top left: chef 0 {layout.start_cells[0]}, "
            f"chef 1 {layout.start_cells[1]}, both looking north. Scores use random start cells.",
        ]
    )


def _order(layout: Layout, recipe: Recipe) -> str:
    index = RECIPES.index(recipe)
    named = [
        f"{count} {what}{'s' * (count > 1)}" for count, what in zip(recipe, ("onion", "tomato"), strict=True) if count
    ]
    points, steps = layout.soup_rewards[index], layout.cook_times[index]
    return f"a soup of {' and '.join(named)}, {points:g} points, cooked for {steps} steps"


def _regions(layout: Layout) -> str:
    sizes: dict[int, int] = {}
    for region in layout.regions.values():
        sizes[region] = sizes.get(region, 0) + 1
    if len(sizes) == 1:
        return "The floor is one region: both chefs can reach every floor cell."
    starts = [layout.regions[cell] for cell in layout.start_cells]
    cells = " and ".join(str(sizes[one]) for one in sorted(sizes))
    return (
        f"The floor has {len(sizes)} separate regions, of {cells} cells, counted from the top left. Random starts put "
        f"one chef into each. At the standard start chef 0 is in region {starts[0]}, chef 1 in region {starts[1]}."
    )


def _reached(kitchen: Kitchen) -> str:
    numbers = kitchen.numbers
    lines = []
    if numbers.best:
        best = numbers.best
        lines.append(f"Best known return: **{best.points:.1f}** points per episode, by {best.who}.")
    if numbers.ceilings:
        low, middle, high = numbers.ceilings
        lines.append(
            "With the partners of the pool `v1`, the best known responder reaches "
            f"{low:.0f} / {middle:.0f} / {high:.0f} points per episode (lowest / median / highest over partners and "
            "sides). The better of `stay` and `random` reaches "
            f"{' / '.join(f'{value:.0f}' for value in numbers.floors)}."
        )
    if numbers.self_play:
        low, high, count, pool = numbers.self_play
        lines.append(
            f"The {count} fully trained agents of `{pool}` reach {low:.0f} to {high:.0f} points per episode with a "
            "copy of themselves."
        )
    if not lines:
        lines.append("No shipped pool has partners for this kitchen yet, so no best known return is recorded.")
    count = sum(scenario.layout.name == kitchen.layout.name for scenario in load_scenarios())
    lines.append(f"{count} [scenarios](../unit-tests.md) take place here.")
    return "\n\n".join(lines)


def _separates(name: str) -> str:
    entries = standings(name)
    if not entries:
        return "Not measured: no protocol scores agents here."
    rows = [(f"`{entry.name}`", str(entry.training_seeds), entry.n) for entry in entries]
    table = Table([Column("entry", left=True), "training seeds", "N [95 %]"], rows).markdown()
    return f"{_answer(name).capitalize()}: {_WHY[_answer(name)]}\n\n{table}"


_WHY: Final = {
    "yes": "the intervals of N of two of these entries, each trained several times, do not overlap.",
    "no": "the intervals of N of all entries that were trained several times overlap.",
}


def _answer(name: str) -> str:
    trained = [entry.interval for entry in standings(name) if entry.training_seeds > 1]
    if not trained:
        return "-"
    return "yes" if max(low for low, _ in trained) > min(high for _, high in trained) else "no"


def _history(name: str) -> str:
    pools = [pool for pool in shipped_pools() if any(e.layout == name for e in read_manifest(find_pool(pool)).entries)]
    first = f"- `{env_id(name)}`: first version. The dynamics of `-v0` never change."
    played = f"- Pools with partners for it: {', '.join(f'[{pool}](../partners/{pool}.md)' for pool in pools)}."
    origin = f"- {ORIGINS.get(name, 'A layout of this project.')}"
    return "\n".join([origin, first, *([played] if pools else [])])

"""The recipe of many entries: `configs/rows/<name>.yaml`, one row for each.

A row is written like a group of a pool's configuration, and its prefix is the entry's name. Each entry has a namespace
of its own, `entries-<name>`, so that it shares no seed and no lineage with a pool or another entry.
"""

from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import check_name, read_text
from overcooked_bench.shelf import Shelf

from ..building.config import PoolConfig, Run
from ..building.groups import Group


class RecipeError(WrongUse):
    """A recipe cannot be found or read; names the file and the key."""


_SHELF: Final = Shelf("recipe", "overcooked_bench.baselines", ".yaml", RecipeError, "a YAML file", "configs/rows")


class _Recipe(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a recipe's file holds."""

    layouts: tuple[str, ...]
    rows: tuple[Group, ...]


def load_recipe(source: str | Path) -> list[PoolConfig]:
    """Reads a recipe and checks the settings of every run.

    Args:
        source: A shipped recipe's name, or a YAML file.

    Returns:
        The configuration of each entry, in the order of the file.

    Raises:
        RecipeError: No such recipe, or something in it is wrong.
        PoolConfigError: The settings of a run are wrong.
    """
    document = parse_yaml(read_text(_SHELF.find(source), LONGEST, raises=RecipeError), str(source), RecipeError)
    recipe = document.convert(_Recipe)
    names = [row.prefix for row in recipe.rows]
    if len(set(names)) < len(names) or not names:
        raise document.error(("rows",), f"rows are {', '.join(names) or 'none'}; give one at least, each prefix once")
    found = []
    for row in recipe.rows:
        check_name(row.prefix, f"{source}: the key `prefix`", RecipeError)
        try:
            config = PoolConfig(
                name=row.prefix, namespace=f"entries-{row.prefix}", layouts=recipe.layouts, groups=(row,)
            )
        except ValueError as error:
            raise document.error(("rows", names.index(row.prefix)), str(error)) from None
        for run in config.runs():
            _ = run.settings
        found.append(config)
    return found


def in_turn(entries: list[PoolConfig]) -> list[Run]:
    """Lists the runs of all entries: the first one of each on every layout, then the second, and so on.

    Wherever training is stopped, entries have equal numbers of training seeds, or nearly so.
    """
    most = max(entry.groups[0].most for entry in entries)
    return [run for index in range(most) for entry in entries for run in entry.runs() if run.index == index]

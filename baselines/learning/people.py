"""The people behind an agent: those whose recorded games it, or a partner that it trained with, was made from."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from overcooked_bench.agents.pools.manifest import people_of, read_manifest
from overcooked_bench.agents.pools.pool import find_pool, is_pool
from overcooked_bench.kitchen.layout import Layout

from ..running.place import CONFIG_FILE, read_record


def people_behind(references: Iterable[str], layout: str) -> tuple[str, ...]:
    """Finds the people behind some agents, as far as their pools and training runs say.

    Args:
        references: Pools, and whatever else `find` takes; an agent of a pool, or a policy file in a pool or in the
            folder of its run, says who is behind it. Nothing is known of other agents.
        layout: The layout that they play, as `Layout.load` takes it.

    Raises:
        PoolError: A pool is damaged.
        CheckpointError: The configuration in a run's folder is damaged.
    """
    return tuple(sorted({person for reference in references for person in _behind(str(reference), layout)}))


def _behind(reference: str, layout: str) -> Iterable[str]:
    if is_pool(reference):
        return people_of(read_manifest(find_pool(reference)), Layout.load(layout).name)
    file = Path(reference)
    is_file = file.suffix in (".safetensors", ".json")
    pool, *rest = (file.with_suffix("").as_posix() if is_file else reference).rsplit("/", 2)
    if len(rest) == 2 and is_pool(pool):
        home, name = rest[0].replace("{layout}", Layout.load(layout).name), rest[1]
        entries = read_manifest(find_pool(pool)).entries
        return [one for entry in entries if (entry.layout, entry.name) == (home, name) for one in entry.people or ()]
    return _of_run(file) if is_file else ()


def _of_run(file: Path) -> Iterable[str]:
    """Reads what the run of a policy says; clones and snapshots are in a folder inside the run's."""
    for folder in (file.parent, file.parent.parent):
        if (config := read_record(folder / CONFIG_FILE, dict[str, Any])) is not None:
            known = config.get("people")
            return map(str, known) if isinstance(known, list) else ()
    return ()

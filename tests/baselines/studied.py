"""A study of two runs per group, and protocols of a few steps."""

import msgspec

from overcooked_bench.agents.policies.policy import policy_files
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.protocol import load_protocol


def write_study(folder, layouts=("cramped_room",)):
    """Writes a pool with the names of the study's, of agents of dev-v1."""
    source, entries = Pool.load("dev-v1"), []
    for layout in layouts:
        names = ["with-people-0", "with-people-1", "with-population-0", "with-population-1"]
        for name, entry in zip(names, source.agents(layout), strict=False):
            pair = zip(
                policy_files(source.folder / layout / entry.name), policy_files(folder / layout / name), strict=True
            )
            for old, new in pair:
                new.parent.mkdir(parents=True, exist_ok=True)
                new.write_bytes(old.read_bytes())
            entries.append(msgspec.structs.replace(entry, name=name, reference=None))
    write_manifest(folder, "human-study", entries)
    return folder


def protocols(layouts=("cramped_room",), **others):
    """Returns dev with few and short episodes, once for each kind of start."""
    dev = load_protocol("dev")
    given = {"layouts": layouts, "episodes": 2, "horizon": 30, **others}
    plays = [msgspec.structs.replace(dev.play, start=start, **given) for start in ("random", "standard")]
    return [msgspec.structs.replace(dev, name=f"people-{play.start}", play=play) for play in plays]

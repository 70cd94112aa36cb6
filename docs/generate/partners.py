"""A card for each shipped pool, from its manifest."""

import re
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from statistics import median
from typing import Any, Final

from overcooked_bench.agents.pools.manifest import people_of, read_manifest
from overcooked_bench.agents.pools.pool import find_pool, shipped_pools
from overcooked_bench.agents.pools.records import Entry, Manifest
from overcooked_bench.rendering.table import Column, Table

PURPOSES: Final = {
    "v1": "Scores agents (protocol `v1`). **Do not train, tune or select with it.**",
    "train-v1": "A population to train against, such as fictitious co-play does.",
    "dev-v1": "Selection and tuning: choose hyperparameters and checkpoints with it.",
    "dev-v0": "The first pool; the protocol `dev` plays it, for trying things out.",
    "human-train": "People to train with: clones of recorded people, and proxies that learned to earn more.",
    "human-test": "People to be judged by (protocol `people`). **Never train, tune or select with it.**",
}
"""What a pool is for, in the order of the list; a new pool needs no line here."""

_INDEX: Final = """# Partners

A pool is a folder of frozen partners with a manifest that hashes every file; see [](../training.md#pools). Each card
was written from the manifest.

{table}

```{{toctree}}
:hidden:

{pages}
```
"""

_PAGE: Final = """# {name}

{purpose}

- {counts}
- Cooking `{cooking}`, actions chosen by `{mode}`; {state}.
- Hash `{hash}`.
- Made from recorded games of: {people}.
- Check it: `overcooked-bench pool verify {name}`. See it: `overcooked-bench pool show {name}`.

## How they were made

One line for the partners that were made in the same way; N stands for a number. Steps are joint steps, in which both
chefs act, up to the frozen policy; with several values, the lowest and the highest.

{made}

## How they play

Points per episode of 400 steps with a copy of itself; the lowest, the median and the highest of the fully trained
partners.

{returns}
"""


def pages() -> Iterator[tuple[str, str]]:
    """Yields each page and its text."""
    manifests = [read_manifest(find_pool(name)) for name in shipped_pools()]
    known = [*PURPOSES]
    manifests.sort(key=lambda one: known.index(one.name) if one.name in known else len(known))
    rows = [(f"[{one.name}]({one.name}.md)", _purpose(one), _counts(one), one.hash[:8]) for one in manifests]
    columns = [Column(name, left=True) for name in ("pool", "what it is for", "partners", "hash")]
    names = "\n".join(one.name for one in manifests)
    yield "partners/index.md", _INDEX.format(table=Table(columns, rows).markdown(), pages=names)
    for manifest in manifests:
        yield f"partners/{manifest.name}.md", _page(manifest)


def _page(manifest: Manifest) -> str:
    text = _PAGE.format(
        name=manifest.name,
        purpose=_purpose(manifest),
        counts=_counts(manifest) + ".",
        cooking=manifest.cooking,
        mode=manifest.mode,
        state="frozen: it never changes" if manifest.frozen else "a release candidate: its partners may still change",
        hash=manifest.hash,
        people=", ".join(f"`{name}`" for name in people_of(manifest)) or "nobody",
        made=_made(manifest),
        returns=_returns(manifest),
    )
    return "\n".join([text.rstrip(), *_conventions(manifest), *_bounds(manifest)]) + "\n"


def _purpose(manifest: Manifest) -> str:
    return PURPOSES.get(manifest.name, "A shipped pool.")


def _layouts(manifest: Manifest) -> dict[str, list[Entry]]:
    found: dict[str, list[Entry]] = {}
    for entry in manifest.entries:
        found.setdefault(entry.layout, []).append(entry)
    return found


def _counts(manifest: Manifest) -> str:
    roles = Counter(entry.role for entry in manifest.entries)
    layouts = len(_layouts(manifest))
    floors = f" and {roles['floor']} floors" if roles["floor"] else ""
    return f"{roles['partner']} partners{floors} on {layouts} layouts"


def _made(manifest: Manifest) -> str:
    groups: dict[tuple[str, ...], list[Entry]] = {}
    for entry in manifest.entries:
        key = (re.sub(r"-\d{1,2}(?=-|$)", "-N", entry.name) if entry.training else entry.name, *_recipe(entry))
        groups.setdefault(key, []).append(entry)
    layouts = len(_layouts(manifest))
    rows = [
        (f"`{name}`", stratum, made, sees, _per_layout(len(entries), layouts), _steps(entries))
        for (name, stratum, made, sees), entries in groups.items()
    ]
    heads = ("partner", "stratum", "made by", "sees")
    columns = [*(Column(head, left=True) for head in heads), Column("per layout"), Column("steps, M")]
    return Table(columns, rows).markdown()


def _recipe(entry: Entry) -> tuple[str, str, str]:
    """Returns a partner's stratum, what made it, and its observation and network."""
    if entry.role == "floor":
        return "floor", "script", "-"
    if entry.training is None:
        return entry.stratum, "script", "-"
    trained, settings = entry.training, entry.training.settings
    share = "" if trained.done == 1 else ", untrained" if trained.done == 0 else ", stopped before the end"
    code = f" ({trained.codebase})" if trained.codebase else ""
    hidden = " ".join(map(str, settings.get("hidden", ())))
    made = f"`{trained.method}`{code} `{trained.configuration or 'fast'}`{share}"
    return entry.stratum, made, f"`{settings.get('observation', '?')}`, {settings.get('network', 'mlp')} {hidden}"


def _per_layout(count: int, layouts: int) -> str:
    return f"{count // layouts}" if count % layouts == 0 else f"{count} in all"


def _steps(entries: Sequence[Entry]) -> str:
    steps = {f"{entry.training.steps / 1e6:.2f}": entry.training.steps for entry in entries if entry.training}
    ordered = sorted(steps, key=lambda text: steps[text])
    return " to ".join(dict.fromkeys([ordered[0], ordered[-1]])) if ordered else "-"


def _returns(manifest: Manifest) -> str:
    rows = []
    for layout, entries in _layouts(manifest).items():
        done = [one.trained.self_play.mean for one in entries if one.training and one.trained.done == 1]
        rows.append((f"[{layout}](../kitchens/{layout}.md)", str(len(done)), _span(done)))
    return Table([Column("kitchen", left=True), "fully trained", "points per episode"], rows).markdown()


def _conventions(manifest: Manifest) -> Iterator[str]:
    if not any(entry.convention for entry in manifest.entries):
        return
    yield "\n## Conventions\n\nWhat partners do where two agents have to agree, and how many do so.\n"
    rows = []
    for layout, entries in _layouts(manifest).items():
        counted = Counter(entry.convention for entry in entries if entry.convention)
        rows.append((layout, "; ".join(f"{what} ({count})" for what, count in counted.most_common())))
    yield Table([Column("kitchen", left=True), Column("conventions", left=True)], rows).markdown()


def _bounds(manifest: Manifest) -> Iterator[str]:
    if not any(entry.bounds for entry in manifest.entries):
        return
    yield "\n## Floors and ceilings\n"
    yield "Points per episode, lowest / median / highest over partners and sides: what the better of `stay` and"
    yield "`random` reaches with a partner (0 on the scale of N), and what the best known responder does (1). The last"
    yield "column counts the best known responders of one kind.\n"
    rows = []
    for layout, entries in _layouts(manifest).items():
        bounds = [bound for entry in entries for bound in entry.bounds or ()]
        kinds = Counter(bound.responder.split("/")[0] for bound in bounds)
        named = ", ".join(f"`{kind}` {count}" for kind, count in kinds.most_common(4))
        spans = _span([bound.floor for bound in bounds]), _span([bound.ceiling for bound in bounds])
        rows.append((layout, *spans, named))
    columns = [
        Column("kitchen", left=True),
        Column("floor"),
        Column("ceiling"),
        Column("most frequent responders", left=True),
    ]
    yield Table(columns, rows).markdown()


def _span(values: Sequence[float]) -> str:
    parts: tuple[Callable[[Any], float], ...] = (min, median, max)
    return " / ".join(f"{part(values):.0f}" for part in parts) if values else "-"

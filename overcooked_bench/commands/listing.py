"""`overcooked-bench list`: everything that has a name, read from the registries."""

import argparse
import re
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from overcooked_bench.commands.common import add_command, add_json, print_json

if TYPE_CHECKING:
    from overcooked_bench.agents.pools.pool import Pool
    from overcooked_bench.agents.pools.records import Entry
    from overcooked_bench.evaluation.protocol import Protocol


class Line(NamedTuple):
    """A line of the list.

    Attributes:
        name: What a command takes; of several agents, the first and the last one.
        what: What it is.
        names: All names that the line stands for, for JSON.
    """

    name: str
    what: str
    names: tuple[str, ...]


def _line(name: str, what: str) -> Line:
    return Line(name, what, (name,))


def _layouts() -> Iterator[Line]:
    from overcooked_bench.kitchen.layout import Layout, layout_names

    for name in layout_names():
        layout = Layout.load(name)
        pots = len(layout.positions("P"))
        yield _line(name, f"{layout.width} x {layout.height} cells, {pots} pot{'s' * (pots > 1)}")


def _agents() -> Iterator[Line]:
    from overcooked_bench.agents.behaviours.parsing import KINDS
    from overcooked_bench.agents.kinds import SCRIPT
    from overcooked_bench.agents.scripted import SCRIPTED

    for name, agent in SCRIPTED.items():
        yield _line(name, agent.what)
    plain = tuple(f"{SCRIPT}{name}" for name, kind in KINDS.items() if not kind.needs)
    yield Line(f"{SCRIPT}DOES", f"a partner of the scenarios: {', '.join(KINDS)}", plain)
    yield from _entries()
    for pool in _shipped():
        groups: dict[str, list[Entry]] = {}
        for layout in pool.layouts:
            for one in pool.agents(layout):
                groups.setdefault(re.sub(r"\d+", "N", one.name), []).append(one)
        for agents in groups.values():
            names = sorted({agent.name for agent in agents})
            span = names[0] if len(names) == 1 else f"{names[0]} ... {names[-1]}"
            yield Line(
                f"{pool.name}/{{layout}}/{span}",
                f"{agents[0].trained.method}{_trained(agents)}, {len(names)} on each of {len(pool.layouts)} layouts",
                tuple(f"{pool.name}/{agent.layout}/{agent.name}" for agent in agents),
            )


def _entries() -> Iterator[Line]:
    from overcooked_bench.agents.entries import load_entry, shipped_entries

    for name in shipped_entries():
        entry = load_entry(name)
        method = next(iter(entry.runs.values()))[0].trained.method
        yield _line(name, f"{method}, {entry.training_seeds} training seeds on each of {len(entry.runs)} layouts")


def _trained(agents: "list[Entry]") -> str:
    """Says how far agents are trained, where that is not to the end."""
    shares = {round(100 * agent.trained.done) for agent in agents}
    if shares in ({100}, {0}):
        return "" if shares == {100} else ", untrained"
    span = f"{min(shares)} %" if len(shares) == 1 else f"{min(shares)} to {max(shares)} %"
    return f", after {span} of the training"


def _shipped() -> "Iterator[Pool]":
    """Reads the manifests of the shipped pools."""
    from overcooked_bench.agents.pools.manifest import read_manifest
    from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools

    for name in shipped_pools():
        yield Pool(find_pool(name), read_manifest(find_pool(name)))


def _pools() -> Iterator[Line]:
    for pool in _shipped():
        roles = [entry.role for layout in pool.layouts for entry in pool.partners(layout)]
        count = f"{roles.count('partner')} partners and {roles.count('floor')} floors"
        state = "" if pool.frozen else ", release candidate"
        yield _line(pool.name, f"{count} on {len(pool.layouts)} layouts, cooking {pool.cooking}{state}")


def _protocols() -> Iterator[Line]:
    from overcooked_bench.evaluation.protocol import load_protocol, protocol_names

    for name in protocol_names():
        yield _line(name, _played(load_protocol(name)))


def _played(protocol: "Protocol") -> str:
    play = protocol.play
    return (
        f"version {protocol.version} ({protocol.sha256[:8]}): pool {play.pool or 'as given'}, "
        f"{len(play.layouts)} layouts, "
        f"{play.episodes} episodes of {play.horizon} steps per partner and seat"
    )


def _observations() -> Iterator[Line]:
    from overcooked_bench.kitchen.layout import Layout
    from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

    layout = Layout.load("cramped_room")
    for name, observation in OBSERVATIONS.items():
        shape = " x ".join(map(str, observation.shape(layout)))
        yield _line(name, f"{shape} {observation.dtype} on {layout.name}")


def _methods() -> Iterator[Line]:
    from overcooked_bench.baselines.methods import METHODS

    for name, what in METHODS.items():
        yield _line(name, what)


def _configurations() -> Iterator[Line]:
    from overcooked_bench.baselines.building.config import pool_config_names
    from overcooked_bench.baselines.methods import METHODS
    from overcooked_bench.baselines.presets import config_names

    for method in METHODS:
        names = config_names(method)
        yield Line(method, ", ".join(names), tuple(f"{method}:{name}" for name in names))
    yield Line("pool build", ", ".join(pool_config_names()), tuple(f"pool:{name}" for name in pool_config_names()))


def _scenarios() -> Iterator[Line]:
    from overcooked_bench.scenarios import CATEGORIES
    from overcooked_bench.scenarios.items import load_scenarios

    found = load_scenarios()
    for category in CATEGORIES:
        ids = tuple(scenario.id for scenario in found if scenario.category == category)
        yield Line(category, f"{len(ids)} scenarios; see `overcooked-bench scenarios list {category}`", ids)


def _metrics() -> Iterator[Line]:
    from inspect import getdoc, getmodule

    from overcooked_bench.evaluation.metric import find_metrics

    for metric in find_metrics():
        opening = (getdoc(getmodule(metric.per_repetition)) or "").partition("\n")[0]
        yield _line(metric.facts.name, f"{metric.facts.unit}: {opening}")


KINDS: Final[dict[str, Callable[[], Iterator[Line]]]] = {
    "layouts": _layouts,
    "agents": _agents,
    "entries": _entries,
    "pools": _pools,
    "protocols": _protocols,
    "observations": _observations,
    "methods": _methods,
    "configurations": _configurations,
    "scenarios": _scenarios,
    "metrics": _metrics,
}
"""What is listed, and where it comes from."""


def add_list(commands: Any) -> None:
    """Declares the command."""
    summary = f"show {', '.join(KINDS)}"
    parser = add_command(commands, "list", _list, summary, "overcooked-bench list agents --json")
    parser.add_argument("kind", metavar="KIND", nargs="?", choices=KINDS, help="show only this kind")
    add_json(parser)


def _list(options: argparse.Namespace) -> int:
    found = {kind: tuple(lines()) for kind, lines in KINDS.items() if options.kind in (None, kind)}
    if options.json:
        print_json({kind: [name for line in lines for name in line.names] for kind, lines in found.items()})
        return 0
    for kind, lines in found.items():
        width = max((len(line.name) for line in lines), default=0)
        count = sum(len(line.names) for line in lines)
        print(f"{kind} ({count})")
        for line in lines:
            print(f"  {line.name:{width}}  {line.what}")
    return 0

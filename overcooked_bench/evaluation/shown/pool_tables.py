"""Pools and cross-play as tables for the terminal."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from overcooked_bench.agents.pools.manifest import people_of, policies
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry, Profile, SeatProfile
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.pools.crossplay import CrossPlay
from overcooked_bench.evaluation.pools.oracle import OracleRow, oracle_score
from overcooked_bench.rendering.table import Column, Table, styled

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

DEEDS = ("pots", "deliveries", "counter_drops", "counter_pickups")


def pool_tables(pool: Pool, layouts: Sequence[str]) -> "Group":
    """Lays a pool out: one table per layout, one row per partner."""
    from rich.console import Group

    trained = len(policies(pool.manifest))
    others = len(pool.manifest.entries) - trained
    size = f"{trained} trained agents" + f", {others} scripted entries" * bool(others)
    state = "" if pool.frozen else ", release candidate"
    head = f"{pool.name} ({pool.hash[:8]}{state}) · {size} · cooking {pool.cooking} · actions {pool.mode}"
    parts: list[RenderableType] = [styled(head, style="bold")]
    if people := people_of(pool.manifest):
        parts.append(styled(f"made from games of {', '.join(people)}, or trained with agents that were"))
    for layout in layouts:
        parts += [styled(""), styled(layout, style="bold"), _agents(pool.partners(layout)).terminal()]
    note = (
        "With itself: points per episode [95 % over episodes]; seats: points from the soups that the chef on that seat "
        "delivers. Done: percent of the run's steps. Nats: entropy of its actions (uniform: 1.79). How often per "
        "episode, both chefs: put into pots, soups served, dropped on counters, picked from counters."
    )
    return Group(*parts, styled(""), styled(note, style="dim"))


def crossplay_tables(found: Sequence[CrossPlay]) -> "Group":
    """Lays cross-play out: one row per layout."""
    from rich.console import Group

    columns = "agents", "with itself", "with strangers", "ratio", "worst pair"
    rows = []
    for one in found:
        mine, other, mean = one.worst
        ratio = one.ratio.text(2) if one.ratio else "none"
        returns = one.self_play.text(0), one.cross_play.text(0)
        rows.append([one.layout, str(len(one.agents)), *returns, ratio, f"{mine}, {other}: {mean:.0f}"])
    table = Table(["layout", *(Column(name, wrap=False) for name in columns)], rows)
    note = (
        "Points per episode; strangers are agents of different lineages, both seats. Intervals: 95 %, for other agents "
        "of the same kind (whole agents are drawn with replacement). Ratio: with strangers divided by with itself; "
        "near 0, each agent has conventions of its own. Worst pair: on seat 0, on seat 1."
    )
    return Group(table.terminal(), styled(""), styled(note, style="dim"))


def _agents(agents: Sequence[Entry]) -> Table:
    profiled = any(agent.training and agent.training.profile for agent in agents)
    columns = ("seats", "nats", "pots", "soups", "drops", "picks") if profiled else ()
    numbers = [Column(name, wrap=False) for name in ("done", "with itself", *columns)]
    return Table(["agent", Column("method", left=True), *numbers], [[agent.name, *_cells(agent)] for agent in agents])


def _cells(agent: Entry) -> list[str]:
    training = agent.training
    if training is None:
        return [agent.stratum + ", floor" * (agent.role == "floor")]
    method = training.method + (f" {training.configuration}" if training.configuration else "")
    own = training.self_play
    returns = Estimate(own.mean, own.low, own.high).text(0)
    cells = [] if training.profile is None else _profile(training.profile)
    return [method, f"{100 * training.done:.0f}", returns, *cells]


def _profile(profile: Profile) -> list[str]:
    shares = " ".join(f"{seat.mean:.0f}" for seat in profile.seats)
    deeds = [f"{sum(_deed(seat, name) for seat in profile.seats):.1f}" for name in DEEDS]
    return [shares, f"{profile.entropy:.2f}", *deeds]


def _deed(seat: SeatProfile, name: str) -> float:
    value: float = getattr(seat, name)
    return value


def oracle_table(found: Mapping[str, Sequence[OracleRow]]) -> Table:
    """Lays out what the oracle reached: one row per layout, with its partners' least and greatest score."""
    rows = []
    for layout, met in found.items():
        each = [row.normalised for row in met]
        rows.append([layout, oracle_score(met).text(3), f"{min(each):.2f}", f"{max(each):.2f}", str(len(each))])
    return Table(["layout", "normalised [95 %]", "least", "most", "partners x sides"], rows)

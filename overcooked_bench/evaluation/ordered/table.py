"""Ordered cross-play: plays entrants with self-play agents and with one another, and makes the thesis's table of it."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Final, Literal

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.ordered.curves import (
    THESIS_FINALS,
    THESIS_ROWS,
    Curve,
    Line,
    Row,
    as_few,
    averaged,
    curve,
    line,
)
from overcooked_bench.evaluation.ordered.entrants import SELF_PLAY, Entrant, find_entrants
from overcooked_bench.evaluation.ordered.strangers import Means, play_strangers
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.evaluation.protocol import OrderedReport, Protocol, ProtocolError
from overcooked_bench.evaluation.scores import Source
from overcooked_bench.files import write_whole

SCHEMA: Final = 1

ORDERED_FILE: Final = "ordered.json"


Kind = Literal["self-play", "one another"]


class Figure(msgspec.Struct, frozen=True, kw_only=True):
    """What entrants reach on one layout with one kind of partners, as one figure of the thesis.

    Attributes:
        layout: The layout.
        partners: "self-play": entrants and self-play agents with the self-play agents. "one another": entrants with all
            entrants, beside self-play agents with one another.
        maximum: Points of the best pair of self-play agents, which count as 1.
        curves: Ordered curves, self-play first.
        lines: The table, self-play first, then what the same agents would be reported as.
    """

    layout: str
    partners: Kind
    maximum: float
    curves: tuple[Curve, ...]
    lines: tuple[Line, ...]


class OrderedCrossPlay(msgspec.Struct, frozen=True, kw_only=True):
    """The content of ordered.json.

    Attributes:
        schema: Version of this form.
        protocol: What was played.
        rule: How curves are summarised.
        episodes: Start states of each pair, each of them from both seats.
        seed: Of the start states and random streams.
        pools: Where the agents are from.
        figures: One for each layout and kind of partners.
        lines: The mean over all figures, of entrants that are in all of them.
    """

    schema: int
    protocol: Source
    rule: OrderedReport
    episodes: int
    seed: int
    pools: tuple[Source, ...]
    figures: tuple[Figure, ...]
    lines: tuple[Line, ...]

    def write(self, folder: str | Path) -> None:
        """Writes ordered.json, everything, into a folder."""
        Path(folder).mkdir(parents=True, exist_ok=True)
        write_whole(Path(folder) / ORDERED_FILE, msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n")


def ordered_cross_play(
    references: Sequence[str | Path],
    protocol: Protocol,
    layouts: Sequence[str] | None = None,
    seed: int = 0,
    workers: int = 1,
    engine: str = "local",
    on_progress: Callable[[str, int, int], object] = lambda what, done, of: None,
) -> OrderedCrossPlay:
    """Plays and summarises.

    Every pair plays the protocol's episodes from both seats, once: both have its mean among theirs. Pairs of one
    lineage, of the same weights, or of which one trained with the other, are omitted.

    Args:
        references: As for `find_entrants`.
        protocol: One with `report.ordered`, such as thesis.
        layouts: Some of the protocol's; all by default.
        seed: Other start states and random streams.
        workers: Processes.
        engine: "local", "dask" or "ray".
        on_progress: Called with the layout, pairs that are done there, and all of them.

    Raises:
        ProtocolError: The protocol says nothing about ordered curves, or plays from one seat alone.
        PoolError: As `find_entrants`, or a pool was changed while it was played.
        WrongUse: Cooking modes differ, or self-play agents reach nothing with one another.
    """
    rule = _check(protocol)
    chosen = _layouts(protocol, layouts)
    own, entrants = find_entrants(references, chosen)
    figures: list[Figure] = []
    for layout in chosen:
        here = [Entrant(one.name, {layout: one.agents[layout]}) for one in entrants if one.agents.get(layout)]
        groups = [own.agents[layout], *(one.agents[layout] for one in here)]
        means = play_strangers(layout, groups, protocol, seed, workers, engine, partial(on_progress, layout))
        figures += make_figures(layout, own, here, means, rule)
    everyone = [player for one in (own, *entrants) for players in one.agents.values() for player in players]
    pools = {player.pool.hash: player.pool for player in everyone if player.pool}
    return OrderedCrossPlay(
        schema=SCHEMA,
        protocol=Source(protocol.name, protocol.sha256),
        rule=rule,
        episodes=protocol.play.episodes,
        seed=seed,
        pools=tuple(Source(pool.name, sha256) for sha256, pool in pools.items()),
        figures=tuple(figures),
        lines=tuple(_overall(figures)),
    )


def make_figures(
    layout: str, own: Entrant, entrants: Sequence[Entrant], means: Means, rule: OrderedReport
) -> Iterator[Figure]:
    """Yields a layout's figure with self-play agents, and, of two entrants or more, the one with one another.

    Args:
        layout: The layout.
        own: The self-play agents.
        entrants: The others that are there.
        means: What was played.
        rule: How curves are summarised.

    Raises:
        WrongUse: Self-play agents reach nothing with one another.
    """
    mine = own.agents[layout]
    rows = [row for agent in mine if (row := _row(agent, mine, means))]
    maximum = max((row.means[-1] for row in rows), default=0.0)
    if not maximum:
        raise WrongUse(f"no two self-play agents reach anything with one another on {layout}; name another pool first")
    counts = sorted({THESIS_ROWS, *(len(one.agents[layout]) for one in entrants)} - {1})
    few = [as_few(SELF_PLAY, rows, rule, maximum, count) for count in counts]
    best = as_few(SELF_PLAY, rows, rule, maximum, THESIS_ROWS, THESIS_FINALS)
    kinds: list[tuple[Kind, Sequence[Player], list[Line | None]]] = [("self-play", mine, [*few, best])]
    if len(entrants) > 1:
        kinds.append(("one another", [agent for one in entrants for agent in one.agents[layout]], few))
    for partners, against, drawn in kinds:
        groups = [(SELF_PLAY, rows)]
        for one in entrants:
            theirs = [row for agent in one.agents[layout] if (row := _row(agent, against, means))]
            groups += [(one.name, theirs)] if theirs else []
        lines = [line(name, some, rule, maximum) for name, some in groups]
        yield Figure(
            layout=layout,
            partners=partners,
            maximum=maximum,
            curves=tuple(curve(name, some, rule) for name, some in groups),
            lines=(lines[0], *(one for one in drawn if one), *lines[1:]),
        )


def _row(agent: Player, partners: Sequence[Player], means: Means) -> Row | None:
    """Returns an agent's row; None if all of its pairs are omitted."""
    met = [
        (mean, other.reference)
        for other in partners
        if (mean := means.get((agent.reference, other.reference))) is not None
    ]
    if not met:
        return None
    values, names = zip(*sorted(met), strict=True)
    return Row(agent.reference, names, values)


def _overall(figures: Sequence[Figure]) -> Iterator[Line]:
    """Yields the mean over figures of each line that is in all of them.

    With one another nobody is chosen, in the thesis neither; there the line of the better of two is that of the few.
    """
    for one in figures[0].lines:
        same = [_same(one, figure.lines, figure.partners != "self-play") for figure in figures]
        if all(same):
            yield averaged([found for found in same if found])


def _same(one: Line, lines: Sequence[Line], unchosen: bool) -> Line | None:
    chosen = one.chosen and not unchosen
    kept = [x for x in lines if (x.entrant, x.drawn, x.chosen) == (one.entrant, one.drawn, chosen)]
    return next((x for x in kept if not one.drawn or x.rows == one.rows), None)


def _check(protocol: Protocol) -> OrderedReport:
    if protocol.report.ordered is None:
        raise ProtocolError(
            f"the protocol {protocol.name} says nothing about ordered curves; give one that has report.ordered, such "
            "as thesis"
        )
    if set(protocol.play.seats) != {0, 1}:
        raise ProtocolError(f"seats is {list(protocol.play.seats)}; cross-play is from both, write [0, 1]")
    return protocol.report.ordered


def _layouts(protocol: Protocol, wanted: Sequence[str] | None) -> tuple[str, ...]:
    known = protocol.play.layouts
    if other := [layout for layout in wanted or () if layout not in known]:
        raise ProtocolError(
            f"the protocol {protocol.name} does not play {other[0]!r}; its layouts are {', '.join(known)}"
        )
    return tuple(layout for layout in known if not wanted or layout in wanted)

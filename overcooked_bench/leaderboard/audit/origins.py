"""Checks what games a store may hold: every cell of the protocol once, with the pool's partners, from its own starts.

None of this needs the agent.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Final

import numpy as np

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.documents import parse_json
from overcooked_bench.evaluation.cells import PartnerLabel, SideBound
from overcooked_bench.evaluation.games.episode import Episode, pack_state, side_of
from overcooked_bench.evaluation.games.facts import read_facts
from overcooked_bench.evaluation.games.roster import ITSELF, SELF, Partner, roster
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.games.streams import Streams
from overcooked_bench.evaluation.protocol import Protocol, load_protocol, protocol_names
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout

_OURS: Final = ("is_ego", "home")
"""What a label says about the scored agent, not about the partner alone."""

Notes = dict[str, dict[str, PartnerLabel]]


def protocol_problems(store: Store, scores: Scores, rules: Protocol, instead: bool) -> Iterator[str]:
    """Yields what is wrong with the protocol, the pool's hash and the salt that a store names.

    Args:
        store: The episodes.
        scores: Its score.json.
        rules: The protocol in the store.
        instead: Whether who audits named the pool: then it may be another one than the protocol's, such as its twin.
    """
    facts = read_facts(store)
    if facts.protocol != rules.sha256:
        yield f"the store names the protocol {facts.protocol!r}, and what it holds has {rules.sha256}"
    if rules.name in protocol_names():
        shipped = load_protocol(rules.name)
        yield from (
            f"protocol {rules.name}: its {part} is not that of the shipped protocol"
            for part in ("version", "play", "report")
            if getattr(rules, part) != getattr(shipped, part)
        )
    if not instead and rules.play.pool_sha256 not in (None, facts.pool):
        yield f"the pool is {facts.pool}, the protocol means {rules.play.pool_sha256}"
    for one in scores.declined:
        if one.layout not in rules.play.layouts or any(layout == one.layout for layout, _, _ in store.blocks()):
            yield f"{one.layout}: declined, but not in the protocol, or played"


def fault_problems(store: Store, scores: Scores, rules: Protocol) -> Iterator[str]:
    """Yields the layouts that were started and not finished although no fault says why."""
    chosen = parse_json(store.facts.get("partners", "{}"), str(store.file), Notes, StoreError)
    settled = {one.layout for one in scores.layouts} | {one.layout for one in scores.declined}
    begun = {layout for layout, _, _ in store.blocks()} | set(chosen)
    for layout in rules.play.layouts:
        if layout in begun - settled and not any(fault.startswith(layout) for fault in scores.faults):
            yield f"{layout}: neither finished nor declined, and no fault says why"


def partner_problems(store: Store, pool: Pool, rules: Protocol) -> Iterator[str]:
    """Yields what a store says of partners that the pool does not."""
    if (played := read_facts(store).pool) != pool.hash:
        yield f"the result was played with the pool {played}, this one is {pool.hash}"
    notes = parse_json(store.facts.get("partners", "{}"), str(store.file), Notes, StoreError)
    for layout, labels in notes.items():
        meant = {one.name: _label(one) for one in roster(pool, layout, rules.play.per_stratum)}
        for name in dict.fromkeys((*meant, *labels)):
            if name not in meant or name not in labels:
                yield f"{layout}, partner {name}: {'not in the pool' if name in labels else 'left out'}"
                continue
            said, should = labels[name], meant[name]
            for key in PartnerLabel.__struct_fields__:
                if key not in _OURS and getattr(said, key) != getattr(should, key):
                    yield f"{layout}, partner {name}: {key} is not the pool's"


def _label(partner: Partner) -> PartnerLabel:
    """Returns what a pool says about a partner."""
    entry = partner.entry
    bounds = tuple(SideBound(one.side, one.floor, one.ceiling) for one in entry.bounds or ()) or None
    return PartnerLabel(
        *(partner.name, partner.kind, partner.sha256, entry.stratum, entry.convention),
        weight=entry.weight,
        bounds=bounds,
    )


def cell_problems(store: Store, pool: Pool, rules: Protocol, training_seeds: int) -> Iterator[str]:
    """Yields the cells that are missing, too many, of another partner, or from another start state or side.

    Raises:
        StoreError: A block is not as it was written.
    """
    play, facts = rules.play, read_facts(store)
    for key, group in groupby(store.episodes(), key=lambda episode: episode.block):
        layout, run, episode = key
        where = f"{layout}, training seed {run}, episode {episode}"
        if layout not in play.layouts or run >= training_seeds or episode >= play.episodes:
            yield f"{where}: not a block of the protocol"
            continue
        met: set[tuple[str, str, str]] = {
            (one.name, one.sha256, one.kind) for one in roster(pool, layout, play.per_stratum)
        }
        if play.self_play:
            met.add((ITSELF, facts.agent, SELF))
        rows = list(group)
        wanted: Counter[tuple[str, str, str, int]] = Counter((*one, seat) for one in met for seat in play.seats)
        there = Counter((row.partner, row.partner_sha256, row.kind, row.seat) for row in rows)
        for name, _, kind, seat in sorted(((wanted - there) + (there - wanted)).elements()):
            yield f"{where}, partner {name} ({kind}), seat {seat}: missing, too many, or another partner"
        streams = Streams(rules.sha256, facts.salt, facts.seed, layout, episode)
        yield from _start_problems(rules, streams, rows)


def _start_problems(rules: Protocol, streams: Streams, rows: Sequence[Episode]) -> Iterator[str]:
    starts, layout = _starts(rules, streams, rows), Layout.load(streams.layout)
    for row in rows:
        if row.start != starts[_met(row)]:
            yield f"{row.cell}: its start state is not the protocol's"
        elif row.side != side_of(layout, row.first_state, row.seat):
            yield f"{row.cell}: side {row.side} is not where its chef starts"


def _starts(rules: Protocol, streams: Streams, rows: Sequence[Episode]) -> Mapping[str, str]:
    """Returns partner's hash -> the start state that it is met in, as the play of the protocol derives it."""
    hashes = list(dict.fromkeys(map(_met, rows)))
    kitchens = Kitchens(streams.layout, len(hashes), autoreset=False, **rules.play.kitchens)
    kitchens.reset(seed=np.array([streams.start(one) for one in hashes], np.uint64))
    return {one: pack_state(kitchens.state(row)) for row, one in enumerate(hashes)}


def _met(row: Episode) -> str:
    return ITSELF if row.kind == SELF else row.partner_sha256

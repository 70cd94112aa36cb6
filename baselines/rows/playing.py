"""Plays what the page needs of an entry and keeps it in a folder; what is finished there is read, not played again.

An entry has four parts: its score under the protocol, its score under the protocol of the criterion, its training seeds
paired with one another, and its line under the protocol `thesis`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeVar

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.entries import ShippedEntry, load_entry, shipped_entries
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.documents import DocumentError, read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.ordered.table import ORDERED_FILE, OrderedCrossPlay, ordered_cross_play
from overcooked_bench.evaluation.pools.crossplay import EPISODES, CrossPlay, cross_play
from overcooked_bench.evaluation.protocol import Protocol, load_protocol
from overcooked_bench.evaluation.score import score
from overcooked_bench.evaluation.scores import SCORES_FILE, Scores, ScoresError, read_scores

_MOST_BYTES: Final = 64_000_000

Content = TypeVar("Content")
Report = Callable[[str, int, int], object]


@dataclass(frozen=True)
class Games:
    """Which games are played with everybody.

    Attributes:
        protocol: The protocol that entries are scored with.
        criterion: The protocol of the criterion column; None without one.
        thesis: The protocol of ordered curves.
        strangers: Name or folder of the pool whose self-play agents are the partners under `thesis`.
        workers: Processes.
        horizon: Steps of the episodes in which training seeds are paired with one another.
    """

    protocol: Protocol
    criterion: Protocol | None
    thesis: Protocol
    strangers: str
    workers: int = 1
    horizon: int = 400

    @classmethod
    def of(cls, protocol: str | Path, thesis: str | Path, strangers: str, workers: int) -> "Games":
        """Reads the protocols, each a shipped name or a file."""
        rules = load_protocol(protocol)
        criterion = rules.report.criterion
        return cls(rules, load_protocol(criterion) if criterion else None, load_protocol(thesis), strangers, workers)


@dataclass(frozen=True)
class PlayedEntry:
    """What was played of an entry.

    Attributes:
        name: Its name.
        found: What the catalogue says about it.
        entry: Its folder; None for a scripted agent.
        scores: Under the protocol.
        criterion: Under the criterion's protocol; None without one.
        seeds: Its training seeds paired with one another, layout by layout; none for a single one.
        ordered: Under `thesis`.
    """

    name: str
    found: Entrant
    entry: ShippedEntry | None
    scores: Scores
    criterion: Scores | None
    seeds: tuple[CrossPlay, ...]
    ordered: OrderedCrossPlay


def play_entry(name: str, games: Games, home: Path, report: Report = lambda what, done, of: None) -> PlayedEntry:
    """Plays what is missing of an entry.

    Args:
        name: A shipped entry or a scripted agent.
        games: What is played.
        home: Folder for the parts of all entries.
        report: Called with what is being played, how much of it is done, and of how much.

    Raises:
        WrongUse: The agent broke the contract, or cannot be played as `score` and `ordered_cross_play` say.
    """
    found = find(name, mode=games.protocol.play.mode)
    entry = load_entry(name) if name in shipped_entries() else None
    scores = _score(found, games.protocol, games.workers, home, report, scenarios=True)
    if not any(scores.select("n")):
        raise WrongUse(f"{name} has no N under {games.protocol.name}; give a --protocol whose pool has bounds")
    criterion = None
    if games.criterion is not None:
        criterion = _score(found, games.criterion, games.workers, home, report, scenarios=False)
    seeds: tuple[CrossPlay, ...] = ()
    if entry is not None and entry.training_seeds > 1:
        layouts = [one.layout for one in scores.layouts]
        seeds = tuple(_seeds(entry.pool, layout, games, home / f"{name}-seeds", report) for layout in layouts)
    ordered = _ordered(name, entry, games, home / f"{name}-{games.thesis.name}", report)
    return PlayedEntry(name, found, entry, scores, criterion, seeds, ordered)


def _score(found: Entrant, rules: Protocol, workers: int, home: Path, report: Report, scenarios: bool) -> Scores:
    """Scores an agent, unless its finished score is there."""
    folder = home / f"{found.name}-{rules.name}"
    if (folder / SCORES_FILE).is_file():
        try:
            kept = read_scores(folder)
        except ScoresError:  # written again, from the episodes that are there
            kept = None
        if kept is not None and _is_finished(kept, found, rules, scenarios):
            return kept
    scored = score(
        *(found.reference, rules),
        output=folder,
        workers=workers,
        scenarios=scenarios,
        on_progress=lambda at: report(f"{found.name}, {rules.name}: {at.what}", at.done, at.of),
    ).scores
    if scored.faults:
        raise WrongUse(f"{found.name} under {rules.name}: {scored.faults[0]}")
    return scored


def _is_finished(kept: Scores, found: Entrant, rules: Protocol, scenarios: bool) -> bool:
    """Returns whether a score is this agent's, under this protocol as it is reported now, and whole."""
    same = kept.agent.sha256 == found.sha256 and kept.protocol.sha256 == rules.sha256
    pool = rules.play.pool_sha256 or Pool.load(str(rules.play.pool)).hash
    ours = kept.pool is not None and kept.pool.sha256 == pool
    reported = kept.settings.report.sha256 == rules.report.sha256
    whole = not kept.faults and len(kept.layouts) + len(kept.declined) == len(rules.play.layouts)
    return same and ours and reported and whole and (kept.scenarios is not None or not scenarios)


def _seeds(pool: Pool, layout: str, games: Games, folder: Path, report: Report) -> CrossPlay:
    """Pairs the training seeds of an entry with one another on a layout, unless that was done."""
    kept = _read(folder / f"{layout}.json", CrossPlay)
    if kept is not None and kept.pool.sha256 == pool.hash and kept.episodes == EPISODES:
        return kept
    found = cross_play(
        *(pool, layout),
        horizon=games.horizon,
        workers=games.workers,
        on_progress=lambda done, of: report(f"{pool.name}, its seeds: {layout}", done, of),
    )
    found.write(folder / layout)
    return found


def _ordered(name: str, entry: ShippedEntry | None, games: Games, folder: Path, report: Report) -> OrderedCrossPlay:
    """Plays an entry with the self-play agents that are its partners under `thesis`, unless that was done."""
    kept, pool = _read(folder / ORDERED_FILE, OrderedCrossPlay), Pool.load(games.strangers)
    hashes = {pool.hash, *([entry.pool.hash] if entry else [])}
    same = kept is not None and kept.protocol.sha256 == games.thesis.sha256 and kept.rule == games.thesis.report.ordered
    if kept is not None and same and {one.sha256 for one in kept.pools} == hashes:
        return kept
    found = ordered_cross_play(
        [games.strangers, name],
        games.thesis,
        workers=games.workers,
        on_progress=lambda what, done, of: report(f"{name}, {games.thesis.name}: {what}", done, of),
    )
    found.write(folder)
    return found


def _read(file: Path, kind: type[Content]) -> Content | None:
    """Reads what was kept; None if there is nothing, or nothing whole."""
    try:
        return read_json(file, _MOST_BYTES, kind) if file.is_file() else None
    except DocumentError:
        return None

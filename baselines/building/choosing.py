"""Chooses the partners of a pool among its candidates, one layout at a time, and measures what enters the manifest.

Candidates with whom nobody can reach much more than nobody's help are left out first; then the quotas are filled with
partners that are as diverse as can be; then the chosen ones' bounds are measured with the responders that others can
have as well.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.kinds import SCRIPT
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import BehaviourReference, Bound, Entry, ScriptedReference
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.evaluation.pools.bounds import Plan, measure_bounds
from overcooked_bench.evaluation.pools.choice import Candidate, choose_partners
from overcooked_bench.evaluation.pools.conventions import conventions, read_convention
from overcooked_bench.evaluation.pools.meeting import meet
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.evaluation.pools.similarity import similarity, weights

from ..running.place import read_record, write_record
from .candidates import CANDIDATES, LEAST, Key, candidates
from .config import PoolConfig
from .ledger import Ledger

MEASURED: Final = "measured"
"""Folder of the ledgers, in the folder of the runs."""


class Effort(NamedTuple):
    """How much is played.

    Attributes:
        rough: For the bounds of candidates.
        final: For the bounds of partners.
        met: Episodes per seat of every two candidates.
        seen: Episodes per seat from which a candidate's convention is read.
        horizon: Steps of an episode.
    """

    rough: Plan = Plan(tried=2, finalists=3, chosen_by=10, measured=20)
    final: Plan = Plan()
    met: int = 5
    seen: int = 20
    horizon: int = 400


EFFORT: Final = Effort()


class Chosen(NamedTuple):
    """The partners of a layout.

    Attributes:
        entries: As they enter the manifest; none if candidates had to be left out, and one has to choose again.
        weak: Names of candidates with whom too little can be reached.
        unmet: What of the conventions could not be covered, in sentences.
    """

    entries: tuple[Entry, ...]
    weak: tuple[str, ...] = ()
    unmet: tuple[str, ...] = ()


@dataclass(frozen=True)
class Chooser:
    """Chooses the partners of a pool.

    Attributes:
        config: The pool.
        home: Folder of its runs and of the pool of candidates.
        workers: Processes.
        say: Prints a line: how far it is.
        effort: How much is played.
        engine: Where it is played.
    """

    config: PoolConfig
    home: Path
    workers: int
    say: Callable[[str], None]
    effort: Effort = EFFORT
    engine: str = "local"

    def choose(self, layout: str, held: Mapping[Key, Entry], out: Collection[Key] = ()) -> Chosen:
        """Chooses the partners of a layout.

        Args:
            layout: One of the pool's.
            held: The candidates that are trained; all quotas can be met with those that are not out.
            out: Candidates that are left out.
        """
        pool, ledger = Pool.load(self.home / CANDIDATES), Ledger(self._file(layout))
        able, quotas = [], []
        wanted = {quota: number for quota, number in self.config.quotas_on(layout).items() if number}
        for quota in wanted:
            for entry in candidates(self.config, quota, layout, held, out):
                able.append(self._player(entry, pool))
                quotas.append(quota)
        outside = self._outside(layout)
        rough = self._bounds(layout, able, [*outside, *able], self.effort.rough, ledger)
        if weak := _weak(able, rough):
            return Chosen((), weak)
        means = meet(
            layout,
            able,
            able,
            self.effort.met,
            workers=self.workers,
            horizon=self.effort.horizon,
            on_progress=lambda done, of: self._tell(layout, "meet", done, of),
            play=partial(ledger.play, engine=self.engine),
        ).means
        habits = self._conventions(layout, able)
        choice = choose_partners(
            [
                Candidate(
                    name=player.entry.name,
                    quota=quota,
                    lineage=player.entry.lineage,
                    convention=read_convention(habit),
                    successful=bool(own >= LEAST),
                )
                for player, quota, habit, own in zip(able, quotas, habits, means.diagonal(), strict=True)
            ],
            similarity(means, _ceilings(rough)),
            wanted,
        )
        partners = [able[i] for i in choice.chosen]
        bounds = self._bounds(layout, partners, [*outside, *partners], self.effort.final, ledger)
        if weak := _weak(partners, bounds):
            return Chosen((), weak)
        alike = similarity(means[np.ix_(choice.chosen, choice.chosen)], _ceilings(bounds))
        shares = _shares([partner.entry.stratum for partner in partners], alike)
        entries = [
            msgspec.structs.replace(partner.entry, convention=habits[i] or None, bounds=bound, weight=share)
            for i, partner, bound, share in zip(choice.chosen, partners, bounds, shares, strict=True)
        ]
        floors = [one.entry(layout) for one in self.config.scripted if not one.quota]
        return Chosen((*entries, *floors), unmet=choice.unmet)

    def _player(self, entry: Entry, pool: Pool) -> Player:
        """Returns a candidate as somebody who plays, by the name that others can find it under."""
        if isinstance(entry.reference, ScriptedReference):
            return Player(entry.reference.agent, None, entry)
        if isinstance(entry.reference, BehaviourReference):
            return Player(f"{SCRIPT}{entry.reference.text}", None, entry)
        return Player(f"{self.config.name}/{entry.layout}/{entry.name}", pool, entry)

    def _outside(self, layout: str) -> list[Player]:
        """Lists the responders that are no candidates: scripted agents, and what other pools have trained at all."""
        pools = [Pool.load(name) for name in self.config.responders]
        agents = [(pool, entry) for pool in pools for entry in pool.agents(layout) if entry.trained.done > 0]
        return [
            *(Player.scripted(name, layout) for name in SCRIPTED),
            *(Player(f"{pool.name}/{layout}/{entry.name}", pool, entry) for pool, entry in agents),
        ]

    def _bounds(
        self, layout: str, partners: Sequence[Player], responders: Sequence[Player], plan: Plan, ledger: Ledger
    ) -> list[tuple[Bound, ...]]:
        return measure_bounds(
            layout,
            partners,
            responders,
            workers=self.workers,
            on_progress=lambda what, done, of: self._tell(layout, what, done, of),
            plan=plan,
            horizon=self.effort.horizon,
            play=partial(ledger.play, engine=self.engine),
        )

    def _tell(self, layout: str, what: str, done: int, of: int) -> None:
        self.say(f"{layout}: {what}, {done:,} of {of:,} pairs")

    def _conventions(self, layout: str, players: Sequence[Player]) -> list[str]:
        """Returns the players' conventions, and measures those that are not known yet."""
        file = self._file(f"{layout}-conventions")
        known = read_record(file, dict[str, str]) or {}
        keys = [f"{self.effort.seen}/{player.sha256}" for player in players]
        new = [i for i, key in enumerate(keys) if key not in known]
        if new:
            self.say(f"{layout}: the conventions of {len(new)} candidates")
            strange = [players[i] for i in new]
            found = conventions(layout, strange, self.effort.seen, workers=self.workers, engine=self.engine)
            known |= {keys[i]: text for i, text in zip(new, found, strict=True)}
            write_record(file, known)
        return [known[key] for key in keys]

    def _file(self, name: str) -> Path:
        folder = self.home / MEASURED
        folder.mkdir(parents=True, exist_ok=True)
        return folder / f"{name}.json"


def _weak(players: Sequence[Player], bounds: Sequence[tuple[Bound, ...]]) -> tuple[str, ...]:
    """Names the players with whom, from some side, too little more than nobody's help can be reached."""
    return tuple(
        player.entry.name
        for player, found in zip(players, bounds, strict=True)
        if any(bound.ceiling - bound.floor < LEAST for bound in found)
    )


def _ceilings(bounds: Sequence[tuple[Bound, ...]]) -> list[float]:
    """Returns what can be reached with each partner, over its sides."""
    return [sum(bound.ceiling for bound in found) / len(found) for found in bounds]


def _shares(strata: Sequence[str], alike: NDArray[np.float64]) -> list[float]:
    """Returns each partner's share of its stratum's weight."""
    shares = np.zeros(len(strata))
    for stratum in set(strata):
        members = [i for i, one in enumerate(strata) if one == stratum]
        shares[members] = weights(alike[np.ix_(members, members)])
    return [round(share, 6) for share in shares.tolist()]

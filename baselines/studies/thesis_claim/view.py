"""The thesis's own view of the study's agents: ordered curves and its Table 7.3, at equal numbers; descriptive.

As in its figures 7.4 to 7.8, 7.14 and 7.15 and 7.17 and 7.18, every agent plays with self-play agents: number 1 of each
block. Pairs of one block are omitted. No final agent is chosen, and every line has as many rows as every other.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.policies.policy import policy_files
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry, SelfPlay, Training
from overcooked_bench.documents import read_json
from overcooked_bench.evaluation.ordered.curves import Row
from overcooked_bench.evaluation.ordered.entrants import SELF_PLAY, Entrant, tied
from overcooked_bench.evaluation.ordered.table import Figure, make_figures
from overcooked_bench.evaluation.pools.meeting import meet
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.evaluation.protocol import OrderedReport, load_protocol
from overcooked_bench.files import read_regular, write_whole

from .records import RESULTS, ArmRecord, BlockRecord
from .study import Study, StudyError
from .training import policy_of

SP: Final = "sp"
"""The arm that all others play with."""
PROTOCOL: Final = "thesis"
_MOST_BYTES: Final = 16_000_000


class View(msgspec.Struct, frozen=True, kw_only=True):
    """The thesis's view of one layout.

    Attributes:
        layout: Where.
        blocks: Rows of each line.
        episodes: Start states of each pair, from both seats.
        rule: How curves are summarised.
        figure: Curves, whose rows have the names of agents alone, and the table.
    """

    layout: str
    blocks: int
    episodes: int
    rule: OrderedReport
    figure: Figure


def view_file(home: Path, layout: str) -> Path:
    """Returns where a layout's view is."""
    return home / RESULTS / f"view-{layout}.json"


def read_view(home: Path, layout: str) -> View | None:
    """Reads a layout's view; None if it has not been played.

    Raises:
        StudyError: It is damaged.
    """
    file = view_file(home, layout)
    return read_json(file, _MOST_BYTES, View, StudyError) if file.is_file() else None


def play_view(study: Study, layout: str, records: Sequence[BlockRecord], runs: Path, home: Path, workers: int) -> View:
    """Plays the agents of some blocks with the self-play agents of these blocks, and writes the layout's view.

    Args:
        study: The recipe.
        layout: Where.
        records: Of all parts of these blocks.
        runs: Folder of all runs, which holds the weights.
        home: The study's folder.
        workers: Processes.

    Raises:
        StudyError: Weights are missing or others than those of the record.
        WrongUse: Self-play agents reach nothing with one another.
    """
    protocol = load_protocol(PROTOCOL)
    rule = protocol.report.ordered
    assert rule is not None
    folder = runs / "view" / layout
    entries = [_entry(study, record, one, runs, folder) for record in records for one in record.arms if not one.failed]
    write_manifest(folder, study.name, entries)
    pool = Pool.load(folder)
    groups: dict[str, list[Player]] = {arm: [] for record in records for arm in record.by_arm}
    for entry in pool.agents(layout):
        groups[entry.name.rpartition("-")[0]].append(Player(entry.name, pool, entry))
    own = groups.pop(SP)
    everyone = [*own, *(player for players in groups.values() for player in players)]
    met = meet(layout, everyone, own, protocol.play.episodes, workers=workers, horizon=protocol.play.horizon)
    means = {
        (agent.reference, partner.reference): float(met.means[a, p])
        for a, agent in enumerate(everyone)
        for p, partner in enumerate(own)
        if not tied(agent.entry, partner.entry)
    }
    entrants = [Entrant(arm, {layout: tuple(players)}) for arm, players in groups.items() if players]
    figure = next(make_figures(layout, Entrant(SELF_PLAY, {layout: tuple(own)}), entrants, means, rule))
    curves = tuple(
        msgspec.structs.replace(curve, rows=tuple(Row(row.agent, (), ()) for row in curve.rows))
        for curve in figure.curves
    )
    found = View(
        layout=layout,
        blocks=len({record.index for record in records}),
        episodes=protocol.play.episodes,
        rule=rule,
        figure=msgspec.structs.replace(figure, curves=curves),
    )
    write_whole(view_file(home, layout), msgspec.json.encode(found) + b"\n")
    return found


def _entry(study: Study, record: BlockRecord, one: ArmRecord, runs: Path, folder: Path) -> Entry:
    """Copies an agent into the pool that is played, and describes it; agents of one block share a lineage."""
    source = policy_of(study, record, one.arm, runs)
    name = f"{one.arm}-{record.index:02}"
    for ours, theirs in zip(policy_files(source), policy_files(folder / record.layout / name), strict=True):
        theirs.parent.mkdir(parents=True, exist_ok=True)
        write_whole(theirs, read_regular(ours, _MOST_BYTES, raises=StudyError))
    arm = study.arms[one.arm]
    return Entry(
        name=name,
        layout=record.layout,
        reference=None,
        role="partner",
        stratum="own",
        lineage=f"{study.name}/{study.part(record.part).set}/{record.layout}/{record.index}",
        training=Training(
            method=arm.method,
            seed=one.seed,
            namespace=study.name,
            settings=arm.settings,
            steps=one.steps,
            self_play=SelfPlay(mean=one.self_play, low=one.self_play, high=one.self_play, episodes=100),
            configuration=arm.config or None,
        ),
    )

"""Plays the blocks of a score that its store lacks; a fault of the agent ends only its own block."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from overcooked_bench.agents.watch import NO_ANSWER
from overcooked_bench.evaluation.games.again import play_again
from overcooked_bench.evaluation.games.asking import Answer, ask_block
from overcooked_bench.evaluation.games.block import Block, Outcome, play_block, rows_of
from overcooked_bench.evaluation.games.engines import Engine
from overcooked_bench.evaluation.games.episode import BlockKey
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.scores import Declined
from overcooked_bench.files import shown

_LONGEST: Final = 1000  # characters of a fault


class Progress(NamedTuple):
    """How far a score is.

    Attributes:
        what: What has just been finished: a block of a layout, or scenarios.
        done: Finished blocks, those of earlier runs included, or finished kitchens of scenarios.
        of: All of them.
        episodes: Episodes played in this run.
    """

    what: str
    done: int
    of: int
    episodes: int


class Played(NamedTuple):
    """What came of the blocks.

    Attributes:
        episodes: How many were played in this run.
        finished: Layouts of which every block is in the store.
        declined: Layouts that the agent does not play.
        faults: What the agent did wrong, each at a named cell.
        differs: How it plays a block differently when it is played again, in words that follow its name; None if it
            does not, or was not asked to.
    """

    episodes: int
    finished: tuple[str, ...]
    declined: tuple[Declined, ...]
    faults: tuple[str, ...]
    differs: str | None


def play_blocks(
    store: Store,
    blocks: Sequence[Block],
    engine: Engine,
    patience: float | None,
    on_progress: Callable[[Progress], object],
    again: bool = False,
) -> Played:
    """Plays the blocks that the store lacks. The agent is first asked once per layout whether it plays there.

    A block in which it does not answer in time is the last one on that layout with that training seed, since each of
    the others could take as long.

    Args:
        store: Where finished blocks are, and are written.
        blocks: All blocks of the score.
        engine: Where they are played.
        patience: Seconds that one call of a submission may take; None where it plays in a process of its own, which
            is watched there.
        on_progress: Called after each block.
        again: Whether to play the first missing block again and compare, see `again.play_again`.

    Raises:
        StoreError: There is no room for what is to be played, or a block cannot be written; those before it are in the
            store.
    """
    before = store.blocks()
    there = {block.keys for block in blocks if before.issuperset(block.keys)}
    layouts = list(dict.fromkeys(block.layout for block in blocks))
    adapted = dict.fromkeys(store.adapted(), True) | dict.fromkeys({key[0] for key in before} - store.adapted(), False)
    faults: dict[tuple[BlockKey, ...], str] = {}
    declined: dict[str, str] = {}
    first = {block.layout: block for block in reversed(blocks)}
    questions = [first[layout] for layout in layouts if layout not in adapted]
    for answer in engine.map(ask_block, questions, _unanswered, patience):
        if answer.fault is not None:
            faults[first[answer.layout].keys] = answer.fault
        elif answer.declined is not None:
            declined[answer.layout] = answer.declined
        else:
            adapted[answer.layout] = answer.adapted
    wanted = [block for block in blocks if block.layout in adapted]
    to_play = [replace(block, adapted=adapted[block.layout]) for block in wanted if block.keys not in there]
    done, episodes = len(wanted) - len(to_play), 0
    if to_play:
        store.check_room(sum(map(rows_of, to_play)), to_play[0].protocol.play.horizon)
    overdue: set[tuple[str, int]] = set()
    differs = None
    for found in engine.map(play_again, to_play[:1] if again else (), _lost, patience):
        if isinstance(found, Outcome):
            faults[found.block.keys] = found.fault or ""
            overdue |= _overdue(found)
        else:
            differs = found
    going = (block for block in to_play if (block.layout, block.training_seed) not in overdue)
    for outcome in engine.map(play_block, going, _lost, patience):
        block = outcome.block
        if outcome.fault is not None:
            faults[block.keys] = outcome.fault
            overdue |= _overdue(outcome)
        else:
            store.add_blocks(outcome.by_key, block.adapted)
            episodes += len(outcome.episodes)
        done += 1
        on_progress(Progress(block.layout, done, len(wanted), episodes))
    after = store.blocks()
    missing = {block.layout for block in blocks if not after.issuperset(block.keys)}
    return Played(
        episodes=episodes,
        finished=tuple(layout for layout in layouts if layout not in missing),
        declined=tuple(Declined(layout, declined[layout]) for layout in layouts if layout in declined),
        faults=tuple(dict.fromkeys(one_line(faults[block.keys]) for block in blocks if block.keys in faults)),
        differs=differs,
    )


def one_line(fault: str) -> str:
    """Returns a fault as a line that can be printed and is not too long, whatever an agent's message says."""
    return " ".join(shown(fault, _LONGEST).split())


def summary_of(faults: Sequence[str], most: int = 10) -> list[str]:
    """Returns some faults, and how many there are besides."""
    more = [f"and {len(faults) - most} more faults, which score.json lists"] * (len(faults) > most)
    return [*faults[:most], *more]


def _lost(block: Block, why: str) -> Outcome:
    """Blames the agent for a block whose worker process died or was overdue."""
    return Outcome(block, fault=f"{block.cell}: {why}")


def _overdue(outcome: Outcome) -> set[tuple[str, int]]:
    """Returns the layout and training seed of a block that was given up, as its agent did not answer in time."""
    late = outcome.fault is not None and NO_ANSWER in outcome.fault
    return {(outcome.block.layout, outcome.block.training_seed)} if late else set()


def _unanswered(block: Block, why: str) -> Answer:
    """Blames it for a worker process that died or was overdue while it was asked about a layout."""
    return Answer(block.layout, fault=f"{block.layout}, training seed {block.training_seed}, before any step: {why}")

"""Trains and scores one block: the same agents and scores come out after any interruption."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Final

from overcooked_bench.agents.policies.policy import PolicyError, load_policy, policy_files
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.evaluation.protocol import load_protocol
from overcooked_bench.evaluation.score import score

from ... import population, pretrained_partners, self_play
from ...running.parts import self_play_agents
from ...running.place import CONFIG_FILE, Place
from ...running.place import read_record as read_note
from ...running.place import write_record as write_note
from ...running.run import POLICY, Outcome
from .records import ArmRecord, BlockRecord, Score, write_record
from .study import PARTNERS, Block, Study, StudyError

COSTS: Final = "costs.json"
"""CPU seconds of each arm so far, in the block's folder."""
SCORING: Final = "scoring {}"
_VERSIONS: Final = ("overcooked-bench", "numpy", "torch", "stable-baselines3")


def block_file(part: str, play: str) -> str:
    """Returns the name of the record of a finished block in its folder.

    Args:
        part: Part of the study.
        play: Hash of what was played.
    """
    return f"{part}-{play[:8]}.json"


def do_block(block: Block, folder: Path) -> bool:
    """Trains all agents of a block, going on where it was stopped, scores them, and writes its record.

    Args:
        block: What to train.
        folder: Its own.

    Returns:
        Whether it is finished; False where it was stopped, and saved.

    Raises:
        StudyError: An agent cannot be scored.
    """
    found: dict[str, Outcome | str] = {}
    for arm in block.study.part(block.part).arms:
        with _clocked(folder, arm):
            outcome = train_arm(block, arm, folder)
        if outcome is None:
            return False
        found[arm] = outcome
    protocol = load_protocol(block.study.protocol)
    clock = SCORING.format(protocol.sha256[:8])
    with _clocked(folder, clock):
        scores = {
            arm: score_agent(block, one.files.weights, folder / "scores" / f"{arm}-{protocol.sha256[:8]}")
            for arm, one in found.items()
            if not isinstance(one, str)
        }
    costs = read_note(folder / COSTS, dict[str, float]) or {}
    record = BlockRecord(
        part=block.part,
        layout=block.layout,
        index=block.index,
        plan=block.hashes[0],
        recipe=block.hashes[1],
        versions={name: version(name) for name in _VERSIONS},
        scoring_seconds=round(costs[clock], 1),
        arms=tuple(
            ArmRecord(arm=arm, seed=_place(block, arm, folder).seed, failed=one, seconds=round(costs[arm], 1))
            if isinstance(one, str)
            else ArmRecord(
                arm=arm,
                seed=_place(block, arm, folder).seed,
                weights=load_policy(one.files.weights).sha256,
                steps=one.steps,
                total_steps=one.total_steps,
                seconds=round(costs[arm], 1),
                self_play=round(float(one.returns.mean()), 2),
                scores={protocol.sha256: scores[arm]},
            )
            for arm, one in found.items()
        ),
    )
    write_record(record, folder / block_file(block.part, protocol.sha256))
    return True


def train_arm(block: Block, arm: str, folder: Path) -> Outcome | str | None:
    """Trains one agent of a block, or reads it if it is there.

    Args:
        block: Of which it is.
        arm: Which.
        folder: The block's.

    Returns:
        What came out; why training broke down, if numbers became infinite or undefined; None where it was interrupted.
    """
    try:
        return _train(block, arm, folder)
    except PolicyError as error:
        return str(error).rpartition("/")[2]
    except OvercookedBenchError:
        raise
    except (ArithmeticError, ValueError) as error:
        return f"{type(error).__name__}: {error}".partition("\n")[0]


def _train(block: Block, arm: str, folder: Path) -> Outcome | None:
    study, number = block.study, block.study.arms[arm].number
    if number is not None:  # the others are trained where they are needed, and found by their folders
        wanted = study.self_play(block.layout)[: number + 1]
        trained = self_play_agents(wanted, Place(_initial(folder), block.seed))
        return None if trained is None else trained[number]
    settings, place = study.settings(arm, block.layout), _place(block, arm, folder)
    if isinstance(settings, population.Config):
        return population.train(replace(settings, initial=_initial(folder)), place, finals=1)
    if isinstance(settings, pretrained_partners.Config):
        return pretrained_partners.train(settings, place)
    assert isinstance(settings, self_play.Config)
    return self_play.train(settings, place)


def _place(block: Block, arm: str, folder: Path) -> Place:
    """Returns where an arm is trained, and its seed."""
    whole, number = Place(folder, block.seed), block.study.arms[arm].number
    if number is not None:
        return whole.part(_initial(folder).relative_to(folder) / f"sp-{number}", f"self-play {number}")
    if block.study.arms[arm].method == "self-play":
        return whole.part(arm, arm)
    own = folder / arm  # seeds of its agents are those of the self-play agents' block
    return replace(whole, folder=own, resume=(own / CONFIG_FILE).exists())


def _initial(folder: Path) -> Path:
    """Returns where the self-play agents of a block are: the arm that trains against all of them has them there."""
    return folder / PARTNERS / "partners"


def policy_of(study: Study, record: BlockRecord, arm: str, runs: Path) -> Path:
    """Returns the weights of an agent that was trained, after comparing them with its record.

    Args:
        study: The recipe.
        record: Of its block.
        arm: Which agent.
        runs: Folder of all runs.

    Raises:
        StudyError: They are missing, or others.
    """
    block = Block(study, record.part, record.layout, record.index, (record.plan, record.recipe))
    weights = policy_files(_place(block, arm, runs / block.path).folder / POLICY).weights
    try:
        found = load_policy(weights).sha256
    except PolicyError as error:
        raise StudyError(f"{error}; give the --runs that the record {record.name} was made from") from None
    if found != record.by_arm[arm].weights:
        raise StudyError(
            f"{weights} has the hash {found[:8]}, the record {record.name} says {record.by_arm[arm].weights[:8]}; give "
            "the --runs that the record was made from"
        )
    return weights


def score_agent(block: Block, weights: Path, folder: Path) -> Score:
    """Scores an agent on its layout, as `overcooked-bench score` does.

    Args:
        block: Says where, and under which protocol.
        weights: The agent.
        folder: For the episodes.

    Raises:
        StudyError: It was not scored to the end.
    """
    found = score(weights, block.study.protocol, layouts=[block.layout], output=folder, scenarios=False).scores
    if found.faults or not found.layouts or found.pool is None:
        raise StudyError(f"{weights} was not scored ({'; '.join(found.faults) or 'no layout'}); run the block again")
    everywhere = {"seat": None, "side": None, "home": None, "layout": block.layout}
    strata = {
        metric: {
            row.stratum: round(row.value, 6)
            for row in found.select(metric, partner=None, **everywhere)
            if row.stratum is not None
        }
        for metric in ("n", "h50")
    }
    partners = {
        row.partner: round(row.value, 4)
        for row in found.select("n", stratum=None, **everywhere)
        if row.partner is not None
    }
    return Score(pool=found.pool.sha256, n=strata["n"], h50=strata["h50"], partners=partners)


@contextmanager
def _clocked(folder: Path, what: str) -> Iterator[None]:
    """Adds the CPU seconds that pass to what was spent before; those of a process that was killed are lost."""
    began = time.process_time()
    try:
        yield
    finally:
        known = read_note(folder / COSTS, dict[str, float]) or {}
        write_note(folder / COSTS, {**known, what: known.get(what, 0.0) + time.process_time() - began})

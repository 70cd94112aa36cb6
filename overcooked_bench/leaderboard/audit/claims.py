"""What a submission says of itself, in the agent's folder and beside its result: the same, and nothing else."""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.documents import LONGEST
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.files import read_regular
from overcooked_bench.leaderboard.audit.records import Check
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, SubmissionError, load_manifest

CLAIMS: Final = MANIFEST


class Claims(NamedTuple):
    """What `claims_of` found.

    Attributes:
        checks: One check, or none where there is no submission.yaml.
        used_pool: Whether it was trained or selected with the pool that scores it; None if nobody says.
        sha256: Hash of the submission.yaml; None if there is none.
    """

    checks: tuple[Check, ...] = ()
    used_pool: bool | None = None
    sha256: str | None = None


def claims_of(folder: Path, agent: str | None, scores: Scores) -> Claims:
    """Reads the submission.yaml of an agent, and compares it with the one beside the result and with the score.

    Args:
        folder: Of the result; its own submission.yaml counts only as far as the agent's has the same bytes.
        agent: As `score` takes it, None if it is not there.
        scores: The score.json.
    """
    if agent is not None and agent in shipped_entries():
        return Claims(used_pool=_entry_used(agent, scores))
    places = [Path(agent, MANIFEST)] if agent is not None else []
    known = [file for file in (*places, folder / MANIFEST) if file.is_file()]
    if not known:
        return Claims()
    said = "the same in the agent and beside the result, and it fits the score" if len(known) > 1 else "fits the score"
    problems: list[str] = []
    try:
        contents = [read_regular(file, 4 * LONGEST, raises=SubmissionError) for file in known]
        manifest = load_manifest(known[0])
    except WrongUse as error:
        return Claims((Check(CLAIMS, "failed", said, tuple(str(error).splitlines()[:20])),))
    if contents[0] != contents[-1]:
        problems.append("the one beside the result is not the agent's")
    if manifest.training_seeds != scores.training_seeds:
        problems.append(f"it says {manifest.training_seeds} training seeds, the score {scores.training_seeds}")
    used = None if scores.pool is None else manifest.used(scores.pool.name)
    check = Check(CLAIMS, "failed" if problems else "passed", said, tuple(problems))
    return Claims((check,), used, hashlib.sha256(contents[0]).hexdigest())


def _entry_used(name: str, scores: Scores) -> bool | None:
    if scores.pool is None:
        return None
    pool = scores.pool.name
    return any(pool in partners for partners in _partners(name))


def _partners(name: str) -> Iterator[tuple[str, ...]]:
    for runs in load_entry(name).runs.values():
        for entry in runs:
            if entry.training is not None:
                yield tuple(entry.training.settings.get("partners") or ())

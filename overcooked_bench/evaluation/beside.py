"""What a score is shown beside: a reference agent with the same games, and the same agent with a criterion pool."""

from importlib.resources import files
from pathlib import Path
from typing import Final, NamedTuple

from overcooked_bench.evaluation.protocol import load_protocol, protocol_names
from overcooked_bench.evaluation.scores import SCORES_FILE, Scores, ScoresError, read_scores

REFERENCES: Final = Path(str(files("overcooked_bench.protocols")), "references")
"""The shipped scores of reference agents; `references.py` writes them."""


class Beside(NamedTuple):
    """Scores that one is shown beside.

    Attributes:
        reference: Of the protocol's reference agent in the same games, all partners together; None if nobody has it, or
            if the score is its own.
        criterion: Of the same agent under the protocol's criterion; None if it was not scored with it.
    """

    reference: Scores | None = None
    criterion: Scores | None = None


def beside(scores: Scores, folder: str | Path | None = None) -> Beside:
    """Finds what a score is shown beside.

    Args:
        scores: The score.
        folder: Where it is; the score with the criterion is looked for next to it, in `<agent>-<criterion>`.
    """
    reference = next((one for one in _shipped() if _same_games(one, scores)), None)
    name = scores.settings.report.criterion
    if name is None or folder is None or name not in protocol_names():
        return Beside(reference)
    file = Path(folder).absolute().parent / f"{scores.agent.name}-{name}" / SCORES_FILE
    try:
        criterion = read_scores(file)
    except (ScoresError, OSError):
        return Beside(reference)
    same = criterion.agent == scores.agent and criterion.protocol.sha256 == load_protocol(name).sha256
    return Beside(reference, criterion if same else None)


def _shipped() -> list[Scores]:
    return [read_scores(file) for file in sorted(REFERENCES.glob("*.json"))]


def _same_games(one: Scores, other: Scores) -> bool:
    """Returns whether the first score is of the reference agent of the second one, which is another, in its games."""
    shared = all(getattr(one, key) == getattr(other, key) for key in ("protocol", "pool", "seed", "salt"))
    return shared and one.agent.name == other.settings.report.reference and one.agent != other.agent

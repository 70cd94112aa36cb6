"""Writes a review as Markdown to be posted: nothing of it is trusted, since a pull request may have made it."""

from typing import Final

from overcooked_bench.documents import parse_json
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.files import shown
from overcooked_bench.leaderboard.review.changes import ReviewError, entry_of
from overcooked_bench.leaderboard.review.reviewing import SCHEMA, Review

MOST_BYTES: Final = 1_000_000
"""Of a review that is read."""
_LONGEST: Final = 300  # characters of a text
_MOST: Final = 30  # lines of a list


def comment_of(content: bytes, changes: str) -> str:
    """Returns the Markdown of a review.

    Args:
        content: The JSON of a `Review`.
        changes: What the pull request changes, as the code host says it, not the review: as for `entry_of`.

    Raises:
        ReviewError: It is no review, or of another entry than the pull request adds.
    """
    try:
        name = entry_of(changes).name
    except ReviewError as error:  # then the review, too, may be by other code than ours
        return f"### Something has to be changed\n\n{_code(str(error))}\n"
    review = parse_json(content, "the review", Review, ReviewError)
    if review.schema != SCHEMA:
        raise ReviewError(f"the review's schema is {review.schema}; this version reads {SCHEMA}")
    if review.name != name:
        raise ReviewError(f"the review is of {shown(review.name)!r}, and the pull request adds {name!r}")
    lines = [f"### {'In order' if review.sound else 'Something has to be changed'}: {_code(name)}"]
    lines += ["", *(f"- {_code(problem)}" for problem in review.problems[:_MOST])] if review.problems else []
    if review.protocol is not None:
        lines += ["", *_scores(review), "", "| check | verdict | what was compared |", "|---|---|---|"]
        lines += [f"| {_code(one.name)} | {one.verdict} | {_code(one.said)} |" for one in review.checks[:_MOST]]
        wrong = [problem for check in review.checks for problem in check.problems]
        lines += ["", *(f"- {_code(problem)}" for problem in wrong[:_MOST])] if wrong else []
        flags = [f"- flag, {_code(one.kind)}, {_code(one.layout or 'all')}: {_code(one.said)}" for one in review.flags]
        lines += ["", *flags[:_MOST]] if flags else []
    lines += ["", "Computed without secrets from what the pull request adds. A maintainer's own audit decides."]
    return "\n".join(lines) + "\n"


def _scores(review: Review) -> list[str]:
    """Returns the table of the entry beside the shipped references of its protocol."""
    assert review.protocol is not None
    rows: list[tuple[str, Estimate | None, str, str, str]] = [
        (_code(review.name), review.overall, str(review.training_seeds), review.status, review.table)
    ]
    for file in sorted(REFERENCES.glob("*.json")):
        if (one := read_scores(file)).protocol == review.protocol:
            rows.append((_code(one.agent.name), one.overall, str(one.training_seeds), "reference", "main"))
    said = f"Protocol {_code(review.protocol.name)} ({_code(review.protocol.sha256[:8])})"
    head = [said, "", "| entry | score [95 %] | training seeds | status | table |", "|---|--:|--:|---|---|"]
    return head + [f"| {name} | {_number(overall)} | {' | '.join(rest)} |" for name, overall, *rest in rows]


def _number(overall: Estimate | None) -> str:
    return "none" if overall is None else str(overall)


def _code(text: str) -> str:
    """Returns a text as code, in which neither links nor names of people nor HTML have an effect."""
    plain = shown(text, _LONGEST).replace("`", "'").replace("|", "/").strip()
    return f"`{plain}`" if plain else "none"

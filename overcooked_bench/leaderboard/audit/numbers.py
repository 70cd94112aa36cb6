"""Compares a score.json with what its episodes give, field by field."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import msgspec

from overcooked_bench.evaluation.scores import ABOUT, Row, Scores

NOT_FROM_EPISODES: Final = ("declined", "faults", "scenarios", "run")
"""Entries of a score.json that its episodes do not give."""

_CLOSE: Final = 1e-9
"""Relative difference of the same sum on two machines."""


def differences(said: Scores, found: Scores) -> list[str]:
    """Lists the entries of a score that are not what its episodes give.

    Args:
        said: The score.json.
        found: What was computed from its episodes.
    """
    left, right = (_plain(scores) for scores in (said, found))
    return [line for key in left for line in unlike(key, left[key], right[key])]


def unlike(where: str, said: Any, found: Any) -> Iterator[str]:
    """Yields a line for each place in which two plain values differ; numbers may differ in their last digits."""
    if isinstance(said, Mapping) and isinstance(found, Mapping):
        for key in dict.fromkeys((*said, *found)):
            if key not in said or key not in found:
                yield f"{where}, {key}: {'left out' if key not in said else 'not in the episodes'}"
            else:
                yield from unlike(f"{where}, {key}", said[key], found[key])
    elif isinstance(said, Sequence) and isinstance(found, Sequence) and not isinstance(said, str):
        if len(said) != len(found):
            yield f"{where}: {len(said)} entries, should be {len(found)}"
        for index, pair in enumerate(zip(said, found, strict=False)):
            yield from unlike(f"{where}[{index}]", *pair)
    elif not _same(said, found):
        yield f"{where}: {said!r}, should be {found!r}"


def _same(said: Any, found: Any) -> bool:
    if isinstance(said, float) and isinstance(found, float):
        return math.isclose(said, found, rel_tol=_CLOSE, abs_tol=_CLOSE)
    return bool(said == found)


def _plain(scores: Scores) -> dict[str, Any]:
    content: dict[str, Any] = msgspec.to_builtins(scores)
    for key in NOT_FROM_EPISODES:
        del content[key]
    rows = [(_name(row), msgspec.to_builtins(row)) for row in scores.rows]
    content["number of rows"] = len(rows)
    content["rows"] = dict(rows)
    return content


def _name(row: Row) -> str:
    about = (f"{key} {getattr(row, key)}" for key in ABOUT if getattr(row, key) is not None)
    return " ".join([row.metric, *(f"{key} {value:g}" for key, value in sorted(row.params.items())), *about])

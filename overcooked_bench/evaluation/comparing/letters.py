"""Letters of groups: two methods that share one are not separated by the data, two that share none are."""

from collections.abc import Iterator, Sequence, Set
from itertools import combinations
from string import ascii_lowercase


def letters_of(names: Sequence[str], apart: Set[frozenset[str]]) -> dict[str, str]:
    """Returns the letters of each method.

    Args:
        names: Of the methods, the best first.
        apart: The pairs that the data separate.

    Returns:
        Name -> letters; the groups are the largest ones of which no two are separated, in the order of `names`.

    Source: Piepho 2004, "An algorithm for a letter-based representation of all-pairwise comparisons".
    """
    groups: list[list[str]] = [list(names)] if names else []
    for one, other in combinations(names, 2):
        if frozenset((one, other)) in apart:
            split = [
                [name for name in group if name != left]
                for group in groups
                for left in ((one, other) if one in group and other in group else ("",))
            ]
            groups = [group for index, group in enumerate(split) if not _is_within_another(group, index, split)]
    groups.sort(key=lambda group: [names.index(name) for name in group])
    marks = dict(zip(range(len(groups)), _marks(), strict=False))
    return {name: " ".join(marks[i] for i, group in enumerate(groups) if name in group) for name in names}


def _is_within_another(group: list[str], index: int, groups: Sequence[list[str]]) -> bool:
    """Returns whether a group is part of another one; of equal ones the first is kept."""
    return any(
        set(group) < set(other) or (set(group) == set(other) and place < index)
        for place, other in enumerate(groups)
        if place != index
    )


def _marks() -> Iterator[str]:
    yield from ascii_lowercase
    yield from (f"{one}{other}" for one in ascii_lowercase for other in ascii_lowercase)

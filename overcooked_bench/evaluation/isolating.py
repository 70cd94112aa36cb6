"""What a score says about isolation: it was as good as in the worst of the runs that played for it."""

from typing import Final

from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.evaluation.games.store import Store

NOTE: Final = "isolation"
"""The key of the store's note and of `Scores.run`."""

_NONE: Final = "none"
_LEVELS: Final = (_NONE, "weak", "strong")
_MIXED: Final = (
    "Some episodes were played without isolation, by an earlier run; write to another folder with --output to play all "
    "of them in isolation."
)
_MIXED_WEAK: Final = (
    "Some episodes were played by an earlier run whose isolation was weak: the submission could read and write files "
    "with the user's permissions."
)


def note_isolation(store: Store, isolation: Isolation | None, complete: bool) -> dict[str, str] | None:
    """Notes how the blocks that are to be played will be isolated.

    Args:
        store: The score's; a new one has no blocks.
        isolation: How this run isolates the submission.
        complete: Whether all blocks are there already.

    Returns:
        The entry `isolation` of the score's `run`: its level and a sentence; None if nothing was ever isolated.
    """
    now, known = isolation.level if isolation else _NONE, store.facts.get(NOTE, _NONE)
    level = known if complete else now
    if store.blocks() and not complete:
        level = min(known, now, key=_LEVELS.index)
    if level != known:
        store.note(NOTE, level)
    if isolation is None and level == known == _NONE:
        return None
    if isolation is not None and level == now:
        return {"level": level, "said": isolation.sentence}
    said = {_NONE: _MIXED, "weak": _MIXED_WEAK, "strong": "The submission played in a sandbox of its own (bubblewrap)."}
    return {"level": level, "said": said[level]}

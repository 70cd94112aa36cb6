"""Who the people of recorded games are: the pairs of 2019, split so that no person is on both sides."""

import re
from collections.abc import Sequence
from typing import Final, Literal

from overcooked_bench.agents.pools.lineage import SET_A
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown
from overcooked_bench.human.game import Game
from overcooked_bench.kitchen.layout import CLASSIC

PAIRS_2019: Final = tuple(f"2019-{pair:02d}" for pair in range(17))
SETS: Final = {"A": SET_A, "B": tuple(pair for pair in PAIRS_2019 if pair not in SET_A)}
"""Set A trains, for agents that are trained with people and for the human stratum of pools; set B only tests."""

LAYOUTS_2019: Final = CLASSIC


def set_of(group: str | None) -> Literal["A", "B"] | None:
    """Returns the set that a pair belongs to, None for agents and people of other recordings."""
    return "A" if group in SETS["A"] else "B" if group in SETS["B"] else None


def chosen_pairs(wanted: str) -> tuple[str, ...]:
    """Reads which pairs are meant.

    Args:
        wanted: "A" or "B", or a list such as "3,5" (pairs of 2019) or "2019-03,2019-05" (groups by their names).

    Raises:
        WrongUse: It is none of these, or a pair is named twice.
    """
    if wanted.strip() in SETS:
        return SETS[wanted.strip()]
    pairs = []
    for name in (part.strip() for part in wanted.split(",")):
        pair = f"2019-{int(name):02d}" if re.fullmatch(r"[0-9]{1,2}", name) else name
        if not name or (pair.startswith("2019-") and pair not in PAIRS_2019):
            raise WrongUse(
                f"pairs {shown(wanted)!r}: {shown(name)!r} is no pair; write A, B, or pairs separated by commas; "
                f"those of 2019 are 0 to {len(PAIRS_2019) - 1}"
            )
        pairs.append(pair)
    if len(set(pairs)) < len(pairs):
        raise WrongUse(f"pairs {shown(wanted)!r}: a pair is named twice; name it once")
    return tuple(pairs)


def chosen(games: Sequence[Game], wanted: str) -> list[Game]:
    """Returns the games of some pairs of people, in their order.

    Args:
        games: Of people and agents.
        wanted: As in `chosen_pairs`.

    Raises:
        WrongUse: A pair that is named has no game here, or none of the set's pairs has one; says which pairs there are.
    """
    pairs = chosen_pairs(wanted)
    present = sorted({game.group for game in games if game.group is not None})
    missing = sorted(set(pairs) - set(present))
    if missing and (wanted.strip() not in SETS or len(missing) == len(pairs)):
        raise WrongUse(f"no game of {', '.join(missing)}; there are games of {', '.join(present) or 'no people'}")
    return [game for game in games if game.group in pairs]

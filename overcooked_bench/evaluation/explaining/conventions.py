"""Names clashes by the axes on which two agents have to agree, from what each does with a copy of itself.

Axes: M moments.
"""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Final, Literal, NamedTuple

from overcooked_bench.evaluation.explaining.casting import Played
from overcooked_bench.evaluation.games.episode import side_of
from overcooked_bench.evaluation.pools.axes import AXES, MIXED, Seen
from overcooked_bench.evaluation.pools.conventions import enough, value_of
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tracks.counts import Counts, count

Values = Mapping[str, str]
"""Axis -> value."""

BOTH: Final = (0, 1)


class Habits(NamedTuple):
    """The conventions of the two agents of a moment.

    Attributes:
        agent: The scored agent's.
        partner: The partner's.
    """

    agent: Values
    partner: Values

    def on(self, kind: Literal["differ", "agree"]) -> tuple[str, ...]:
        """Returns the axes on which they differ or agree; where one is not known or does all of it, they do neither."""
        known = [axis for axis, mine in self.agent.items() if MIXED not in (mine, self.partner.get(axis, MIXED))]
        return tuple(axis for axis in known if (self.agent[axis] == self.partner[axis]) == (kind == "agree"))


def habits(played: Played, known: Mapping[str, Values]) -> list[Habits]:
    """Finds the conventions of the agent and of the partner of each moment.

    The scored agent's are what it does with copies of itself from the moments of a training seed on, taken together:
    the same counts as those of a pool's conventions, in ten episodes' worth of steps. A partner's are those that its
    pool says; where it says none, what it does with a copy of itself from its moments on, if that is enough to name
    any.

    Args:
        played: What was played.
        known: Name of a partner -> its conventions, if its pool says so.

    Returns:
        M pairs; empty on a layout without axes.
    """
    moments = played.task.moments
    seeds = [str(moment.episode.training_seed) for moment in moments]
    names = [moment.episode.partner for moment in moments]
    own, theirs = _measured(played, "agent", seeds), _measured(played, "partner", names)
    return [Habits(own[seed], known.get(name) or theirs[name]) for seed, name in zip(seeds, names, strict=True)]


def counts_of(played: Played, moment: int, pairing: Literal["agent", "partner", "greedy"]) -> Iterator[Counts]:
    """Counts what a pairing does from a moment on, in each repeat."""
    layout = Layout.load(played.task.layout)
    for row in played.of(moment, pairing):
        yield count(layout, played.continued.track(row))


def _measured(played: Played, pairing: Literal["agent", "partner"], groups: Sequence[str]) -> dict[str, Values]:
    """Returns the conventions of the agents of each group, each of which plays the pairing from some moments on."""
    layout, axes = Layout.load(played.task.layout), AXES.get(played.task.layout, ())
    found: dict[str, dict[str, dict[str, float]]] = defaultdict(
        lambda: {axis.name: dict.fromkeys(axis.values, 0.0) for axis in axes}
    )
    for moment, group in enumerate(groups):
        amounts, start = found[group], played.continued.states[played.of(moment, pairing)[0]]
        sides = side_of(layout, start, 0), side_of(layout, start, 1)
        for counts in counts_of(played, moment, pairing) if axes else ():
            seen = Seen(layout, counts, BOTH, sides)
            for axis in axes:
                for value, amount in axis.speaks(seen).items():
                    amounts[axis.name][value] += amount
    return {
        group: {axis: value_of(values) for axis, values in amounts.items() if enough(values)}
        for group, amounts in found.items()
    }

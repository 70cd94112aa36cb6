"""The tables of the study of agents trained with people, and its answer by the rule of `results/humans-plan.md`.

Axes: S training runs, P partners, E episode indices, K seats of the entrant.
"""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.estimate import Estimate, weighted_interval
from overcooked_bench.rendering.table import Column, Table

WITH_PEOPLE: Final = "with people"
SELF_PLAY: Final = "self-play"
POPULATION: Final = "with a population"
GREEDY: Final = "greedy"
ENTRANTS: Final = (WITH_PEOPLE, SELF_PLAY, POPULATION, GREEDY)
DIFFERENCE: Final = "with people - self-play"
_MEAN: Final = "mean"


class Games(NamedTuple):
    """What was played.

    Attributes:
        returns: (start, layout, entrant) -> (S, P, E, K) points per episode.
        partners: Layout -> names of its P partners.
    """

    returns: Mapping[tuple[str, str, str], NDArray[np.float64]]
    partners: Mapping[str, Sequence[str]]

    @property
    def starts(self) -> list[str]:
        """The kinds of starts."""
        return list(dict.fromkeys(start for start, _, _ in self.returns))

    def of(self, layout: str, entrant: str, start: str | None = None) -> NDArray[np.float64]:
        """Returns (S, P, E, K) points of an entrant; without a start, the mean over all kinds of starts."""
        starts = self.starts if start is None else [start]
        return np.asarray(np.mean([self.returns[one, layout, entrant] for one in starts], axis=0))

    def values(self, layout: str, entrant: str, start: str | None = None) -> NDArray[np.float64]:
        """Returns an entrant's independent values: (S,) one per training run; (E,) of `greedy`, which has none."""
        returns = self.of(layout, entrant, start)
        return np.asarray(returns.mean(axis=(0, 1, 3) if entrant == GREEDY else (1, 2, 3)))


def mean_of(games: Games, layouts: Sequence[str], entrant: str, start: str | None = None) -> Estimate:
    """Returns an entrant's mean over layouts."""
    return weighted_interval([(1 / len(layouts), games.values(layout, entrant, start)) for layout in layouts])


def difference(games: Games, layouts: Sequence[str], start: str | None = None) -> Estimate:
    """Returns what training with people adds to self-play: the difference of the means over layouts."""
    signs = ((1 / len(layouts), WITH_PEOPLE), (-1 / len(layouts), SELF_PLAY))
    return weighted_interval(
        [(weight, games.values(layout, entrant, start)) for layout in layouts for weight, entrant in signs]
    )


def by_partner(games: Games, layout: str) -> dict[str, float]:
    """Returns the same difference with each partner."""
    people, own = (games.of(layout, entrant).mean(axis=(0, 2, 3)) for entrant in (WITH_PEOPLE, SELF_PLAY))
    return dict(zip(games.partners[layout], (people - own).tolist(), strict=True))


def in_words(found: Estimate) -> str:
    """Says what a difference shows, by the rule of the plan."""
    if found.interval is None or found.interval[0] <= 0 <= found.interval[1]:
        return "undecided"
    return "with people" if found.value > 0 else "self-play"


def answer(games: Games) -> str:
    """Answers the question of the study in a sentence."""
    found = difference(games, list(games.partners))
    said = {
        "with people": "The finding of Carroll et al. 2019 holds here",
        "self-play": "The opposite of what Carroll et al. 2019 found holds here",
        "undecided": "This study does not decide whether the finding of Carroll et al. 2019 holds here",
    }[in_words(found)]
    return (
        f"{said}: over the layouts, agents trained with people reach {found.text()} points per episode more than "
        "self-play agents with partners made from other people (difference of means, 95 % interval over training runs)."
    )


def report(games: Games) -> str:
    """Writes the answer and three tables in Markdown: both starts together, each apart, and partner by partner."""
    layouts = list(games.partners)
    heads: list[Column | str] = [Column("layout", left=True), *ENTRANTS, DIFFERENCE]
    main, apart, each = [], [], []
    for name, some in (*((layout, [layout]) for layout in layouts), (_MEAN, layouts)):
        positive = [value > 0 for layout in some for value in by_partner(games, layout).values()]
        found = difference(games, some)
        main.append([*_row(games, name, some), f"{sum(positive)} of {len(positive)}", in_words(found)])
        for start in games.starts:
            name_, *cells = _row(games, name, some, start)
            apart.append([name_, start, *cells])
    for layout in layouts:
        told = ", ".join(f"{name} {value:+.0f}" for name, value in by_partner(games, layout).items())
        each.append([layout, told])
    runs = ", ".join(f"{entrant} {len(games.values(layouts[0], entrant))}" for entrant in ENTRANTS[:-1])
    parts = [
        answer(games),
        f"Training runs per layout: {runs}. The last columns: the partners with which the difference is positive, and "
        "who reaches more.",
        Table([*heads, "partners", Column("more", left=True)], main).markdown(),
        "Each kind of start by itself:",
        Table([heads[0], Column("start", left=True), *heads[1:]], apart).markdown(),
        f"The difference `{DIFFERENCE}` with each partner:",
        Table([heads[0], Column("partners", left=True)], each).markdown(),
    ]
    return "\n\n".join(parts)


def _row(games: Games, name: str, layouts: Sequence[str], start: str | None = None) -> list[str]:
    found = [*(mean_of(games, layouts, entrant, start) for entrant in ENTRANTS), difference(games, layouts, start)]
    return [name, *(one.text(0) for one in found)]

"""Keeps the worst moments of a layout: as states with the games from there on, and as scenario files."""

import re
from collections.abc import Iterator, Sequence
from typing import Final

from overcooked_bench.evaluation.explaining.casting import Played
from overcooked_bench.evaluation.explaining.conventions import Habits
from overcooked_bench.evaluation.explaining.moments import STEPS
from overcooked_bench.evaluation.explaining.reasons import PAIRINGS, Pairing, typical
from overcooked_bench.evaluation.explaining.records import PREFIX, Game, Moment, Worst
from overcooked_bench.evaluation.explaining.scenario_files import write_scenario
from overcooked_bench.kitchen.codes import ACTION_LETTERS
from overcooked_bench.scenarios import SUFFIX

WORST: Final = 3
"""Moments that are kept of each layout."""

_OURS: Final = ("clash", "inexperience", "neither")
"""Reasons in which the scored agent has a part: a weak partner has nothing to say about it."""


def worst_moments(
    played: Played, moments: Sequence[Moment], conventions: Sequence[Habits]
) -> Iterator[tuple[Worst, str | None]]:
    """Yields the moments from which the pair missed most soups, each with the text of its scenario.

    Different partners come first, then those that are there again; ties are in the order of the moments, which depends
    on nothing that happened. A moment whose reason is a weak partner is never among them.

    Args:
        played: What was played on the layout.
        moments: What came of it.
        conventions: For each moment those of its two agents.
    """
    ours = [index for index, moment in enumerate(moments) if moment.reason in _OURS]
    order = sorted(ours, key=lambda index: -moments[index].soups.missed)
    first = list({moments[index].partner: index for index in reversed(order)}.values())
    first.sort(key=order.index)
    again = [index for index in order if index not in first]
    for number, index in enumerate([*first, *again][:WORST], start=1):
        moment, name = moments[index], f"{PREFIX}{_plain(played.task.layout)}-{number}"
        text = write_scenario(played, index, moment.reason, name, sentence(played.task.name, moment))
        games = {pairing: _game(played, index, pairing, moment) for pairing in PAIRINGS}
        yield (
            Worst(
                name=name,
                moment=index,
                conventions=(dict(conventions[index].agent), dict(conventions[index].partner)),
                state=played.continued.states[played.of(index, "pair")[0]].to_dict(),
                games=games,
                scenario=None if text is None else name + SUFFIX,
            ),
            text,
        )


def sentence(agent: str, moment: Moment) -> str:
    """Says what happened from a moment on."""
    mean = moment.soups.mean
    return (
        f"From step {moment.step} of an episode with {moment.partner}, {agent} and it deliver {mean('pair'):.1f} soups "
        f"in {STEPS} steps; two copies of {agent} deliver {mean('agent'):.1f}, two of {moment.partner} "
        f"{mean('partner'):.1f}, two of greedy {mean('greedy'):.0f}."
    )


def _game(played: Played, index: int, pairing: Pairing, moment: Moment) -> Game:
    soups: tuple[float, ...] = getattr(moment.soups, pairing)
    repeat = typical(soups)
    actions = played.continued.actions[:, played.of(index, pairing)[repeat]]
    first, second = ("".join(ACTION_LETTERS[action] for action in column) for column in actions.T.tolist())
    return Game(repeat=repeat, soups=soups[repeat], actions=(first, second))


def _plain(layout: str) -> str:
    """Makes a layout's name part of a file's; a grid's text is no name."""
    return re.sub(r"[^A-Za-z0-9_-]+", "-", "grid" if "\n" in layout else layout)[:60]

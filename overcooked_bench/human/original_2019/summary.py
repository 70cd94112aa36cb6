"""Says what the games of 2019 are, and that their publishers' two sets are not split by people."""

from collections.abc import Collection
from typing import NamedTuple

from overcooked_bench.human.original_2019.importing import LAYOUTS, Imported
from overcooked_bench.rendering.table import Table


class Count(NamedTuple):
    """What there is of one layout, or of all.

    Attributes:
        layout: The layout's name; "all".
        games: How many games.
        pairs: How many pairs of people played them.
        steps: Joint steps.
        soups: Deliveries.
        train: Games in the publishers' set of this name.
        test: Games in the other one.
        pairs_of_test: Pairs with a game in `test`.
        also_in_train: How many of these have a game in `train` too, on whichever layout.
        in_both: Pairs with games of these in both sets.
    """

    layout: str
    games: int
    pairs: int
    steps: int
    soups: int
    train: int
    test: int
    pairs_of_test: int
    also_in_train: int
    in_both: int


def count(imported: Imported) -> list[Count]:
    """Counts the games of each layout, and of all at the end."""
    layouts = [name for name in LAYOUTS.values() if any(game.layout == name for game in imported.games)]
    return [*(_count(imported, name, [name]) for name in layouts), _count(imported, "all", layouts)]


def _count(imported: Imported, name: str, layouts: Collection[str]) -> Count:
    everyone = list(zip(imported.games, imported.sets, strict=True))
    chosen = [(game, which) for game, which in everyone if game.layout in layouts]
    trained = {game.group for game, which in everyone if which == "train"}
    here, there = ({game.group for game, which in chosen if which == wanted} for wanted in ("train", "test"))
    return Count(
        name,
        games=len(chosen),
        pairs=len(here | there),
        steps=sum(game.steps for game, _ in chosen),
        soups=sum(len(game.soups) for game, _ in chosen),
        train=sum(which == "train" for _, which in chosen),
        test=sum(which == "test" for _, which in chosen),
        pairs_of_test=len(there),
        also_in_train=len(there & trained),
        in_both=len(here & there),
    )


def count_table(counts: list[Count]) -> Table:
    """Lays counts out as a table."""
    *rows, foot = (
        [
            *(count.layout, f"{count.games}", f"{count.pairs}", f"{count.steps:,}", f"{count.soups:,}"),
            *(f"{count.train}", f"{count.test}", f"{count.also_in_train} of {count.pairs_of_test}"),
        ]
        for count in counts
    )
    heads = [
        "layout",
        "games",
        "pairs",
        "steps",
        "soups",
        "their\ntrain",
        "their\ntest",
        "pairs of test\nalso in train",
    ]
    return Table(heads, rows, [foot])


def leak(counts: list[Count]) -> str:
    """Says in a sentence how many people are in both of the publishers' sets."""
    *some, of_all = counts
    return (
        f"{of_all.in_both} of {of_all.pairs} pairs are in both of the publishers' sets ({max(c.in_both for c in some)} "
        "on the same layout): these sets hold out games, not people; split by `group` instead"
    )

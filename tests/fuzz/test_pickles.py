"""Pickled tables of recorded games."""

import pickletools
import random
from collections.abc import Iterator
from itertools import pairwise

from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.human.original_2019.importing import import_games
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import bytes_of
from tests.human.made import random_game
from tests.human.original_2019.pickled import rows, table


def opcodes_of(data: bytes, rng: random.Random) -> Iterator[bytes]:
    """Drops, doubles, swaps and replaces opcodes, so that most of what comes out can still be followed."""
    places = [place for *_, place in pickletools.genops(data)] + [len(data)]
    whole = [data[begin:end] for begin, end in pairwise(places)]
    codes = [opcode.code.encode("latin-1") for opcode in pickletools.opcodes]
    while True:
        parts = list(whole)
        for _ in range(rng.choice((1, 1, 2, 5))):
            at, other = rng.randrange(len(parts)), rng.randrange(len(parts))
            match rng.randrange(4):
                case 0:
                    del parts[at]
                case 1:
                    parts.insert(at, parts[other])
                case 2:
                    parts[at], parts[other] = parts[other], parts[at]
                case _:
                    parts[at] = rng.choice(codes)
        yield b"".join(parts)


@TRIES
def test_pickled_tables(tries):
    whole, rng = table(rows(random_game(steps=5, start=None), 3)), seeded("pickles")
    inputs = mixed(rng, bytes_of([whole], rng), opcodes_of(whole, rng))
    attack("pickle", [whole], inputs, lambda data: import_games({"train": data}), OvercookedBenchError, tries).check()

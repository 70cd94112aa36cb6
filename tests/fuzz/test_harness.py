"""The harness sees what it is there to see."""

import itertools
import time

import pytest

from tests.fuzz.harness import attack, seeded
from tests.fuzz.mutators import as_json, bytes_of, lines_of, trees_of

SEEDS = [{"a": 1, "b": [{"c": "x"}, 2.5]}, {"a": [True, None], "d": "text\nof lines"}]


def read(content: bytes) -> None:
    if content == b"refused":
        raise ValueError(content)
    if content == b"foreign":
        raise KeyError(content)
    if content == b"waiting":
        time.sleep(60)
    while content == b"endless":
        pass
    if content == b"huge":
        bytes(1 << 40)


def test_refusals_foreign_exceptions_hangs_and_memory_are_told_apart():
    inputs = itertools.cycle([b"refused", b"foreign", b"endless", b"waiting", b"huge", b"fine"])
    tally = attack("test", [b"fine"], inputs, read, ValueError, 6, limit=0.1)
    assert (tally.accepted, tally.refused, tally.hangs) == (1, 1, 2)
    assert sorted(what.partition(":")[0] for what in tally.foreign) == ["KeyError", "MemoryError"]
    assert b"foreign" in tally.examples.values()
    with pytest.raises(AssertionError, match="2 foreign exceptions, 2 hangs"):
        tally.check()


@pytest.mark.parametrize(
    "files",
    [
        lambda rng: bytes_of([b"id: x\nlist: [1, 2]\n", b"other: text\n"], rng),
        lambda rng: lines_of([b"id: x\nlist: [1, 2]\n"], rng),
        lambda rng: as_json(trees_of(SEEDS, rng)),
    ],
    ids=["bytes", "lines", "trees"],
)
def test_mutations_are_many_and_the_same_in_every_run(files):
    one, again = (list(itertools.islice(files(seeded("test")), 300)) for _ in range(2))
    assert one == again
    assert len(set(one)) > 150

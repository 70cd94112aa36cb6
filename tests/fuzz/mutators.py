"""Mutators: of bytes, of YAML's text, and of trees as JSON and YAML hold them."""

import copy
import json
import random
from collections.abc import Callable, Iterator, Sequence
from typing import Any

MARKS = (
    *(b"&a ", b"*a", b"!!int ", b"!!bool x", b"!!timestamp x", b"!!python/object/apply:os.getcwd []", b"!x ", b"<<: "),
    *(b"- ", b"? ", b": ", b"[", b"{", b"]", b"}", b",", b"|\n", b">\n", b"'", b'"', b"#", b"\\", b"%YAML 9.9\n", b"@"),
    *(b"\0", b"\x1b[31m", b"\x85", b"\xff", b"\xed\xa0\x80", b"\xef\xbb\xbf", b"\xe2\x80\xa8", b'"\\ud800"', b'"\\0"'),
    *(b".inf", b"-.INF", b".nan", b"NaN", b"Infinity", b"1e999", b"1.0e+999", b"9" * 50, b"-1", b"0x", b"0b_", b"1:30"),
    *(b"---\n", b"...\n", b"\t", b"\r", b"\n", b"  ", b"null", b"~", b"yes", b"2020-01-01", b"[" * 1000, b"{" * 200),
    *(b"../../x", b"/dev/zero", b"x" * 3000, b"*" * 50, b"- " * 500, b"[]", b"{}", b"true"),
)
"""Pieces of text that readers have fallen over."""

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 3, 7, 255, 256, 2**31, 2**63, -(2**63), 2**64, 10**30, 10**400),
    *(0.0, -0.0, 0.5, 1.5, -1.5, 1e-300, 1e300, float("inf"), float("-inf"), float("nan")),
    *("", " ", "x", "..", "../../x", "/proc/self/mem", "/dev/zero", "/proc/kmsg", "a\0b", "a\nb", "\ud800", "\x1b[31m"),
    *("x" * 300, "x" * 5000, "1", "null", "north", "up", "cramped_room", "cramped_room-mirrored", "-mirrored" * 300),
    *([], {}, [[]], [None], {"": 0}, {"x": {}}, [1, 2], ["up"], [[0, 0]], [[10**30, -1]], list(range(300))),
)
"""Values that stand where they should not."""


def bytes_of(seeds: Sequence[bytes], rng: random.Random) -> Iterator[bytes]:
    """Changes files byte by byte: flips, cuts, doubles, truncates, splices, and puts in what readers fell over."""
    while True:
        content = bytearray(rng.choice(seeds))
        for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
            at, length = rng.randrange(len(content) + 1), rng.choice((1, 1, 2, 4, 16, 200))
            other = rng.choice(seeds)
            begin = rng.randrange(len(other) + 1)
            change = rng.randrange(8)
            if change == 0 and at < len(content):
                content[at] ^= 1 << rng.randrange(8)
            elif change == 1:
                content[at : at + length] = bytes(rng.randrange(256) for _ in range(length))
            elif change == 2:
                del content[at : at + length]
            elif change == 3:
                content[at:at] = content[at : at + length]
            elif change == 4:
                content[at:at] = rng.choice(MARKS)
            elif change == 5:
                content[at : at + length] = rng.choice(MARKS)
            elif change == 6:
                content[at:at] = other[begin : begin + length]
            elif rng.random() < 0.3:
                del content[at:]
        yield bytes(content)


def lines_of(seeds: Sequence[bytes], rng: random.Random) -> Iterator[bytes]:
    """Changes texts line by line: doubles, drops, moves, indents, and replaces values after a colon."""
    while True:
        lines = rng.choice(seeds).decode().split("\n")
        for _ in range(rng.choice((1, 1, 2, 4))):
            at, change = rng.randrange(len(lines)), rng.randrange(6)
            line, key = lines[at], lines[at].partition(":")[0]
            if change == 0:
                lines.insert(rng.randrange(len(lines) + 1), line)
            elif change == 1 and len(lines) > 1:
                del lines[at]
            elif change == 2:
                lines.insert(rng.randrange(len(lines) + 1), lines.pop(at))
            elif change == 3:
                lines[at] = rng.choice((" ", "    ", "\t", "- ")) + line
            elif change == 4:
                lines[at] = f"{key}: {rng.choice(MARKS).decode('latin-1')}"
            else:
                lines[at] = f"{key}: {written(rng.choice(VALUES))}"
        yield "\n".join(lines).encode("utf-8", "surrogatepass")


def trees_of(seeds: Sequence[Any], rng: random.Random) -> Iterator[Any]:
    """Changes values of trees: replaces, drops, adds, moves, doubles and buries them."""
    while True:
        tree = copy.deepcopy(rng.choice(seeds))
        for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
            tree = _changed(tree, rng)
        yield tree


def _changed(tree: Any, rng: random.Random) -> Any:
    places = list(_places(tree))
    if not places or rng.random() < 0.01:
        return copy.deepcopy(rng.choice(VALUES))
    home, key = rng.choice(places)
    change = rng.randrange(9)
    if change <= 2:
        home[key] = copy.deepcopy(rng.choice(VALUES))
    elif change == 3:
        home[key] = _near(home[key], rng)
    elif change == 4:
        del home[key]
    elif change == 5:
        other, place = rng.choice(places)
        home[key] = copy.deepcopy(other[place])
    elif change == 6 and isinstance(home, list):
        home.insert(rng.randrange(len(home) + 1), copy.deepcopy(home[key]))
    elif change == 6:
        home[rng.choice(("x", "", "name", "\ud800", f"{key}x"))] = copy.deepcopy(home[key])
    elif change == 7:
        home[key] = [home[key]] if rng.random() < 0.5 else {"x": home[key]}
    else:
        for _ in range(rng.choice((5, 40, 100))):
            home[key] = [home[key]]
    return tree


def _near(value: Any, rng: random.Random) -> Any:
    """Returns a value that is a little off."""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, int | float):
        return rng.choice((value + 1, value - 1, -value, value * 1000, str(value), repr(value) + ".5"))
    if isinstance(value, str):
        at = rng.randrange(len(value) + 1)
        mark = rng.choice(MARKS).decode("latin-1")
        return rng.choice((value[:at], value[at:], value.upper(), value[:at] + mark + value[at:], value * 2))
    return value


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    waiting = [tree] if isinstance(tree, dict | list) else []
    while waiting:
        home = waiting.pop()
        for key, value in list(home.items() if isinstance(home, dict) else enumerate(home)):
            yield home, key
            if isinstance(value, dict | list):
                waiting.append(value)


def written(value: Any) -> str:
    """Writes a tree as JSON, which YAML reads too; infinite numbers as Python does."""
    return json.dumps(value, default=str)


def as_json(trees: Iterator[Any], change: Callable[[Any], Any] = lambda tree: tree) -> Iterator[bytes]:
    """Writes trees as JSON, which YAML reads too."""
    for tree in trees:
        yield written(change(tree)).encode()

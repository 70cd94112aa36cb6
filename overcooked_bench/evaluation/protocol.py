"""`Protocol`: the file that fixes what is played and how it is scored.

    name: dev
    version: 1
    play: {pool: dev-v0, layouts: [cramped_room], ...}
    report: {thresholds: [1, 3, 5]}

Start states and random streams depend on `play` alone, so the report can change without changing any game. A new
protocol is one file in `protocols/`.
"""

import hashlib
import math
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import check_name, read_text
from overcooked_bench.shelf import Shelf

NEWEST: Final = "dev"
"""The default protocol."""

MOST_STEPS: Final = 10_000
"""Maximum number of steps per episode; all its joint actions are kept in memory."""

MOST_EPISODES: Final = 10_000
"""Maximum number of start states per partner; the list of all blocks is kept in memory."""


class ProtocolError(WrongUse):
    """A protocol cannot be found or read; the message names the file and the key."""


_SHELF: Final = Shelf("protocol", "overcooked_bench.protocols", ".yaml", ProtocolError, "a YAML file", first=(NEWEST,))


class _Part(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True):
    """A part of a protocol. New keys are optional: left out, they leave the hash of every older protocol as it was."""

    @property
    def sha256(self) -> str:
        """Hash of what the part says; comments, the order of keys and keys at their defaults do not change it."""
        return _hash(self)


class Play(_Part, frozen=True, kw_only=True):
    """What is played. Two scores are comparable if they agree in this, in the pool and in the salt.

    Attributes:
        pool: Name or folder of the pool, which lists every partner and floor; null if `--pool` always names one.
        layouts: Names of layouts, in the order of the table.
        cooking: "auto" or "manual".
        horizon: Steps per episode, 10,000 at most.
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        seats: Seats of the scored agent.
        episodes: Start states per partner, 10,000 at most; each is played from every seat.
        mode: How frozen policies act, "sample" or "greedy".
        salt: The public salt, mixed into every random stream and into the order of the rows.
    """

    pool: str | None
    layouts: tuple[str, ...]
    cooking: Literal["auto", "manual"]
    horizon: int
    start: Literal["random", "standard"]
    object_probability: float
    seats: tuple[Literal[0, 1], ...]
    episodes: int
    mode: Literal["sample", "greedy"]
    salt: str

    def __post_init__(self) -> None:
        _check(
            ("pool", self.pool, self.pool is None or bool(self.pool.strip()), "the name or folder of a pool, or null"),
            ("layouts", self.layouts, 0 < len(set(self.layouts)) == len(self.layouts), "at least one, each once"),
            ("horizon", self.horizon, 1 <= self.horizon <= MOST_STEPS, f"a number of steps from 1 to {MOST_STEPS:,}"),
            ("object_probability", self.object_probability, 0 <= self.object_probability <= 1, "a probability"),
            ("seats", self.seats, 0 < len(set(self.seats)) == len(self.seats), "[0, 1], [0] or [1]"),
            ("episodes", self.episodes, 1 <= self.episodes <= MOST_EPISODES, f"a number from 1 to {MOST_EPISODES:,}"),
            ("salt", self.salt, is_text(self.salt), "a text"),
        )

    @property
    def kitchens(self) -> dict[str, Any]:
        """The rules that kitchens follow, as keywords of `make_kitchens`."""
        return {
            "cooking": self.cooking,
            "horizon": self.horizon,
            "start": self.start,
            "object_probability": self.object_probability,
        }


class Report(_Part, frozen=True, kw_only=True):
    """How the games are scored; it changes none of them.

    Attributes:
        thresholds: Numbers of soups that a partner's mean return is compared with, in soups of the layout's own value.
    """

    thresholds: tuple[float, ...]

    def __post_init__(self) -> None:
        right = all(0 < soups < math.inf for soups in self.thresholds)
        _check(("thresholds", self.thresholds, right, "numbers of soups above 0"))


class Protocol(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What two scores must share to be comparable, and what is reported of them.

    Attributes:
        name: The protocol's name; part of the default output folder.
        version: Rises whenever a score would change.
        play: What is played.
        report: How the games are scored.
    """

    name: str
    version: int
    play: Play
    report: Report

    def __post_init__(self) -> None:
        check_name(self.name, "name", ProtocolError)
        _check(("version", self.version, self.version >= 0, "a whole number from 0"))

    @property
    def sha256(self) -> str:
        """Hash of `play`, which every random stream depends on."""
        return self.play.sha256

    @property
    def report_sha256(self) -> str:
        """Hash of `report`."""
        return self.report.sha256


def protocol_names() -> tuple[str, ...]:
    """Lists the shipped protocols, the newest first."""
    return _SHELF.names()


def load_protocol(source: str | Path = NEWEST) -> Protocol:
    """Reads a shipped protocol by name, or a YAML file.

    Args:
        source: A name of `protocol_names()`, or the path of a file.

    Raises:
        ProtocolError: No such name or file, or a key is missing, unknown or wrong.
    """
    return read_protocol(read_text(_SHELF.find(source), LONGEST, raises=ProtocolError), str(source))


def read_protocol(text: str, where: str) -> Protocol:
    """Parses a protocol.

    Args:
        text: The YAML.
        where: The file's name, for messages.

    Raises:
        ProtocolError: It is not YAML, or a key is missing, unknown or wrong; names the line.
    """
    document = parse_yaml(text, where, ProtocolError)
    if "play" not in document.data and "layouts" in document.data:
        inner = ", ".join(Play.__struct_fields__)
        raise document.error(
            (),
            f"a protocol has the keys {', '.join(Protocol.__struct_fields__)}; write {inner} "
            "below play, thresholds below report. Scripted partners and floors are in the pool's manifest now",
        )
    return document.convert(Protocol)


def upgrade(settings: Mapping[str, Any]) -> Mapping[str, Any]:
    """Returns a stored protocol in the present form, whatever form it was stored in.

    The first form was flat, and named scripted partners and floors, which the episodes of its scores name themselves.

    Args:
        settings: A protocol as a score.json or a store holds it.
    """
    if "play" in settings:
        return settings
    name = re.sub(r"[^A-Za-z0-9_.-]+", "-", str(settings.get("name", "")))[:100].strip("-.")
    return {
        "name": name or "protocol",
        "version": settings.get("version", 0),
        "play": {key: settings[key] for key in Play.__struct_fields__ if key in settings},
        "report": {key: settings[key] for key in Report.__struct_fields__ if key in settings},
    }


@cache
def _hash(part: _Part) -> str:
    as_read = msgspec.convert(msgspec.to_builtins(part), type(part))  # an int in a float's place becomes one
    plain = {field.name: (getattr(as_read, field.name), field.default) for field in msgspec.structs.fields(part)}
    said = {name: value for name, (value, default) in plain.items() if value != default}
    return hashlib.sha256(msgspec.json.encode(said, order="sorted")).hexdigest()


def _check(*keys: tuple[str, Any, bool, str]) -> None:
    for key, value, right, wanted in keys:
        if not right:
            raise ProtocolError(f"{key} is {list(value) if isinstance(value, tuple) else value!r}; give {wanted}")


def is_text(text: str) -> bool:
    """Returns whether a text is not empty and can be written as UTF-8, which lone surrogates cannot."""
    try:
        return bool(text.encode())
    except UnicodeEncodeError:
        return False

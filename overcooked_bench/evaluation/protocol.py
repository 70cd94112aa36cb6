"""`Protocol`: the file that fixes what is played and how it is scored."""

import hashlib
from pathlib import Path
from typing import Final, Literal

import msgspec

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import check_name, read_text
from overcooked_bench.shelf import Shelf

NEWEST: Final = "dev"
"""The protocol that is played where none is named."""

MOST_STEPS: Final = 10_000
"""The longest episode; all its joint actions are kept in memory."""


class ProtocolError(WrongUse):
    """A protocol cannot be found or read; the message names the file and the key."""


MOST_EPISODES: Final = 10_000
"""Start states for each partner; the list of blocks is kept in memory."""

_SHELF: Final = Shelf("protocol", "overcooked_bench.protocols", ".yaml", ProtocolError, "a YAML file", first=(NEWEST,))


class Protocol(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Everything that two scores must share to be comparable.

    Attributes:
        name: How people call it.
        version: Rises whenever a score would change.
        layouts: Names of layouts, in the order of the table.
        cooking: "auto" or "manual".
        horizon: Steps of an episode, 10,000 at most.
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        pool: Name or folder of the trained partners; null for scripted partners alone.
        partners: Catalogue names of the scripted partners that count.
        floors: Catalogue names of the partners that are played and shown apart.
        seats: Seats of the scored agent.
        episodes: Start states for each partner; each is played from every seat.
        mode: How frozen policies act, "sample" or "greedy".
        thresholds: In soups.
        salt: Mixed into every random stream and into the order of the rows.
    """

    name: str
    version: int
    layouts: tuple[str, ...]
    cooking: Literal["auto", "manual"]
    horizon: int
    start: Literal["random", "standard"]
    object_probability: float
    pool: str | None
    partners: tuple[str, ...]
    floors: tuple[str, ...]
    seats: tuple[Literal[0, 1], ...]
    episodes: int
    mode: Literal["sample", "greedy"]
    thresholds: tuple[float, ...]
    salt: str

    def __post_init__(self) -> None:
        for key, value, right, wanted in (
            ("name", self.name, bool(self.name.strip()), "a name"),
            ("version", self.version, self.version >= 0, "a whole number from 0"),
            ("layouts", self.layouts, 0 < len(set(self.layouts)) == len(self.layouts), "at least one, each once"),
            ("horizon", self.horizon, 1 <= self.horizon <= MOST_STEPS, f"a number of steps from 1 to {MOST_STEPS:,}"),
            ("object_probability", self.object_probability, 0 <= self.object_probability <= 1, "a probability"),
            ("pool", self.pool, self.pool is None or bool(self.pool.strip()), "the name or folder of a pool, or null"),
            ("partners", self.partners, bool(self.partners or self.pool), "a scripted partner, or name a pool"),
            ("seats", self.seats, 0 < len(set(self.seats)) == len(self.seats), "[0, 1], [0] or [1]"),
            ("episodes", self.episodes, 1 <= self.episodes <= MOST_EPISODES, f"a number from 1 to {MOST_EPISODES:,}"),
            ("thresholds", self.thresholds, all(t > 0 for t in self.thresholds), "numbers of soups above 0"),
        ):
            if not right:
                raise ValueError(f"{key} is {list(value) if isinstance(value, tuple) else value!r}; give {wanted}")
        scripted = self.partners + self.floors
        twice = sorted({name for name in scripted if scripted.count(name) > 1})
        if twice:
            raise ValueError(f"partners and floors name {twice[0]!r} twice; name each once, in one of the two")

    @property
    def sha256(self) -> str:
        """Hash of what the file says; comments, line ends and the order of keys do not count."""
        return hashlib.sha256(msgspec.json.encode(self, order="sorted")).hexdigest()


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
    file = _SHELF.find(source)
    return read_protocol(read_text(file, LONGEST, raises=ProtocolError), str(source))


def read_protocol(text: str, where: str) -> Protocol:
    """Parses a protocol.

    Args:
        text: The YAML.
        where: The file's name, for messages.

    Raises:
        ProtocolError: It is not YAML, or a key is missing, unknown or wrong.
    """
    document = parse_yaml(text, where, ProtocolError)
    protocol = document.convert(Protocol)
    check_name(protocol.name, f"{where}: the key `name`", ProtocolError)
    return protocol

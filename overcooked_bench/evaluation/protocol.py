"""`Protocol`: the file that fixes what is played and how it is scored."""

import difflib
import hashlib
from importlib.resources import files
from pathlib import Path
from typing import Final, Literal

import msgspec

from overcooked_bench.errors import WrongUse

NEWEST: Final = "dev"
"""The protocol that is played where none is named."""

MOST_STEPS: Final = 10_000
"""The longest episode; all its joint actions are kept in memory."""

_PACKAGE = "overcooked_bench.protocols"


class ProtocolError(WrongUse):
    """A protocol cannot be found or read; the message names the file and the key."""


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
            ("episodes", self.episodes, self.episodes >= 1, "a number from 1"),
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
    found = {f.name.removesuffix(".yaml") for f in files(_PACKAGE).iterdir() if f.name.endswith(".yaml")}
    return NEWEST, *sorted(found - {NEWEST})


def load_protocol(source: str | Path = NEWEST) -> Protocol:
    """Reads a shipped protocol by name, or a YAML file.

    Args:
        source: A name of `protocol_names()`, or the path of a file.

    Raises:
        ProtocolError: No such name or file, or a key is missing, unknown or wrong.
    """
    text = str(source)
    if text in protocol_names():
        return read_protocol(files(_PACKAGE).joinpath(f"{text}.yaml").read_text("utf-8"), f"protocol {text}")
    path = Path(text)
    if path.is_file():
        try:
            return read_protocol(path.read_text("utf-8"), text)
        except UnicodeDecodeError as error:
            raise ProtocolError(f"{text}: not a text file in UTF-8 ({error}); save it as UTF-8") from error
    near = difflib.get_close_matches(text, protocol_names(), n=1, cutoff=0.4)
    hint = f"did you mean {near[0]!r}? " if near else ""
    raise ProtocolError(
        f"no protocol named {text!r}; {hint}Shipped are {', '.join(protocol_names())}; "
        "the path of a YAML file will do too"
    )


def read_protocol(text: str, where: str) -> Protocol:
    """Parses a protocol.

    Args:
        text: The YAML.
        where: The file's name, for messages.

    Raises:
        ProtocolError: It is not YAML, or a key is missing, unknown or wrong.
    """
    import yaml

    try:
        return msgspec.convert(yaml.safe_load(text), Protocol)
    except yaml.YAMLError as error:
        raise ProtocolError(f"{where}: not YAML: {error}") from error
    except (msgspec.ValidationError, ValueError) as error:
        raise ProtocolError(f"{where}: {_plain(str(error))}") from error


def _plain(message: str) -> str:
    """Says a msgspec message in the words of the file."""
    fields = ", ".join(Protocol.__struct_fields__)
    if "unknown field" in message:
        return f"{message.replace('Object contains unknown field', 'unknown key')}; keys are {fields}"
    return (
        message.replace("Object missing required field", "missing key")
        .replace("Expected `object`", "expected a mapping of keys")
        .replace(" - at `$.", " - at key `")
    )

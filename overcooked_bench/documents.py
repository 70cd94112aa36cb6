r"""Parses YAML and JSON from untrusted files: plain values, bounded in size, depth and numbers.

YAML is read from PyYAML's events, so nothing is built before it is checked: no tags, no references (`&`, `*`, `<<`),
no duplicate keys, no control characters, no infinite or huge numbers, one mapping per file. Errors name file and line.
"""

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar, get_type_hints

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import read_regular, shown
from overcooked_bench.shelf import guess

if TYPE_CHECKING:
    import yaml

LONGEST: Final = 65_536
"""Characters of a YAML file."""

DEEPEST: Final = 8
"""Mappings and lists inside each other in YAML."""

DEEPEST_JSON: Final = 64
"""Objects and arrays inside each other in JSON."""

Steps = tuple[str | int, ...]
"""Keys and indices from the top of a document to a value."""

T = TypeVar("T")

_LONGEST_NUMBER: Final = 40  # characters
_SCALARS: Final = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null")}
_UNPRINTABLE: Final = re.compile("[^\t\n\r\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_DEEP: Final = f"more than {DEEPEST} mappings and lists inside each other"


class DocumentError(WrongUse):
    """A YAML or JSON document cannot be read; the message names the file and the line."""


@dataclass(frozen=True)
class Document:
    """A parsed YAML file.

    Attributes:
        where: The file's name, for messages.
        data: The top mapping.
        lines: The line of each key, list entry and value, from 1; the first line of a text over several lines.
        raises: The class of the errors.
    """

    where: str
    data: dict[str, Any]
    lines: Mapping[Steps, int]
    raises: type[WrongUse] = DocumentError

    def error(self, path: Steps, message: str, offset: int = 0) -> WrongUse:
        """Makes an error that names the line of a value, or of the nearest value above it that exists.

        Args:
            path: The value.
            message: The mistake, and what to write instead.
            offset: Lines below.
        """
        while path and path not in self.lines:
            path = path[:-1]
        return self.raises(f"{self.where}:{self.lines.get(path, 1) + offset}: {message}")

    def convert(self, kind: type[T]) -> T:
        """Converts the mapping to a msgspec struct.

        Raises:
            WrongUse: A key is missing, unknown or wrong; names the line.
        """
        try:
            return msgspec.convert(self.data, kind)
        except (msgspec.ValidationError, ValueError) as error:
            raise self._misfit(str(error), kind) from None

    def _misfit(self, error: str, kind: type) -> WrongUse:
        """Rewrites a msgspec message in the words of the file, with the line of the key concerned."""
        message, _, place = error.partition(" - at ")
        path = tuple(int(index) if index else name for name, index in re.findall(r"\.(\w+)|\[(\d+)\]", place))
        known = _fields(kind, path)
        if named := re.match(r"Object contains unknown field `(.*)`", message):
            keys = f"{guess(named[1], known)}keys are {', '.join(known)}" if known else "remove it"
            return self.error((*path, named[1]), f"unknown key `{named[1]}`; {keys}")
        if named := re.match(r"Object missing required field `(.*)`", message):
            return self.error(path, f"missing key `{named[1]}`")
        if (own := (*path, message.partition(" ")[0])) in self.lines:  # messages of ours begin with the key
            return self.error(own, message)
        key = f" - at key `{place.strip('`').removeprefix('$.')}`" if path else ""
        return self.error(path, message.replace("`object`", "a mapping") + key)


def _fields(kind: type, path: Steps) -> tuple[str, ...]:
    """Returns the keys of the struct at a path; none if it is something else."""
    for step in path:
        hints = get_type_hints(kind) if hasattr(kind, "__struct_fields__") else {}
        kind = hints.get(str(step), object)
    return getattr(kind, "__struct_fields__", ())


def parse_yaml(text: str, where: str, raises: type[WrongUse] = DocumentError) -> Document:
    """Parses YAML: one mapping of texts, numbers, truth values, nulls, lists and mappings.

    Args:
        text: The file's content.
        where: The file's name, for messages.
        raises: The class of the errors.

    Raises:
        WrongUse: Of the class `raises`: it is not YAML, or more than is allowed; names the line.
    """
    import yaml

    if len(text) > LONGEST:
        raise raises(f"{where}:1: {len(text):,} characters; at most {LONGEST:,} are read")
    if strange := _UNPRINTABLE.search(text):
        line = text.count("\n", 0, strange.start()) + 1
        raise raises(f"{where}:{line}: the character {strange[0]!a} is not allowed; remove it")
    loader = yaml.SafeLoader(text)
    reader = _Reader(loader, where, raises)
    try:
        data = reader.document()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise raises(f"{where}:{line}: not YAML: {error.problem or error.context}") from None
    finally:
        loader.dispose()
    return Document(where, data, reader.lines, raises)


class _Reader:
    """Turns events into plain values and records their lines."""

    def __init__(self, loader: "yaml.SafeLoader", where: str, raises: type[WrongUse]) -> None:
        self.lines: dict[Steps, int] = {(): 1}
        self._loader, self._where, self._raises = loader, where, raises
        self._events: Iterator[yaml.Event] = iter(loader.get_event, None)

    def document(self) -> dict[str, Any]:
        import yaml

        next(self._events)  # the start of the stream
        if isinstance(start := next(self._events), yaml.DocumentStartEvent):
            start = next(self._events)
        if not isinstance(start, yaml.MappingStartEvent):
            raise self._wrong(start, "not a mapping; write lines such as `key: value`")
        data: dict[str, Any] = self._value(start, ())
        next(self._events)  # the end of the document
        if not isinstance(more := next(self._events), yaml.StreamEndEvent):
            raise self._wrong(more, "a second document; write one mapping per file")
        return data

    def _value(self, event: "yaml.Event", path: Steps) -> Any:
        import yaml

        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise self._wrong(event, "references (& and *) are not allowed; write the value again")
        tag: str | None = getattr(event, "tag", None)
        if tag is not None:
            raise self._wrong(event, f"the tag {tag!r} is not allowed; values are texts, numbers, lists, mappings")
        if isinstance(event, yaml.ScalarEvent):
            return self._scalar(event, path)
        if len(path) >= DEEPEST:
            raise self._wrong(event, _DEEP)
        return self._list(path) if isinstance(event, yaml.SequenceStartEvent) else self._mapping(path)

    def _mapping(self, path: Steps) -> dict[Any, Any]:
        import yaml

        found: dict[Any, Any] = {}
        while not isinstance(event := next(self._events), yaml.MappingEndEvent):
            key = self._value(event, (*path, "")) if isinstance(event, yaml.ScalarEvent | yaml.AliasEvent) else None
            if not isinstance(key, str | int) or isinstance(key, bool):
                raise self._wrong(event, "a key is a word or a whole number; put anything else in quotes")
            if key in found:
                raise self._wrong(event, f"the key `{key}` is written twice")
            self.lines[(*path, key)] = _line(event)
            found[key] = self._value(next(self._events), (*path, key))
        return found

    def _list(self, path: Steps) -> list[Any]:
        import yaml

        entries: list[Any] = []
        while not isinstance(event := next(self._events), yaml.SequenceEndEvent):
            here = (*path, len(entries))
            self.lines[here] = _line(event)
            entries.append(self._value(event, here))
        return entries

    def _scalar(self, event: "yaml.ScalarEvent", path: Steps) -> Any:
        import yaml

        tag: str = self._loader.resolve(yaml.ScalarNode, event.value, event.implicit)  # type: ignore[no-untyped-call]
        kind = tag.rpartition(":")[2]
        if tag not in _SCALARS:
            raise self._wrong(event, f"{shown(event.value)!r} is a {kind} in YAML; put it in quotes")
        if path in self.lines and event.style in ("|", ">"):
            self.lines[path] = _line(event) + 1
        if kind == "str":
            if strange := _UNPRINTABLE.search(event.value):
                raise self._wrong(event, f"the character {strange[0]!a} is not allowed; remove it")
            return event.value
        if len(event.value) > _LONGEST_NUMBER:
            raise self._wrong(event, f"{shown(event.value, 60)} has {len(event.value)} digits; write a shorter number")
        node = yaml.ScalarNode(tag, event.value)
        try:
            value = self._loader.yaml_constructors[tag](self._loader, node)
        except (ValueError, OverflowError) as error:
            raise self._wrong(event, f"{event.value!r} cannot be read ({error})") from None
        if isinstance(value, float) and not math.isfinite(value):
            raise self._wrong(event, f"{event.value} is not a finite number; write one")
        return value

    def _wrong(self, event: "yaml.Event", message: str) -> WrongUse:
        return self._raises(f"{self._where}:{_line(event)}: {message}")


def _line(event: "yaml.Event") -> int:
    return event.start_mark.line + 1 if event.start_mark else 1


def read_json(file: str | Path, most_bytes: int, kind: type[T], raises: type[WrongUse] = DocumentError) -> T:
    """Reads a JSON file; see `read_regular` and `parse_json`."""
    return parse_json(read_regular(file, most_bytes, raises=raises), str(file), kind, raises)


def parse_json(data: bytes | str, where: str, kind: type[T], raises: type[WrongUse] = DocumentError) -> T:
    """Parses JSON into a type, as `msgspec.json.decode` does.

    Args:
        data: The content, UTF-8.
        where: The file's name, for messages.
        kind: The type to parse into; `Any` for plain values.
        raises: The class of the errors.

    Raises:
        WrongUse: Of the class `raises`: it is not JSON, too deep, or of another type; names the line or the entry.
    """
    content = data.encode("utf-8", "surrogatepass") if isinstance(data, str) else data
    if _too_deep(content):
        raise raises(f"{where}: more than {DEEPEST_JSON} objects and arrays inside each other")
    try:
        return msgspec.json.decode(content, type=kind)
    except msgspec.ValidationError as error:
        raise raises(f"{where}: {error}") from None
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        place = re.search(r" \(byte (\d+)\)$", str(error))
        line = 1 + content.count(b"\n", 0, int(place[1])) if place else 1
        raise raises(f"{where}:{line}: not JSON ({error})") from None


def _too_deep(content: bytes) -> bool:
    if content.count(b"[") + content.count(b"{") <= DEEPEST_JSON:
        return False
    depth = 0
    for mark in re.sub(rb'"(?:[^"\\]|\\.)*+"', b"", content).translate(None, _NO_BRACKETS):
        depth += 1 if mark in b"[{" else -1
        if depth > DEEPEST_JSON:
            return True
    return False


_NO_BRACKETS: Final = bytes(set(range(256)) - set(b"[]{}"))

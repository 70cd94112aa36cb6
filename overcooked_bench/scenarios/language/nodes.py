"""YAML that remembers its lines: plain mappings, lists, texts and numbers, and nothing that could do any harm."""

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import yaml

from overcooked_bench.scenarios.errors import ScenarioError

LONGEST: Final = 65_536
"""Characters of a file."""

DEEPEST: Final = 8
"""Mappings and lists inside each other."""

_DEEP: Final = f"more than {DEEPEST} mappings and lists inside each other"

Path = tuple[str | int, ...]
"""Keys and indices from the top of the file to a value."""

_SCALARS: Final = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null")}


class Document(NamedTuple):
    """A parsed file.

    Attributes:
        where: The file's name, for messages.
        data: The top mapping.
        lines: The line of each key, list entry and value, from 1; for a text over several lines, of its first.
    """

    where: str
    data: dict[str, Any]
    lines: Mapping[Path, int]

    def error(self, path: Path, message: str, offset: int = 0) -> ScenarioError:
        """Makes an error that names the line of a value, or of the nearest thing above it that is there.

        Args:
            path: The value.
            message: What is wrong, and what to write instead.
            offset: Lines below.
        """
        while path and path not in self.lines:
            path = path[:-1]
        return ScenarioError(f"{self.where}:{self.lines.get(path, 1) + offset}: {message}")


def read_document(text: str, where: str) -> Document:
    """Parses YAML without running anything: no tags, no references, no key twice.

    Args:
        text: The file's content, one mapping.
        where: The file's name, for messages.

    Raises:
        ScenarioError: It is not YAML; names the line.
    """
    if len(text) > LONGEST:
        raise ScenarioError(f"{where}:1: {len(text)} characters; a scenario has {LONGEST} at most")
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise ScenarioError(f"{where}:{line}: not YAML: {error.problem or error.context}") from None
    except yaml.YAMLError as error:
        told = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ScenarioError(f"{where}:1: not YAML: {told}") from None
    finally:
        loader.dispose()
    if not isinstance(node, yaml.MappingNode):
        raise ScenarioError(f"{where}:1: not a mapping; write keys such as `id: S01-my-scenario`")
    reader = _Reader(where)
    return Document(where, reader.mapping(node, ()), reader.lines)


class _Loader(yaml.SafeLoader):
    """Gives up on deep files at once: PyYAML would take seconds to fall over them."""

    _depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self._depth += 1
        if self._depth > DEEPEST + 2:
            raise yaml.MarkedYAMLError(problem=_DEEP, problem_mark=self.get_mark())
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node


class _Reader:
    """Turns nodes into plain values and notes their lines."""

    def __init__(self, where: str) -> None:
        self.lines: dict[Path, int] = {(): 1}
        self._where = where
        self._seen: set[int] = set()
        self._scalars = yaml.constructor.SafeConstructor()

    def mapping(self, node: yaml.MappingNode, path: Path) -> dict[Any, Any]:
        found: dict[Any, Any] = {}
        for key_node, value_node in node.value:
            key = self._value(key_node, path) if isinstance(key_node, yaml.ScalarNode) else None
            if not isinstance(key, str | int) or isinstance(key, bool):
                raise self._wrong(key_node, "a key is a word or a whole number; put anything else in quotes")
            if key in found:
                raise self._wrong(key_node, f"the key `{key}` is written twice")
            self.lines[(*path, key)] = key_node.start_mark.line + 1
            found[key] = self._value(value_node, (*path, key))
        return found

    def _value(self, node: yaml.Node, path: Path) -> Any:
        if id(node) in self._seen:
            raise self._wrong(node, "references (& and *) are not allowed; write the value again")
        self._seen.add(id(node))
        if len(path) > DEEPEST:
            raise self._wrong(node, _DEEP)
        if isinstance(node, yaml.ScalarNode):
            if node.tag not in _SCALARS:
                kind = node.tag.rpartition(":")[2]
                raise self._wrong(node, f"{node.value!r} is a {kind} in YAML; put it in quotes")
            if path in self.lines and node.style in ("|", ">"):
                self.lines[path] = node.start_mark.line + 2
            try:
                return self._scalars.construct_object(node)
            except ValueError as error:
                raise self._wrong(node, f"{node.value!r} cannot be read ({error})") from None
        if isinstance(node, yaml.SequenceNode) and node.tag == "tag:yaml.org,2002:seq":
            entries = []
            for index, entry in enumerate(node.value):
                self.lines[(*path, index)] = entry.start_mark.line + 1
                entries.append(self._value(entry, (*path, index)))
            return entries
        if isinstance(node, yaml.MappingNode) and node.tag == "tag:yaml.org,2002:map":
            return self.mapping(node, path)
        raise self._wrong(node, f"the tag {node.tag!r} is not allowed; values are texts, numbers, lists and mappings")

    def _wrong(self, node: yaml.Node, message: str) -> ScenarioError:
        return ScenarioError(f"{self._where}:{node.start_mark.line + 1}: {message}")

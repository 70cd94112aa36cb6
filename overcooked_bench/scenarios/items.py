"""Items, the unit that results count: a scenario from one seat in one mirror image, or both halves of a pair."""

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Final

from overcooked_bench.documents import LONGEST
from overcooked_bench.files import FileError, read_regular
from overcooked_bench.scenarios import CATEGORIES, SUFFIX
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.language.loading import load_scenario
from overcooked_bench.scenarios.scenario import SEATS, Scenario, Situation
from overcooked_bench.shelf import guess

PAIR: Final = "-pair"
HALVES: Final = 2
_PACKAGE: Final = "overcooked_bench.unit_scenarios"

Select = str | Path | Sequence[str | Path] | None
"""Which items: None for all that ship, or one or more of: an item's id, a scenario's id or its beginning up to a `-`, a
category, a family, a tag, a pattern with `*`, the path of a file or a folder."""


@dataclass(frozen=True)
class Item:
    """A test that an agent passes or fails as a whole.

    Attributes:
        id: `<scenario>-seat0`, `<scenario>-seat1-mirrored`, or `<pair>-pair`.
        situations: One situation, or both halves of a pair, each from both seats.
        family: The family for the mean over families.
        tags: Words to select by.
    """

    id: str
    situations: tuple[Situation, ...] = field(repr=False)
    family: str
    tags: tuple[str, ...]

    @property
    def scenarios(self) -> tuple[Scenario, ...]:
        """The scenarios in it, each once."""
        return tuple({situation.scenario.id: situation.scenario for situation in self.situations}.values())

    @property
    def category(self) -> str:
        """One of `CATEGORIES`."""
        return self.situations[0].scenario.category

    @property
    def is_pair(self) -> bool:
        """Whether it is two scenarios that count together."""
        return len(self.situations) > 1

    @property
    def mirrored(self) -> bool:
        """Whether it is played in the mirrored kitchen."""
        return self.situations[0].mirrored

    @property
    def seat(self) -> int | None:
        """A's seat; None for pairs, which are played from both."""
        return None if self.is_pair else self.situations[0].seat

    @property
    def kitchen(self) -> tuple[str, str, bool]:
        """The properties that items must share to be played together: layout, cooking mode, mirrored or not."""
        situation = self.situations[0]
        return situation.layout.name, situation.scenario.cooking, situation.mirrored


def items(scenarios: Iterable[Scenario]) -> list[Item]:
    """Returns all items of some scenarios, sorted by id.

    Raises:
        ScenarioError: An id occurs twice, or a pair does not have two halves of one category.
    """
    known: dict[str, Scenario] = {}
    pairs: dict[str, list[Scenario]] = {}
    found: list[Item] = []
    for scenario in scenarios:
        if known.setdefault(scenario.id, scenario) is not scenario:
            raise ScenarioError(
                f"{scenario.source}: the id {scenario.id} is taken by {known[scenario.id].source}; rename one of them"
            )
        if scenario.pair:
            pairs.setdefault(scenario.pair, []).append(scenario)
            continue
        for seat in SEATS:
            for mirrored in (False, True):
                situation = scenario.seated(seat, mirrored)
                found.append(Item(situation.id, (situation,), scenario.family, scenario.tags))
    for name, halves in pairs.items():
        found.append(_pair(name, halves))
    return sorted(found, key=lambda item: item.id)


def load_scenarios(select: Select = None) -> list[Scenario]:
    """Reads scenarios.

    Args:
        select: As for `load_items`; the scenarios of all items that are chosen.

    Raises:
        ScenarioError: A file is wrong, or nothing is chosen.
    """
    chosen = {scenario.id: scenario for item in load_items(select) for scenario in item.scenarios}
    return [chosen[name] for name in sorted(chosen)]


def load_items(select: Select = None) -> list[Item]:
    """Reads scenarios and returns items, sorted by id.

    Args:
        select: Which items; see `Select`.

    Raises:
        ScenarioError: A file is wrong, or something that is asked for does not exist; says what is near.
    """
    if select is None:
        return list(_shipped())
    wanted = [select] if isinstance(select, str | Path) else list(select)
    paths = [Path(entry) for entry in wanted if _is_path(entry)]
    words = [str(entry) for entry in wanted if not _is_path(entry)]
    own = items(scenario for scenario in read_files(paths)) if paths else []
    for word in words:
        chosen = [item for item in _shipped() if item.id == word] or [item for item in _shipped() if _fits(item, word)]
        if not chosen:
            raise ScenarioError(_nothing(word))
        own += chosen
    return sorted({item.id: item for item in own}.values(), key=lambda item: item.id)


def read_files(paths: Iterable[Path]) -> list[Scenario]:
    """Reads files, and all scenarios directly in folders; a pair's other half is read from the same folder.

    Raises:
        ScenarioError: There is no such file, no scenario in a folder, or a file is wrong.
    """
    found: dict[Path, Scenario] = {}
    for path in paths:
        inside = sorted(path.glob(f"*{SUFFIX}")) if os.path.isdir(path) else [path]
        if not inside:
            raise ScenarioError(f"{path}: no scenarios in this folder; they are files that end in {SUFFIX}")
        for file in inside:
            found.setdefault(file.resolve(), load_scenario(file))
    for scenario in list(found.values()):
        if scenario.pair and sum(other.pair == scenario.pair for other in found.values()) < HALVES:
            for file in sorted(Path(scenario.source).parent.glob(f"*{SUFFIX}")):
                if f"pair: {scenario.pair}".encode() in _content(file):
                    found.setdefault(file.resolve(), load_scenario(file))
    return list(found.values())


def _content(file: Path) -> bytes:
    """Returns the content of a file that may be anything; nothing of one that is no scenario's."""
    try:
        return read_regular(file, LONGEST)
    except FileError:
        return b""


def shipped_folder() -> Path:
    """Returns the folder of the scenarios that ship."""
    return Path(str(files(_PACKAGE)))


@lru_cache(1)
def _shipped() -> tuple[Item, ...]:
    return tuple(items(read_files([shipped_folder()])))


def _pair(name: str, halves: list[Scenario]) -> Item:
    first = halves[0]
    if len(halves) != HALVES:
        told = ", ".join(sorted(scenario.id for scenario in halves))
        raise ScenarioError(f"{first.source}: the pair {name} has {len(halves)} scenarios ({told}); a pair has two")
    for key in ("category", "family"):
        if len({getattr(half, key) for half in halves}) > 1:
            raise ScenarioError(f"{first.source}: the halves of the pair {name} differ in `{key}`; give them one")
    played = tuple(half.seated(seat) for half in sorted(halves, key=lambda s: s.id) for seat in SEATS)
    tags = tuple(sorted({tag for half in halves for tag in half.tags}))
    return Item(name + PAIR, played, first.family, tags)


def _is_path(entry: str | Path) -> bool:
    if isinstance(entry, Path) or entry.endswith(".yaml") or "/" in entry:
        return True
    return os.path.isdir(entry) and not any(_fits(item, entry) for item in _shipped())


def _fits(item: Item, word: str) -> bool:
    names = {item.category, item.family, *item.tags, *(scenario.id for scenario in item.scenarios)}
    return word in names or item.id.startswith(f"{word}-") or fnmatchcase(item.id, word)


def _nothing(word: str) -> str:
    known = sorted({scenario.id for item in _shipped() for scenario in item.scenarios})
    near = guess(word, [*known, *CATEGORIES], 3)
    return (
        f"no scenario fits {word!r}; {near}give an id or its beginning (C04), a category ({', '.join(CATEGORIES)}), a "
        "family, a tag, a pattern with *, or a path"
    )

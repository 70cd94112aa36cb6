"""Reads a `Scenario` from YAML; every error names the file and the line."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from overcooked_bench.agents.behaviours.behaviour import Behaviour
from overcooked_bench.agents.behaviours.parsing import parse_actions, parse_behaviour
from overcooked_bench.documents import LONGEST, Document, parse_yaml
from overcooked_bench.files import read_text
from overcooked_bench.kitchen.codes import MAX_INGREDIENTS, PICTURE_NAMES, RECIPES, STAY, Position
from overcooked_bench.kitchen.errors import LayoutError
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS, Chef, KitchenState, Soup, Thing, row_major
from overcooked_bench.scenarios import CATEGORIES, SUFFIX
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.language.picture import CHEFS, THINGS, PictureError, finished_soup, read_picture
from overcooked_bench.scenarios.language.predicates import PredicateError, parse_any_of
from overcooked_bench.scenarios.language.terms import Condition
from overcooked_bench.scenarios.scenario import Scenario
from overcooked_bench.shelf import guess

NEEDED: Final = ("id", "category", "layout", "kitchen", "A", "B", "accept", "why")
KEYS: Final = (*NEEDED, "family", "tags", "cooking", "pots", "never", "budget", "before", "pair")
CHEF_KEYS: Final = ("facing", "holds")
FACING_NAMES: Final = dict(zip(PICTURE_NAMES, FACINGS, strict=False))
COOKING: Final = ("auto", "manual")
MOST_STEPS: Final = 200
"""The greatest budget, and the longest `before`."""

NAME: Final = r"[A-Za-z0-9][A-Za-z0-9_-]{0,79}"
"""The form of ids, families, pairs and tags."""

POT: Final = r"[123] onions?|ready|cooking [1-9][0-9]{0,2}( left)?"
"""The form of a pot's content."""


def load_scenario(path: str | Path) -> Scenario:
    """Reads a scenario's file.

    Raises:
        ScenarioError: It cannot be read, or something in it is wrong; names the line.
    """
    name = Path(path).name
    if not name.endswith(SUFFIX):
        raise ScenarioError(f"{path}: a scenario's file is its id and {SUFFIX}; rename it, say to S01-mine{SUFFIX}")
    text = read_text(path, LONGEST, raises=ScenarioError)
    return read_scenario(text, str(path), name.removesuffix(SUFFIX))


def read_scenario(text: str, where: str, name: str | None = None) -> Scenario:
    """Reads a scenario.

    Args:
        text: The YAML.
        where: The file's name, for messages.
        name: The id that the file must have; by default any.

    Raises:
        ScenarioError: Something is wrong; names the line.
    """
    document = parse_yaml(text, where, ScenarioError)
    for key in document.data:
        if key not in KEYS:
            raise document.error((key,), _unknown(key, KEYS))
    for key in NEEDED:
        if key not in document.data:
            raise document.error((), f"the key `{key}` is missing; a scenario has at least {', '.join(NEEDED)}")
    reader = _Reader(document)
    layout = reader.layout()
    identity = reader.name("id")
    if name is not None and identity != name:
        raise document.error(("id",), f"the id is {identity!r} and the file is named {name!r}; they have to agree")
    return Scenario(
        id=identity,
        category=reader.choice("category", CATEGORIES),
        family=reader.name("family") if "family" in document.data else identity.partition("-")[0],
        layout=layout,
        cooking=reader.cooking(),
        state=reader.state(layout),
        behaviour=reader.behaviour(layout),
        accept=reader.condition("accept", layout),
        never=reader.condition("never", layout) if "never" in document.data else None,
        budget=reader.budget(),
        before=reader.before(),
        pair=reader.name("pair") if "pair" in document.data else None,
        tags=reader.tags(),
        why=reader.text("why").strip(),
        source=where,
        drawn=reader.script(),
    )


class _Reader:
    """Reads the values of a document one by one."""

    def __init__(self, document: Document) -> None:
        self._document, self._data = document, document.data

    def text(self, *path: str) -> str:
        value: Any = self._data
        for key in path:
            value = value[key]
        if not isinstance(value, str) or not value.strip():
            raise self._document.error(path, f"`{path[-1]}` is {value!r}; write a text")
        return value

    def name(self, *path: str) -> str:
        value = self.text(*path)
        if not re.fullmatch(NAME, value):
            raise self._document.error(path, f"`{path[-1]}` is {value!r}; write letters, digits, - and _ alone")
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str:
        value = self._data[key]
        if value not in choices:
            raise self._document.error((key,), f"`{key}` is {value!r}; choose one of {', '.join(choices)}")
        return str(value)

    def tags(self) -> tuple[str, ...]:
        value = self._data.get("tags", [])
        if not isinstance(value, list) or not all(isinstance(tag, str) and re.fullmatch(NAME, tag) for tag in value):
            raise self._document.error(("tags",), f"`tags` is {value!r}; write a list of words: [sanity]")
        return tuple(value)

    def layout(self) -> Layout:
        text = self.text("layout")
        try:
            layout = Layout.named(text)
        except LayoutError as error:
            raise self._document.error(("layout",), f"`layout`: {error}") from None
        return layout

    def cooking(self) -> str:
        return self.choice("cooking", COOKING) if "cooking" in self._data else COOKING[0]

    def state(self, layout: Layout) -> KitchenState:
        try:
            picture = read_picture(self.text("kitchen"), layout)
        except PictureError as error:
            raise self._document.error(("kitchen",), f"`kitchen`: {error}", error.row) from None
        first, second = (
            self._chef(name, position, layout) for name, position in zip(CHEFS, picture.chefs, strict=True)
        )
        return KitchenState((first, second), row_major({**picture.lying, **self._pots(layout)}))

    def _chef(self, name: str, position: Position, layout: Layout) -> Chef:
        given = self._mapping(name)
        for key in given:
            if name == "A" and key not in CHEF_KEYS:
                raise self._document.error((name, key), _unknown(key, CHEF_KEYS))
        if "facing" not in given:
            raise self._document.error((name,), f"`{name}` has no `facing`; write {' or '.join(FACING_NAMES)}")
        facing = given["facing"]
        if not isinstance(facing, str) or facing not in FACING_NAMES:
            raise self._document.error((name, "facing"), f"`facing` is {facing!r}; write {' or '.join(FACING_NAMES)}")
        holding = given.get("holds")
        if "holds" in given and (not isinstance(holding, str) or holding not in THINGS):
            raise self._document.error(
                (name, "holds"), f"`holds` is {holding!r}; write {' or '.join(THINGS)}, or leave the key out"
            )
        return Chef(position, FACING_NAMES[facing], finished_soup(layout) if holding == "soup" else holding)

    def _pots(self, layout: Layout) -> dict[Position, Thing]:
        cells = layout.positions("P")
        filled: dict[Position, Thing] = {}
        for number, content in (self._mapping("pots") if "pots" in self._data else {}).items():
            path = ("pots", number)
            if type(number) is not int or not 1 <= number <= len(cells):
                raise self._document.error(
                    path, f"no pot {number!r}; they are numbered in reading order, 1 to {len(cells)} in this layout"
                )
            if not isinstance(content, str) or not re.fullmatch(POT, content):
                raise self._document.error(
                    path, f"pot {number} is {content!r}; write `2 onions`, `cooking 8 left` or `ready`"
                )
            filled[cells[number - 1]] = self._soup(layout, content, path)
        return filled

    def _soup(self, layout: Layout, content: str, path: tuple[str | int, ...]) -> Soup:
        ready = finished_soup(layout)
        if content == "ready":
            return ready
        if content.startswith("cooking"):
            left = int(content.split()[1])
            if not 1 <= left <= ready.cook_time:
                raise self._document.error(path, f"{content!r}; a soup cooks {ready.cook_time} steps here")
            return Soup(ready.recipe, ready.cook_time - left, ready.cook_time)
        onions = int(content.split()[0])
        if onions == MAX_INGREDIENTS and self.cooking() == "auto":
            raise self._document.error(
                path, f"{content!r} would be cooking; write `cooking {layout.cook_times[RECIPES.index((3, 0))]} left`"
            )
        return Soup((onions, 0))

    def script(self) -> Mapping[str, Any]:
        """Returns what the file says of B besides hands and direction."""
        return {key: value for key, value in self._mapping("B").items() if key not in CHEF_KEYS}

    def behaviour(self, layout: Layout) -> Behaviour:
        script = self.script()
        try:
            behaviour = parse_behaviour(script)
        except ValueError as error:
            quoted = [("B", key) for key in re.findall(r"(?:^|')(\w+)(?:'|:)", str(error))]
            path = next((path for path in reversed(quoted) if path in self._document.lines), ("B",))
            raise self._document.error(path, f"`B`: {error}") from None
        self._check_places(script, layout, ("B",))
        return behaviour

    def _check_places(self, script: Mapping[str, Any], layout: Layout, path: tuple[str, ...]) -> None:
        """Checks that the cells of a behaviour exist; `then` is a behaviour, or a cell."""
        then = script.get("then")
        named = [("counters", "X", cell) for cell in script.get("counters", ())]
        named += [("cells", " ", cell) for cell in script.get("cells", ())]
        named += [("cell", " ", script["cell"])] if "cell" in script else []
        named += [("then", " ", then)] if isinstance(then, list) else []
        for key, wanted, (x, y) in named:
            inside = 0 <= x < layout.width and 0 <= y < layout.height
            if not inside or layout.tile((x, y)) != wanted:
                there = f"the layout has {layout.tile((x, y))!r} there" if inside else "that is outside the layout"
                what = "counter" if wanted == "X" else "floor"
                raise self._document.error((*path, key), f"`{key}`: [{x}, {y}] is no {what}; {there}")
        if isinstance(then, dict):
            self._check_places(then, layout, (*path, "then"))

    def condition(self, key: str, layout: Layout) -> Condition:
        value = self._data[key]
        texts = value if isinstance(value, list) else [value]
        if not texts or not all(isinstance(text, str) for text in texts):
            raise self._document.error((key,), f"`{key}` is {value!r}; write a condition, or a list of them")
        for index, text in enumerate(texts):
            try:
                parse_any_of([text], layout)
            except PredicateError as error:
                path = (key, index) if isinstance(value, list) else (key,)
                raise self._document.error(path, f"`{key}`: {error}") from None
        return parse_any_of(texts, layout)

    def budget(self) -> int | None:
        value = self._data.get("budget", "auto")
        if value == "auto":
            return None
        if type(value) is not int or not 1 <= value <= MOST_STEPS:
            raise self._document.error(
                ("budget",), f"`budget` is {value!r}; write auto, or a number of steps from 1 to {MOST_STEPS}"
            )
        return value

    def before(self) -> tuple[tuple[int, int], ...]:
        if "before" not in self._data:
            return ()
        given = self._mapping("before")
        played: dict[str, tuple[int, ...]] = {}
        for name, actions in given.items():
            if name not in tuple(CHEFS):
                raise self._document.error(("before", name), _unknown(name, tuple(CHEFS)))
            try:
                played[name] = parse_actions(actions)
            except ValueError as error:
                raise self._document.error(("before", name), f"`{name}`: {error}") from None
        length = max(map(len, played.values()), default=0)
        if not 0 < length <= MOST_STEPS or any(len(actions) != length for actions in played.values()):
            told = " and ".join(f"{len(actions)} of {name}" for name, actions in played.items()) or "none"
            raise self._document.error(
                ("before",),
                f"`before` has {told}; write as many actions of A as of B, {MOST_STEPS} at most, or leave one chef "
                "out, who stays",
            )
        first, second = (played.get(name, (STAY,) * length) for name in CHEFS)
        return tuple(zip(first, second, strict=True))

    def _mapping(self, key: str) -> dict[Any, Any]:
        value = self._data[key]
        if not isinstance(value, dict):
            raise self._document.error((key,), f"`{key}` is {value!r}; write a mapping, such as {_EXAMPLES[key]}")
        return value


_EXAMPLES: Final = {
    "A": "{facing: up, holds: dish}",
    "B": "{facing: right, holds: onion, does: carry}",
    "pots": "{1: 2 onions}",
    "before": "{A: [stay, up], B: [up, interact]}",
}


def _unknown(key: object, known: tuple[str, ...]) -> str:
    return f"unknown key `{key}`; {guess(key, known)}Keys here are {', '.join(known)}"

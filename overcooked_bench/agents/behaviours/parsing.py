"""Behaviours as they are written in scenarios: a mapping with `does` and its parameters."""

from collections.abc import Callable, Mapping
from typing import Any, Final, NamedTuple

from overcooked_bench.agents.behaviours.behaviour import Behaviour
from overcooked_bench.agents.behaviours.helping import helper
from overcooked_bench.agents.behaviours.jobs import Finder, Job, Pace, carry, dumper, lay, onions, plater, receiver
from overcooked_bench.agents.behaviours.timed import FROZEN, Loop, Noisy, Script, Switch
from overcooked_bench.agents.behaviours.walking import Manner
from overcooked_bench.documents import parse_yaml
from overcooked_bench.files import shown
from overcooked_bench.kitchen.codes import ACTION_NAMES, PICTURE_NAMES, Position
from overcooked_bench.shelf import guess

VERSION: Final = 1
"""Of what the behaviours do; it goes up when one acts differently, since results against it compare no more then."""

MOVES: Final = {name: k for names in (PICTURE_NAMES, ACTION_NAMES) for k, name in enumerate(names)}
"""Actions by name, in words of the picture and in those of the compass."""

MOST: Final = 10**9
"""The greatest number of steps, and the greatest seed."""

TIMED: Final = ("from", "until", "then", "noisy")
"""Keys that every behaviour may have besides its own."""


class Kind(NamedTuple):
    """A behaviour that can be named.

    Attributes:
        needs: Keys that have to be there.
        may: Keys that may be there, besides `TIMED`.
        walks: Whether it may have a manner: `insist: true` or `yields: true`; else it is polite.
    """

    needs: tuple[str, ...] = ()
    may: tuple[str, ...] = ()
    walks: bool = False


KINDS: Final[dict[str, Kind]] = {
    "frozen": Kind(),
    "script": Kind(("actions",)),
    "loop": Kind(("actions",)),
    "pace": Kind(("cells",), ("every",), walks=True),
    "goto": Kind(("cell",), walks=True),
    "carry": Kind(walks=True),
    "onions": Kind((), ("item",), walks=True),
    "plater": Kind(walks=True),
    "receiver": Kind(("counters",), walks=True),
    "dumper": Kind(("counters",), ("item",), walks=True),
    "lay": Kind(("counters",), walks=True),
    "helper": Kind((), ("counters",), walks=True),
}
"""All behaviours by the name that `does` gives."""

ERRANDS: Final[dict[str, Finder]] = {
    errand.__name__: errand for errand in (carry, onions, plater, receiver, dumper, lay, helper)
}
"""The jobs by name."""

MANNERS: Final[dict[str, Manner]] = {"insist": "insist", "yields": "yield"}
"""Manners by the key that asks for them."""


def parse_behaviour(mapping: Mapping[str, Any], at: str = "", manner: Manner = "polite") -> Behaviour:
    """Reads a behaviour.

    Args:
        mapping: `does` and its parameters.
        at: Where it stands, for messages.
        manner: Of walks where none is named.

    Raises:
        ValueError: An unknown name or key, or a value that is none; says what to write instead.
    """
    if not isinstance(mapping, Mapping) or "does" not in mapping:
        raise ValueError(f"{at}a behaviour is {mapping!r}; write a mapping such as {{does: carry, insist: true}}")
    name = mapping["does"]
    if not isinstance(name, str) or name not in KINDS:
        raise ValueError(f"{at}does: {name!r} is no behaviour; {guess(name, KINDS)}there are {', '.join(KINDS)}")
    kind = KINDS[name]
    allowed = ("does", *kind.needs, *kind.may, *(MANNERS if kind.walks else ()), *TIMED)
    for key in mapping:
        if key not in allowed:
            raise ValueError(f"{at}{name!r} has no key {key!r}; {guess(key, allowed)}its keys are {', '.join(allowed)}")
    for key in kind.needs:
        if key not in mapping:
            raise ValueError(f"{at}{name!r} needs the key {key!r}")
    manner = _manner(mapping, at, manner)
    then = _then(mapping, at, manner)
    behaviour = _MAKERS[name](mapping, f"{at}{name!r}: ", manner, then)
    start = _whole(mapping.get("from", 0), f"{at}from", 0)
    if "until" in mapping:
        end = _whole(mapping["until"], f"{at}until", start)
        behaviour = Switch(end - start, behaviour, then)
    if start:
        behaviour = Switch(start, FROZEN, behaviour)
    return _noisy(mapping["noisy"], behaviour, at) if "noisy" in mapping else behaviour


def behaviour_from_text(text: str) -> Behaviour:
    """Reads a behaviour from one line: a name of `KINDS` alone, or a mapping in braces as YAML writes it.

    Raises:
        ValueError: It is neither, or `parse_behaviour` refuses it.
    """
    if not text.lstrip().startswith("{"):
        return parse_behaviour({"does": text.strip()})
    return parse_behaviour(parse_yaml(text, "behaviour").data)


def _manner(mapping: Mapping[str, Any], at: str, manner: Manner) -> Manner:
    named = {key: mapping[key] for key in MANNERS if key in mapping}
    for key, value in named.items():
        if not isinstance(value, bool):
            raise ValueError(f"{at}{key}: {value!r}; write true or false")
    asked = [MANNERS[key] for key, value in named.items() if value]
    if len(asked) > 1:
        raise ValueError(f"{at}a chef cannot both insist and yield; give one of {' and '.join(MANNERS)}")
    return asked[0] if asked else "polite" if named else manner


def _then(mapping: Mapping[str, Any], at: str, manner: Manner) -> Behaviour:
    value = mapping.get("then")
    if value is None:
        return FROZEN
    if isinstance(value, str):
        value = {"does": value}
    if isinstance(value, Mapping):
        return parse_behaviour(value, f"{at}then: ", manner)
    return Pace((_cell(value, f"{at}then"),), manner=manner)


def _noisy(value: Any, behaviour: Behaviour, at: str) -> Behaviour:
    if not isinstance(value, Mapping) or set(value) != {"p", "seed"}:
        raise ValueError(f"{at}noisy: {value!r}; write {{p: 0.1, seed: 0}}")
    chance = value["p"]
    if isinstance(chance, bool) or not isinstance(chance, int | float) or not 0 <= chance <= 1:
        raise ValueError(f"{at}noisy: p is {chance!r}; give a probability")
    return Noisy(behaviour, float(chance), _whole(value["seed"], f"{at}noisy: seed", 0))


def _script(mapping: Mapping[str, Any], at: str, manner: Manner, then: Behaviour) -> Behaviour:
    return Script(parse_actions(mapping["actions"], at), then)


def _loop(mapping: Mapping[str, Any], at: str, manner: Manner, then: Behaviour) -> Behaviour:
    return Loop(parse_actions(mapping["actions"], at))


def _pace(mapping: Mapping[str, Any], at: str, manner: Manner, then: Behaviour) -> Behaviour:
    return Pace(_cells(mapping["cells"], f"{at}cells"), _whole(mapping.get("every", 1), f"{at}every", 1), manner)


def _goto(mapping: Mapping[str, Any], at: str, manner: Manner, then: Behaviour) -> Behaviour:
    return Pace((_cell(mapping["cell"], f"{at}cell"),), manner=manner)


def _job(mapping: Mapping[str, Any], at: str, manner: Manner, then: Behaviour) -> Behaviour:
    item = mapping.get("item", "onion")
    items = ("onion", "tomato") if mapping["does"] == "onions" else ("onion", "tomato", "dish")
    if item not in items:
        raise ValueError(f"{at}item: {item!r}; give one of {', '.join(items)}")
    counters = _cells(mapping["counters"], f"{at}counters") if "counters" in mapping else ()
    return Job(ERRANDS[mapping["does"]], manner, counters, item, then)


_Maker = Callable[[Mapping[str, Any], str, Manner, Behaviour], Behaviour]
_MAKERS: Final[dict[str, _Maker]] = {
    "frozen": lambda *_: FROZEN,
    "script": _script,
    "loop": _loop,
    "pace": _pace,
    "goto": _goto,
    **dict.fromkeys(ERRANDS, _job),
}


def parse_actions(value: Any, at: str = "") -> tuple[int, ...]:
    """Reads a list of actions: up, down, left, right, stay, interact; `stay*10` is ten of them.

    Args:
        value: The list.
        at: Where it stands, for messages.

    Raises:
        ValueError: No list, or a word that is no action.
    """
    if not isinstance(value, list | tuple) or not value:
        raise ValueError(f"{at}actions are {value!r}; write a list such as [up, interact, stay*3]")
    actions: list[int] = []
    for word in value:
        name, star, times = str(word).partition("*")
        if name not in MOVES or (star and not (times.isdecimal() and 0 < int(times) < 1000)):
            raise ValueError(f"{at}{word!r} is no action; {guess(name, MOVES)}write {', '.join(PICTURE_NAMES)}")
        actions += [MOVES[name]] * (int(times) if star else 1)
    return tuple(actions)


def _cells(value: Any, at: str) -> tuple[Position, ...]:
    if not isinstance(value, list | tuple) or not value:
        raise ValueError(f"{at}: {value!r}; write a list of cells such as [[2, 1], [2, 2]], column then row, from 0")
    return tuple(_cell(entry, at) for entry in value)


def _cell(value: Any, at: str) -> Position:
    if not isinstance(value, list | tuple) or len(value) != 2 or not all(type(part) is int for part in value):
        raise ValueError(f"{at}: {value!r} is no cell; write [column, row], from 0")
    return value[0], value[1]


def _whole(value: Any, at: str, least: int) -> int:
    if type(value) is not int or not least <= value <= MOST:
        raise ValueError(f"{at}: {shown(value)}; give a whole number from {least} to {MOST:,}")
    return value

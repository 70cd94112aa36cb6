"""The JSON Schema of scenario files, for editors: `python -m overcooked_bench.scenarios.language.schema` prints it.

`unit_scenarios/schema.json` is its output. The loader checks what depends on the layout: picture, pots, cells,
conditions.
"""

import json
from typing import Any, Final

from overcooked_bench.agents.behaviours.parsing import KINDS, MANNERS, MOVES, TIMED
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.language.loading import (
    CHEF_KEYS,
    COOKING,
    FACING_NAMES,
    KEYS,
    MOST_STEPS,
    NAME,
    NEEDED,
    POT,
)
from overcooked_bench.scenarios.language.picture import CHEFS, THINGS
from overcooked_bench.scenarios.language.predicates import LONGEST

_WHOLE: Final = {"type": "integer", "minimum": 0}
_CELL: Final = {"type": "array", "items": _WHOLE, "minItems": 2, "maxItems": 2, "description": "[column, row], from 0"}
_CELLS: Final = {"type": "array", "items": _CELL, "minItems": 1}
_ACTIONS: Final = {
    "type": "array",
    "items": {"type": "string", "pattern": rf"^({'|'.join(MOVES)})(\*[0-9]{{1,3}})?$"},
    "minItems": 1,
    "description": "actions one by one; stay*3 is three of them",
}
_NAME: Final = {"type": "string", "pattern": f"^{NAME}$"}
_TEXT: Final = {"type": "string", "minLength": 1}
_CONDITION: Final = {
    **{"type": "string", "minLength": 1, "maxLength": LONGEST},
    "examples": ["B.pot >= 1 and A.holds(dish)", "pot(1).n == 3", "counter(2, 0) == onion"],
}
_CONDITIONS: Final = {
    "anyOf": [_CONDITION, {"type": "array", "items": _CONDITION, "minItems": 1}],
    "description": "a condition, or a list of conditions of which one has to hold",
}
_FACING: Final = {"enum": list(FACING_NAMES)}
_HOLDS: Final = {"enum": list(THINGS)}
_BEHAVIOUR: Final = {"$ref": "#/$defs/behaviour"}

_PARAMETERS: Final[dict[str, Any]] = {
    "does": {"enum": list(KINDS), "description": "what B does"},
    "actions": _ACTIONS,
    "cells": _CELLS,
    "cell": _CELL,
    "counters": _CELLS,
    "every": {"type": "integer", "minimum": 1, "description": "steps at each cell"},
    "item": {"enum": [thing for thing in THINGS if thing != "soup"]},
    **{manner: {"type": "boolean"} for manner in MANNERS},
    "from": {**_WHOLE, "description": "first step; B stands still before"},
    "until": {**_WHOLE, "description": "first step at which B no longer does it"},
    "then": {"anyOf": [{"enum": list(KINDS)}, _CELL, _BEHAVIOUR], "description": "what B does afterwards"},
    "noisy": {
        "type": "object",
        "properties": {"p": {"type": "number", "minimum": 0, "maximum": 1}, "seed": _WHOLE},
        "required": ["p", "seed"],
        "additionalProperties": False,
    },
}


def json_schema() -> dict[str, Any]:
    """Returns the schema."""
    chef = {"facing": _FACING, "holds": _HOLDS}
    properties: dict[str, Any] = {
        "id": {**_NAME, "description": "the file's name without its suffix"},
        "category": {"enum": list(CATEGORIES)},
        "layout": {**_TEXT, "description": "a shipped layout's name, or a grid's rows"},
        "kitchen": {
            **_TEXT,
            "description": "the layout's rows; A and B are on floor cells, and o, t, d and s (onion, tomato, dish, "
            "soup) on counters",
        },
        "A": _object(chef, ["facing"], "the tested agent"),
        "B": {**_behaviour(chef), "description": "the partner"},
        "accept": _CONDITIONS,
        "why": {**_TEXT, "description": "what a robust agent does here, and why"},
        "family": {
            **_NAME,
            "description": "the family for the mean over families; by default the id up to its first -",
        },
        "tags": {"type": "array", "items": _NAME},
        "cooking": {"enum": list(COOKING)},
        "pots": {
            "type": "object",
            "patternProperties": {"^[1-9][0-9]*$": {"type": "string", "pattern": f"^({POT})$"}},
            "additionalProperties": False,
            "description": "pots in reading order, from 1: `2 onions`, `cooking 8 left` or `ready`",
        },
        "never": _CONDITIONS,
        "budget": {"anyOf": [{"const": "auto"}, {"type": "integer", "minimum": 1, "maximum": MOST_STEPS}]},
        "before": _object(dict.fromkeys(CHEFS, _ACTIONS), [], "joint actions before A is asked for the first time"),
        "pair": {**_NAME, "description": "shared by two scenarios that pass together or not at all"},
    }
    assert set(properties) == set(KEYS)
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A scenario of overcooked-bench",
        **_object({key: properties[key] for key in KEYS}, list(NEEDED), "one cooperation unit test"),
        "$defs": {"behaviour": _behaviour({})},
    }


def schema_text() -> str:
    """Returns the schema as the text of its file."""
    return json.dumps(json_schema(), indent=2) + "\n"


def _object(properties: dict[str, Any], required: list[str], description: str) -> dict[str, Any]:
    return {
        "type": "object",
        "description": description,
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _behaviour(more: dict[str, Any]) -> dict[str, Any]:
    """Returns the schema of a behaviour, together with other keys: each kind has keys of its own."""
    kinds = []
    for name, kind in KINDS.items():
        allowed = ["does", *kind.needs, *kind.may, *(MANNERS if kind.walks else ()), *TIMED, *more]
        kinds.append(
            {
                "if": {"properties": {"does": {"const": name}}, "required": ["does"]},
                "then": {"propertyNames": {"enum": allowed}, "required": list(kind.needs)},
            }
        )
    required = [key for key in CHEF_KEYS[:1] if key in more]
    return {**_object({**more, **_PARAMETERS}, [*required, "does"], "what B does"), "allOf": kinds}


if __name__ == "__main__":
    print(schema_text(), end="")

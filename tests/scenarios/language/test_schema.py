import json

import pytest
import yaml
from jsonschema import Draft202012Validator

from overcooked_bench.scenarios.items import shipped_folder
from overcooked_bench.scenarios.language.schema import json_schema, schema_text
from tests.scenarios.language.test_loading import RICH, WRONG
from tests.scenarios.writing import POT, YIELD, edited


def faults(text: str) -> list[str]:
    data = json.loads(json.dumps(yaml.safe_load(text)))  # pots by text, as JSON has them
    return [error.message for error in Draft202012Validator(json_schema()).iter_errors(data)]


def test_the_schema_is_one():
    Draft202012Validator.check_schema(json_schema())


def test_the_shipped_file_is_what_the_loader_says():
    written = (shipped_folder() / "schema.json").read_text("utf-8")
    assert written == schema_text(), (
        "run: python -m overcooked_bench.scenarios.language.schema > unit_scenarios/schema.json"
    )


@pytest.mark.parametrize("text", [YIELD, POT, RICH], ids=["yield", "pot", "rich"])
def test_what_the_loader_accepts_is_accepted(text):
    assert faults(text) == []


def test_what_ships_is_accepted():
    for file in sorted(shipped_folder().glob("*.scenario.yaml")):
        assert faults(file.read_text("utf-8")) == [], file.name


LAYOUT_DECIDES = {"layout", "layout_file", "no_counter", "outside", "then", "pot_number", "pot_full", "pot_long"}
LANGUAGE = {"accept", "never"}
NOT_JSON = {"null_character", "escape", "no_integer", "no_truth"}
NOT_JSON |= {"twice", "tag", "date", "reference", "unclosed", "bottomless", "before_length", "before_empty"}
SEEN = sorted(set(WRONG) - LAYOUT_DECIDES - LANGUAGE - NOT_JSON)


@pytest.mark.parametrize("name", SEEN)
def test_what_is_wrong_without_a_look_at_the_layout_is_refused(name):
    assert faults(edited(**WRONG[name][0]))

"""The two readers of files that nobody vouches for: what they accept is plain, and what they refuse has a line."""

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import overcooked_bench
from overcooked_bench.documents import DEEPEST, DEEPEST_JSON, LONGEST, DocumentError, parse_json, parse_yaml, read_json
from overcooked_bench.errors import WrongUse

ROOT = Path(overcooked_bench.__file__).parents[1]
SHIPPED = [file for part in ("protocols", "unit_scenarios", "baselines") for file in (ROOT / part).rglob("*.yaml")]

KEYS = st.from_regex(r"[a-z]{1,8}", fullmatch=True) | st.integers(0, 99)
SCALARS = (
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(-1e9, 1e9)
    | st.text(st.characters(exclude_categories=["Cc", "Cs", "Cn", "Co", "Zl", "Zp"]))
)
LEAVES = st.lists(SCALARS, max_size=3) | st.dictionaries(KEYS, SCALARS, max_size=3)
TREES = st.dictionaries(KEYS, SCALARS | LEAVES | st.lists(LEAVES, max_size=3), max_size=4)


def test_shipped_files_say_what_pyyaml_says_they_do():
    assert len(SHIPPED) > 70
    for file in SHIPPED:
        assert parse_yaml(file.read_text("utf-8"), file.name).data == yaml.safe_load(file.read_text("utf-8"))


@given(TREES, st.booleans())
def test_plain_trees_come_back(tree, flow):
    text = yaml.safe_dump(tree, default_flow_style=flow, allow_unicode=True)
    assert parse_yaml(text, "f").data == yaml.safe_load(text)


BAD_YAML = {
    "a control character": ("a: 1\nb: \0", "f:2: the character '\\\\x00' is not allowed"),
    "an escaped one": ('a: 1\nb: "\\e[31m"', "f:2: the character '\\\\x1b'"),
    "half a surrogate pair": ('a: "\\ud800"', "f:1: the character '\\\\ud800'"),
    "an integer tag": ("a: !!int ''", "f:1: the tag"),
    "a truth tag": ("a: !!bool x", "f:1: the tag"),
    "a time tag": ("a: !!timestamp x", "f:1: the tag"),
    "a Python tag": ("a: !!python/object/apply:os.system [ls]", "f:1: the tag"),
    "a tag of a key": ("!!str a: 1", "f:1: the tag"),
    "brackets": ("a: " + "[" * 1000, "f:1: more than 8"),
    "dashes": ("a:\n " + "- " * 1000, "f:2: more than 8"),
    "an anchor": ("a: &x 1", "f:1: references"),
    "an alias": ("a: 1\nb: [*x]", "f:2: references"),
    "a merge key": ("<<: {a: 1}", "f:1: '<<' is a merge"),
    "a key twice": ("a: 1\n\na: 2", "f:3: the key `a` is written twice"),
    "a list as key": ("? [a]\n: 1", "f:1: a key is a word or a whole number"),
    "a truth as key": ("yes: 1", "f:1: a key is a word or a whole number"),
    "infinity": ("a: .inf", "f:1: .inf is not a finite number"),
    "a number beyond infinity": ("a: 1.0e+999", "f:1: 1.0e.999 is not a finite number"),
    "no number": ("a: .nan", "f:1: .nan is not a finite number"),
    "many digits": ("a: " + "9" * 5000, "f:1: .* has 5000 digits"),
    "no digits": ("a: 0b_", "f:1: '0b_' cannot be read"),
    "a date": ("a: 2020-01-01", "f:1: '2020-01-01' is a timestamp in YAML; put it in quotes"),
    "two documents": ("a: 1\n---\nb: 1", "f:2: a second document"),
    "nothing": ("", "f:1: not a mapping"),
    "a list": ("- a", "f:1: not a mapping"),
    "an open quote": ("a: 1\nb: 'x", "f:[12]: not YAML"),
    "too long": ("a: " + "x" * LONGEST, "f:1: 65,539 characters"),
}


@pytest.mark.parametrize(("text", "message"), BAD_YAML.values(), ids=BAD_YAML.keys())
def test_what_is_not_plain_is_refused_with_its_line(text, message):
    with pytest.raises(DocumentError, match=message):
        parse_yaml(text, "f")


def test_the_deepest_document():
    deep = "a: " + "[" * (DEEPEST - 1) + "1" + "]" * (DEEPEST - 1)
    assert parse_yaml(deep, "f").lines[("a", *([0] * (DEEPEST - 1)))] == 1


class Inner(msgspec.Struct, forbid_unknown_fields=True):
    b: int


class Outer(msgspec.Struct, forbid_unknown_fields=True):
    a: list[Inner]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a:\n- b: 1\n- b: x", r"f:3: Expected `int`, got `str` - at key `a\[1\].b`"),
        ("a:\n- b: 1\n  c: 2", "f:3: unknown key `c`"),
        ("a:\n- b: 1\n- {}", "f:3: missing key `b`"),
        ("a: []\nc: 2", "f:2: unknown key `c`; .*keys are a"),
    ],
)
def test_a_wrong_entry_has_a_line(text, message):
    with pytest.raises(DocumentError, match=message):
        parse_yaml(text, "f").convert(Outer)


@given(TREES.map(lambda tree: json.loads(json.dumps(tree))))
def test_json_comes_back(tree):
    assert parse_json(json.dumps(tree), "f", Any) == tree


@pytest.mark.parametrize(
    "data",
    [
        "[" * 1500,
        '{"a":' * 1500,
        "[NaN]",
        "[Infinity]",
        "[1e999]",
        '["\\ud800"]',
        '"\ud800"',
        "{",
        "[1] 2",
        b"\xff",
        b'"\xff"',
        "",
    ],
    ids=repr,
)
def test_what_is_not_json_is_refused(data):
    with pytest.raises(DocumentError, match=r"^f"):
        parse_json(data, "f", Any)


def test_brackets_in_texts_are_not_deep():
    text = '["' + "[" * 1000 + '\\"' + "{" * 1000 + '"]'
    assert parse_json(text, "f", list[str]) == json.loads(text)
    deep = "[" * DEEPEST_JSON + "]" * DEEPEST_JSON
    assert parse_json(deep, "f", Any) == json.loads(deep)
    with pytest.raises(DocumentError, match="more than 64"):
        parse_json(f"[{deep}]", "f", Any)


def test_a_json_file_has_a_line_and_the_class_that_was_asked_for(tmp_path):
    class Mine(WrongUse):
        pass

    (tmp_path / "f.json").write_text("[1,\n2,\nx]")
    with pytest.raises(Mine, match=r"f\.json:3: not JSON"):
        read_json(tmp_path / "f.json", 100, Any, Mine)
    with pytest.raises(Mine, match="Expected `int`"):
        parse_json('["a"]', "f", list[int], Mine)

"""Prose uses the field's words: no comment, docstring, message or page contains a phrase of `words.txt`."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
INSTEAD = dict(
    line.split(" -> ", 1)
    for line in (ROOT / "tests" / "words.txt").read_text("utf-8").splitlines()
    if line and not line.startswith("#")
)
LISTED = {re.compile(rf"(?<![\w-])(?:{phrase})(?![\w-])", re.IGNORECASE): phrase for phrase in INSTEAD}
CODE = re.compile(r"```.*?```|``.*?``|`[^`\n]*`", re.DOTALL)
FOLDERS = ("overcooked_bench", "baselines", "protocols", "unit_scenarios", "docs")


def of_python(text: str) -> Iterator[tuple[int, str]]:
    """Yields the line and text of each docstring and comment, and of each string of three words or more."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value.split()) >= 3:
            yield node.lineno, node.value
    block: list[tuple[int, str]] = []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            block.append((token.start[0], token.string.lstrip("#: ")))
        elif token.type not in (tokenize.NL, tokenize.NEWLINE) and block:
            yield block[0][0], " ".join(words for _, words in block)
            block = []


def of_markdown(text: str) -> Iterator[tuple[int, str]]:
    """Yields the line and text of each paragraph, without its code."""
    without = CODE.sub(lambda code: "\n" * code[0].count("\n") or "x", text)
    for paragraph in re.finditer(r"(?:[^\n]+\n?)+", without):
        yield without.count("\n", 0, paragraph.start()) + 1, paragraph[0]


def of_yaml(text: str) -> Iterator[tuple[int, str]]:
    """Yields the line and text of each comment, and of each `why`."""
    for number, line in enumerate(text.splitlines(), 1):
        if prose := re.search(r"(?:^|\s)#\s*(.*)|^\s*why:\s*(.*)", line):
            yield number, prose[1] or prose[2]


READERS = {".py": of_python, ".md": of_markdown, ".yaml": of_yaml}


def files() -> list[Path]:
    """Returns every file whose prose is read by users or contributors."""
    found = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*") if path.suffix in READERS]
    return sorted([*found, *ROOT.glob("*.md"), *(ROOT / "tests" / "benchmarks").rglob("*.md")])


def faults(path: Path, text: str) -> list[str]:
    """Returns one line for each listed phrase in a file."""
    found = []
    for line, prose in READERS[path.suffix](text):
        plain = " ".join(CODE.sub("x", prose).split())
        for pattern, phrase in LISTED.items():
            found += [f"{path}:{line}: {said[0]!r}; write {INSTEAD[phrase]}" for said in pattern.finditer(plain)]
    return found


@pytest.mark.parametrize("room", sorted({path.relative_to(ROOT).parent for path in files()}), ids=str)
def test_prose_uses_the_words_of_the_field(room):
    for path in files():
        name = path.relative_to(ROOT)
        if name.parent == room:
            assert faults(name, path.read_text("utf-8")) == []


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("a.py", '"""Gives a name."""\n', "Gives"),
        ("a.py", "x = 1  # as it was\n# told\n", "told"),
        ("a.py", 'raise ValueError(f"{x} lies there, twice")\n', "lies"),
        ("a.md", "Points\nan episode.\n", "Points an episode"),
        ("a.yaml", "a: 1\nwhy: B begins anew.\n", "anew"),
        ("a.yaml", "# Four agents a layout\n", "agents a layout"),
    ],
)
def test_a_listed_phrase_is_found(name, text, said):
    (fault,) = faults(Path(name), text)
    assert repr(said) in fault


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.py", 'told = {"lies": 1}\n"""Returns what `told` holds."""\n'),
        ("a.md", "Run\n```sh\npython told.py\n```\nor `lies`.\n"),
        ("a.yaml", "told: anew\n"),
    ],
)
def test_code_is_not_prose(name, text):
    assert faults(Path(name), text) == []

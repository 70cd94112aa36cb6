"""Reads `agent.py` as text: what can be seen without running it."""

import ast
import warnings
from collections.abc import Iterator
from typing import Final

from overcooked_bench.agents.submissions.content import ENTRY
from overcooked_bench.agents.submissions.loading import MAKE_AGENT

_SEEDS: Final = "TRAINING_SEEDS"


def code_problems(source: bytes, training_seeds: int | None) -> list[str]:
    """Lists what is wrong with an agent.py, without running it.

    Args:
        source: Its content.
        training_seeds: What submission.yaml says; None if that is wrong itself.

    Returns:
        Messages that begin with file and line.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # such as invalid escapes, which the author sees when running it
            tree = ast.parse(source)
    except SyntaxError as error:
        return [f"{ENTRY}:{error.lineno or 1}: not Python: {error.msg}"]
    except (ValueError, RecursionError, MemoryError) as error:
        return [f"{ENTRY}:1: not Python: {error or 'too deeply nested'}"]
    found = []
    if MAKE_AGENT not in {name for node in tree.body for name, _ in _defined(node)}:
        found.append(f"{ENTRY}:1: defines no {MAKE_AGENT}; write `def {MAKE_AGENT}(layout, training_seed):`")
    return found + _seeds_problems(tree, training_seeds)


def _seeds_problems(tree: ast.Module, said: int | None) -> list[str]:
    places = [(node, value) for node in ast.walk(tree) for name, value in _defined(node) if name == _SEEDS]
    if not places:
        if said in (None, 1):
            return []
        return [f"{ENTRY}:1: defines no {_SEEDS}, which means 1; write `{_SEEDS} = {said}`, as in submission.yaml"]
    node, value = places[-1]
    line, wanted = getattr(node, "lineno", 1), said or 1
    if len(places) > 1 or node not in tree.body:
        return [f"{ENTRY}:{line}: sets {_SEEDS} more than once or inside something; write `{_SEEDS} = {wanted}` once"]
    if not isinstance(value, ast.Constant) or type(value.value) is not int:
        return [f"{ENTRY}:{line}: {_SEEDS} is not a plain number; write `{_SEEDS} = {wanted}`"]
    if said is not None and value.value != said:
        return [
            f"{ENTRY}:{line}: {_SEEDS} is {value.value}, and submission.yaml says `training_seeds: {said}`; "
            "write the same number in both"
        ]
    return []


def _defined(node: ast.AST) -> Iterator[tuple[str, ast.expr | None]]:
    """Yields the names that a statement defines, with the value if it is an assignment to that name alone."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        yield node.name, None
    elif isinstance(node, ast.Import | ast.ImportFrom):
        for alias in node.names:
            yield alias.asname or alias.name, None
    elif isinstance(node, ast.Assign | ast.AnnAssign | ast.AugAssign):
        for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
            for part in ast.walk(target):
                if isinstance(part, ast.Name):
                    yield part.id, node.value if part is target and not isinstance(node, ast.AugAssign) else None

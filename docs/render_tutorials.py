"""Runs the tutorials, and writes each of them as a notebook with its output and as a page.

    uv run --extra docs python docs/render_tutorials.py                 # all of docs/tutorials
    uv run --extra docs python docs/render_tutorials.py own_kitchen     # one of them
    uv run --extra docs python docs/render_tutorials.py --short         # runs all as the tests do, and writes nothing
    uv run --extra docs python docs/render_tutorials.py --text          # only text has changed: keeps all output

A tutorial is a script in jupytext's percent format. `NAME.ipynb` is made by running it in an empty folder, and
`NAME.md` from the notebook, so every output on a page is what a run printed. Running a training again on another
machine may print other numbers; making a page of its notebook is exact. A line `steps = 400_000  # short: 2_000` has
the value 2_000 in the tests; readers of pages and notebooks do not see the comment.
"""

import argparse
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any, Final

import jupytext
import nbformat

TUTORIALS: Final = Path(__file__).parent / "tutorials"
_SHORT: Final = re.compile(r"^([\w, ]+ = ).*?  # short: (.*)$", re.MULTILINE)
_COMMENT: Final = re.compile(r"  # short: .*$", re.MULTILINE)


def names() -> list[str]:
    """Lists the tutorials."""
    return sorted(file.stem for file in TUTORIALS.glob("*.py"))


def script_of(name: str) -> str:
    """Returns a tutorial's script."""
    return (TUTORIALS / f"{name}.py").read_text("utf-8")


def shortened(script: str) -> str:
    """Returns a tutorial's script with the values of the tests."""
    return _SHORT.sub(r"\1\2", script)


def run(script: str, folder: Path, short: bool = False) -> list[str]:
    """Runs a tutorial, cell by cell.

    Args:
        script: In percent format.
        folder: Where it runs, and writes its files.
        short: Whether to take the values of the tests.

    Returns:
        What each cell of code printed.
    """
    names: dict[str, Any] = {"__name__": "__main__"}
    printed = []
    with _inside(folder):
        for number, source in enumerate(_code(shortened(script) if short else script)):
            with redirect_stdout(StringIO()) as out:
                exec(compile(source, f"<cell {number} of code>", "exec"), names)
            printed.append(out.getvalue())
    return printed


def notebook(script: str, printed: list[str]) -> str:
    """Returns the notebook of a script, with what its cells of code printed."""
    made = jupytext.reads(_COMMENT.sub("", script), fmt="py:percent")
    made.metadata = nbformat.from_dict(
        {
            "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        }
    )
    made.nbformat, made.nbformat_minor = 4, 5
    outputs = iter(printed)
    for number, cell in enumerate(made.cells):
        cell.id, cell.metadata = f"cell-{number}", {}
        if cell.cell_type == "code":
            text = next(outputs)
            cell.outputs = [nbformat.v4.new_output("stream", name="stdout", text=text)] if text else []
    nbformat.validate(made)
    written: str = nbformat.writes(made)
    return written + "\n"


def page(text: str, name: str) -> str:
    """Returns the page of a notebook.

    Args:
        text: The notebook, with outputs.
        name: The tutorial's name, which its files have.
    """
    parts = []
    for cell in nbformat.reads(text, as_version=4).cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        parts.append(f"```python\n{cell.source}\n```")
        parts += [f"```text\n{output.text.rstrip()}\n```" for output in cell.outputs]
    title, *rest = parts[0].split("\n", 1)
    files = f"*This page as a [script]({name}.py) and as a [notebook]({name}.ipynb).*"
    return "\n\n".join([title, files, *(part.strip("\n") for part in rest), *parts[1:]]) + "\n"


def recorded(name: str) -> list[str]:
    """Returns what each cell of code printed when a tutorial's notebook was made."""
    cells = nbformat.read(TUTORIALS / f"{name}.ipynb", as_version=4).cells
    return ["".join(output.text for output in cell.outputs) for cell in cells if cell.cell_type == "code"]


def render(name: str, text_only: bool = False) -> None:
    """Writes a tutorial's notebook and its page.

    Args:
        name: The tutorial.
        text_only: Whether to keep the output of its notebook instead of running it again.
    """
    with tempfile.TemporaryDirectory() as folder:
        printed = recorded(name) if text_only else run(script_of(name), Path(folder))
    text = notebook(script_of(name), printed)
    (TUTORIALS / f"{name}.ipynb").write_text(text, "utf-8")
    (TUTORIALS / f"{name}.md").write_text(page(text, name), "utf-8")


def main() -> None:
    """Renders the tutorials that the command line names."""
    parser = argparse.ArgumentParser(description="Run tutorials, and write their notebooks and pages.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(names())} (default: all)")
    parser.add_argument("--short", action="store_true", help="run with the settings of the tests, and write nothing")
    parser.add_argument("--text", action="store_true", help="keep the output of the notebooks, and run nothing")
    options = parser.parse_args()
    for name in options.names or names():
        print(f"{name} ...", file=sys.stderr)
        if options.short:
            with tempfile.TemporaryDirectory() as folder:
                print("".join(run(script_of(name), Path(folder), short=True)))
        else:
            render(name, options.text)


def _code(script: str) -> Iterator[str]:
    cells = jupytext.reads(script, fmt="py:percent").cells
    return (cell.source for cell in cells if cell.cell_type == "code")


@contextmanager
def _inside(folder: Path) -> Iterator[None]:
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


if __name__ == "__main__":
    main()

"""Sphinx's configuration: `uv run sphinx-build -W docs build/docs` builds the site."""

import shutil
import sys
from importlib.metadata import version as installed
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))

from docs.generate.docstrings import as_rst  # noqa: E402
from docs.generate.elsewhere import expanded, without_missing  # noqa: E402

project = "overcooked_bench"
author = "The overcooked_bench authors"
copyright = f"{author}, MIT licence"
version = release = installed("overcooked-bench")

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["generate"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
default_role = "code"
smartquotes_action = "D"  # dashes alone

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_custom_sections = ["Source"]
python_maximum_signature_line_length = 100

html_theme = "furo"
html_title = "overcooked_bench"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_theme_options = {"navigation_with_keys": True}
html_copy_source = False
html_show_sourcelink = False


def _read(app: Any, docname: str, source: list[str]) -> None:
    source[0] = expanded(source[0], f"docs/{docname}.md", ROOT)
    if docname == "index":
        source[0] = without_missing(source[0], ROOT / "docs")
    if docname == "reference/api" and app.tags.has("quick"):
        source[0] = "# Python\n"  # it takes longer than all other pages together


def _docstring(_app: Any, _what: str, _name: str, _object: object, _options: object, lines: list[str]) -> None:
    lines[:] = as_rst(lines)


def _copy_leaderboard(app: Any, failed: Exception | None) -> None:
    if failed is None and app.builder.format == "html":
        shutil.copytree(ROOT / "docs/leaderboard", Path(app.outdir) / "leaderboard", dirs_exist_ok=True)


def setup(app: Any) -> dict[str, bool]:
    """Adds what Sphinx does not do by itself: pages that stand elsewhere, docstrings in Markdown, the leaderboard."""
    app.connect("source-read", _read)
    app.connect("build-finished", _copy_leaderboard)
    app.connect("autodoc-process-docstring", _docstring, priority=100)  # before napoleon
    return {"parallel_read_safe": True}

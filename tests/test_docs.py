"""The documentation site: generated pages are those in the repository, and Sphinx builds them without a warning."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from docs.generate import all_pages
from docs.generate.docstrings import as_rst
from docs.generate.elsewhere import PAGES, expanded, relinked, without_missing
from docs.generate.kitchens import pictures
from overcooked_bench.kitchen.layout import layout_names

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
AGAIN = "`uv run python -m docs.generate` writes the generated pages again"


def test_generated_pages_are_written_again_to_the_same_bytes():
    for name, text in all_pages():
        assert (DOCS / name).read_bytes() == text.encode(), f"{name} is not what its sources say; {AGAIN}"


def test_generated_pictures_have_the_same_pixels():
    shown = dict(pictures())
    assert len(shown) == len(layout_names())
    for name, image in shown.items():
        np.testing.assert_array_equal(np.asarray(Image.open(DOCS / name).convert("RGB")), np.asarray(image), name)


@pytest.mark.slow
def test_sphinx_builds_every_page_without_a_warning(tmp_path):
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "--quiet",
        "-W",
        "--keep-going",
        "--tag",
        "quick",
        str(DOCS),
        str(tmp_path),
    ]
    built = subprocess.run(command, capture_output=True, text=True)
    assert (built.returncode, built.stderr) == (0, "")
    assert (tmp_path / "kitchens" / "cramped_room.html").is_file()
    assert (tmp_path / "leaderboard" / "index.html").is_file()


def test_a_page_that_includes_a_file_shows_it_with_links_to_the_site():
    text = "```{include} ../../baselines/results/v1.md\n```\n"
    shown = expanded(text, "docs/results/v1.md", ROOT)
    assert "](../../baselines/results/v1-crossplay.png)" in shown
    assert shown.startswith("# Evidence")


@pytest.mark.parametrize(
    ("file", "page", "link", "relinked_to"),
    [
        ("docs/a.md", "docs/a.md", "../SECURITY.md#data-files", "security.md#data-files"),
        ("docs/a.md", "docs/a.md", "b.md", "b.md"),
        ("docs/a.md", "docs/a.md", "../baselines/results", "results/index.md"),
        ("baselines/results/v1.md", "docs/results/v1.md", "../../docs/scoring.md", "../scoring.md"),
        ("baselines/results/v1.md", "docs/results/v1.md", "human.md", "human.md"),
        ("CONTRIBUTING.md", "docs/contributing.md", "docs/submissions.md", "submissions.md"),
        ("docs/a.md", "docs/a.md", "https://example.org/SECURITY.md", "https://example.org/SECURITY.md"),
        ("docs/a.md", "docs/a.md", "#below", "#below"),
    ],
)
def test_links_lead_to_the_page_that_shows_a_file(file, page, link, relinked_to):
    assert relinked(f"see [it]({link}).", file, page) == f"see [it]({relinked_to})."


def test_links_to_the_leaderboard_stay_as_its_pages_are_copied():
    shown = relinked("[It](leaderboard/index.html) is there.", "docs/leaderboard.md", "docs/leaderboard.md")
    assert shown == '<a href="leaderboard/index.html">It</a> is there.'


def test_every_page_from_elsewhere_is_in_the_site():
    for file, page in PAGES.items():
        assert (ROOT / file).exists()
        assert (ROOT / page).is_file()


def test_a_list_of_pages_leaves_out_those_that_are_not_there(tmp_path):
    (tmp_path / "here.md").touch()
    text = "```{toctree}\n:caption: A\nhere\nlater\n```\nlater\n"
    assert without_missing(text, tmp_path) == "```{toctree}\n:caption: A\nhere\n```\nlater\n"


def test_docstrings_in_markdown_become_restructured_text():
    lines = ["Returns (N, *shape); `a * b`.", "", "    ```python", "    x = 1", "    ```", "    after"]
    expected = [
        r"Returns (N, \*shape); `a * b`.",
        "",
        "    .. code-block:: python",
        "",
        "        x = 1",
        "",
        "    after",
    ]
    assert as_rst(lines) == expected

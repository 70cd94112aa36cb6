"""A comparison for the terminal and as a page."""

import re
from io import StringIO

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from rich.console import Console

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.comparing.compare import compare
from overcooked_bench.evaluation.shown.comparison import comparison_tables
from overcooked_bench.evaluation.shown.comparison_page import write_comparison
from overcooked_bench.evaluation.shown.forest import Bar, forest
from tests.evaluation.comparing.made import agent, method
from tests.evaluation.shown.test_report import Outline

LONG = "best-response-to-half-trained-partners"


@pytest.fixture(scope="module")
def two():
    return compare(method(0, 70, name="a<b>"), method(1, 60, name=LONG))


@pytest.fixture(scope="module")
def many():
    return compare(*(method(k, 60 + 4 * k, name=f"{LONG}-{k}") for k in range(4)))


def shown(found):
    console = Console(width=100, file=StringIO())
    console.print(comparison_tables(found))
    return console.file.getvalue()


def outline(found, file):
    write_comparison(found, file)
    page = Outline()
    page.feed(file.read_text())
    assert page.open == []
    return page


def test_two_methods_are_a_table_of_layouts_that_fits_the_terminal(two):
    text = shown(two)
    assert max(map(len, text.splitlines())) <= 100
    assert "…" not in text
    for words in (
        "cramped_room",
        "mean of layouts",
        "a<b>",
        "better",
        "difference [95 %]",
        "What 5 training seeds buy",
    ):
        assert words in text


def test_several_methods_are_a_table_of_pairs_that_fits_the_terminal(many):
    text = shown(many)
    assert max(map(len, text.splitlines())) <= 100
    assert "…" not in text
    assert "adjusted for 6 pairs" in text
    assert text.count("Holm\n") == 2


def test_the_page_needs_nothing_else_and_has_every_partner(two, tmp_path):
    page = outline(two, tmp_path / "page.html")
    assert {"svg", "table", "style", "details"} <= set(page.tags)
    assert "script" not in page.tags
    assert page.links == []
    text = " ".join(page.texts)
    for words in ("a<b>", LONG, "with human", "human-2", "partners on cramped_room", "5 training seeds of each"):
        assert words in text
    raw = (tmp_path / "page.html").read_text()
    assert 'name="viewport"' in raw
    assert not re.search(r"#(?:000|333|fff)", re.sub(r"<style>.*?</style>", "", raw, flags=re.DOTALL))


def test_the_page_of_several_draws_each_pair(many, tmp_path):
    page = outline(many, tmp_path / "page.html")
    assert page.tags.count("circle") == 12  # six pairs of two metrics


def test_agents_have_a_page_too(tmp_path):
    page = outline(compare(agent(0), agent(1, name="greedy")), tmp_path / "page.html")
    assert "one artefact each" in " ".join(page.texts)


ENDS = st.floats(-1000, 1000, allow_nan=False)


@example([(0.0, 0.0, 2.2e-309)])
@given(st.lists(st.tuples(ENDS, ENDS, ENDS), min_size=1, max_size=5))
def test_a_forest_plot_stays_within_its_frame_and_has_a_line_at_zero(ends):
    bars = [Bar("layout", Estimate(middle, low, high), "text") for low, middle, high in map(sorted, ends)]
    drawn = forest(bars, "theirs better", "mine better")
    places = [float(at) for at in re.findall(r' (?:cx|x1|x2)="([^"]+)"', drawn)]
    assert all(0 <= at <= 360 for at in places)
    assert re.search(r">0</text>", drawn)
    assert 2 <= drawn.count('text-anchor="middle"') <= 8


def test_a_mark_is_filled_where_the_interval_excludes_zero():
    drawn = forest(
        [Bar("x", Estimate(2, 1, 3), ""), Bar("y", Estimate(1, -1, 3), ""), Bar("z", Estimate(1), "")], "", ""
    )
    assert re.findall(r'<circle[^>]* fill="([^"]+)"', drawn) == ["#0072B2", "var(--paper)", "var(--paper)"]

"""One table value for the terminal, Markdown, HTML and CSV: names are printed as they are."""

import csv
from io import StringIO

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from overcooked_bench.rendering.table import Code, Column, Number, Table

TABLE = Table(
    ["layout", Column("mean\n[95 %]", wrap=False), Column("command", left=True)],
    [["cramped_room", Number("12.0", "[10.0, 14.0]"), Code("run --partner 'a b'")], ["script: [up, interact]", "3"]],
    [["mean", "7.5"]],
)


def shown(table, width=200):
    console = Console(width=width, file=StringIO())
    console.print(table.terminal())
    return console.file.getvalue()


def test_it_is_laid_out_for_the_terminal():
    lines = [line.rstrip() for line in shown(TABLE).splitlines()]
    assert lines[1].split() == ["layout", "[95", "%]", "command"]
    assert lines[3] == "cramped_room            12.0 [10.0, 14.0]  run --partner 'a b'"
    assert lines[4].split() == ["script:", "[up,", "interact]", "3"]
    assert lines[-1].split() == ["mean", "7.5"]


def test_it_is_laid_out_as_lines_of_text():
    assert TABLE.text()[1] == "cramped_room            12.0 [10.0, 14.0]  run --partner 'a b'"


def test_it_is_written_as_markdown():
    assert TABLE.markdown().splitlines() == [
        "| layout                 |       mean [95 %] | command               |",
        "|------------------------|------------------:|-----------------------|",
        "| cramped_room           | 12.0 [10.0, 14.0] | `run --partner 'a b'` |",
        "| script: [up, interact] |                 3 |                       |",
        "| mean                   |               7.5 |                       |",
    ]


def test_it_is_written_as_html():
    text = TABLE.html()
    assert '<td class="left">cramped_<wbr>room</td><td>12.0 <small>[10.0, 14.0]</small></td>' in text
    assert "<code>run --partner &#x27;a b&#x27;</code>" in text
    assert "<th>mean<br>[95 %]</th>" in text
    assert '<tr class="sum"><td class="left">mean</td>' in text


@pytest.mark.parametrize(
    "name", ["[red]", "[/b]", "[up, interact]", "a|b", "<b>", "a\x1b[31m", "a & b", 'say "x"', "≥"]
)
def test_a_name_is_printed_as_it_is(name):
    table = Table(["name"], [[name]])
    visible = name.replace("\x1b", "\\x1b")
    assert visible in shown(table)
    assert visible in "\n".join(table.text())
    assert visible.replace("|", "\\|").replace("<", "\\<") in table.markdown()
    assert "\x1b" not in shown(table) + table.markdown() + table.html()
    assert "<b>" not in table.html()


@given(st.lists(st.lists(st.text(), min_size=2, max_size=2), min_size=1))
def test_csv_is_read_back(rows):
    read = list(csv.reader(StringIO(Table(["a", "b"], rows).csv(), newline="")))
    assert read == [["a", "b"], *rows]


def test_numbers_in_csv_are_numbers():
    rows = [["a", Number("41 %", "[35, 47]"), Number("0.5", "± 0.1")], ["b", Number("-3 %", "[-9, 2]"), "-"], ["c"]]
    read = list(csv.reader(StringIO(Table(["layout", "N\n[95 %]", "lite"], rows).csv(), newline="")))
    assert read == [
        ["layout", "N %", "N % low", "N % high", "lite", "lite s.e."],
        ["a", "41", "35", "47", "0.5", "0.1"],
        ["b", "-3", "-9", "2", "-", ""],
        ["c", "", "", "", "", ""],
    ]

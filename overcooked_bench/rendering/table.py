"""`Table`: rows of text, laid out for a terminal, as Markdown, HTML or CSV."""

import csv
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Final, NamedTuple

from overcooked_bench.files import printable

if TYPE_CHECKING:
    from rich.table import Table as RichTable
    from rich.text import Text


INTERVAL: Final = " [95 %]"
"""How the heading of a column with intervals ends."""


class Column(NamedTuple):
    """A column.

    Attributes:
        heading: What is above it; a line break is kept.
        left: Whether its cells are aligned on the left.
        wrap: Whether its cells may be broken into lines where space is short.
    """

    heading: str
    left: bool = False
    wrap: bool = True


class Code(NamedTuple):
    """A cell that is to be copied, such as a command.

    Attributes:
        text: What it says.
    """

    text: str

    def __str__(self) -> str:
        return self.text


class Number(NamedTuple):
    """A cell with a number and what is known about its error.

    Attributes:
        value: The number.
        interval: Its interval in brackets; HTML mutes it.
    """

    value: str
    interval: str = ""

    def __str__(self) -> str:
        return f"{self.value} {self.interval}".rstrip()


Cell = str | Code | Number


@dataclass(frozen=True)
class Table:
    """Columns, rows of cells, and rows below a line that sum them up; texts are printed as they are.

    Attributes:
        columns: Names, or `Column` where more has to be said; by default the first is on the left, the others on the
            right.
        rows: A cell per column; missing cells at the end are empty.
        foot: Rows below a line.
    """

    columns: Sequence[str | Column]
    rows: Sequence[Sequence[Cell]]
    foot: Sequence[Sequence[Cell]] = ()

    def terminal(self) -> "RichTable":
        """Lays the table out for `rich`; control characters and markup in texts have no effect."""
        from rich import box
        from rich.table import Table as RichTable
        from rich.text import Text

        table = RichTable(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False)
        for column in self._columns():
            table.add_column(
                Text(printable(column.heading)),
                justify="left" if column.left else "right",
                no_wrap=not column.wrap,
                overflow="fold" if column.wrap else "ellipsis",
            )
        for row in self._filled(self.rows):
            table.add_row(*(Text(printable(cell)) for cell in row))
        for row in self._filled(self.foot):
            table.add_section()
            table.add_row(*(Text(printable(cell)) for cell in row))
        return table

    def text(self) -> list[str]:
        """Lays the table out as lines of plain text, as wide as they need to be."""
        columns = self._columns()
        heads = [printable(column.heading).replace("\n", " ") for column in columns]
        rows = [[printable(cell) for cell in row] for row in self._filled((*self.rows, *self.foot))]
        widths = [max(map(len, cells)) for cells in zip(heads, *rows, strict=True)]
        return ["  ".join(_aligned(row, widths, columns)).rstrip() for row in (heads, *rows)]

    def markdown(self) -> str:
        """Writes the table as Markdown, aligned in the source, too."""
        columns = self._columns()
        heads = [_markdown(column.heading) for column in columns]
        rows = [[_markdown(cell) for cell in row] for row in self._filled((*self.rows, *self.foot))]
        widths = [max(1, *map(len, cells)) for cells in zip(heads, *rows, strict=True)]
        rule = ["-" * (width + 1) + "-:"[not column.left] for width, column in zip(widths, columns, strict=True)]
        lines = [" | ".join(_aligned(row, widths, columns)) for row in (heads, *rows)]
        return "\n".join([f"| {lines[0]} |", f"|{'|'.join(rule)}|", *(f"| {line} |" for line in lines[1:])])

    def html(self) -> str:
        """Writes the table as HTML, in an element that scrolls sideways where space is short."""
        columns = self._columns()

        def line(tag: str, cells: Iterable[Cell], kind: str = "") -> str:
            written = "".join(
                f"<{tag}{_style(column, cell)}>{_html(cell)}</{tag}>"
                for cell, column in zip(cells, columns, strict=True)
            )
            return f"<tr{kind}>{written}</tr>"

        lines = [
            "<thead>" + line("th", [column.heading for column in columns]) + "</thead>",
            *(line("td", row) for row in self._filled(self.rows)),
            *(line("td", row, ' class="sum"') for row in self._filled(self.foot)),
        ]
        return '<div class="wide"><table>\n' + "\n".join(lines) + "\n</table></div>"

    def csv(self) -> str:
        """Writes the table as CSV (RFC 4180), with numbers that programs can read.

        A column with intervals becomes three, and a percent sign that all its numbers have moves into its heading.
        """
        file = StringIO()
        heads = [column.heading.replace("\n", " ") for column in self._columns()]
        rows = self._filled((*self.rows, *self.foot))
        columns = (_csv(head, [row[index] for row in rows]) for index, head in enumerate(heads))
        csv.writer(file).writerows(zip(*(column for part in columns for column in part), strict=True))
        return file.getvalue()

    def _columns(self) -> list[Column]:
        return [
            column if isinstance(column, Column) else Column(column, left=index == 0, wrap=index > 0)
            for index, column in enumerate(self.columns)
        ]

    def _filled(self, rows: Sequence[Sequence[Cell]]) -> list[list[Cell]]:
        return [[*row, *[""] * (len(self.columns) - len(row))] for row in rows]


def styled(text: str, style: str = "") -> "Text":
    """Returns a text for `rich`, in which control characters and markup have no effect."""
    from rich.text import Text

    return Text(printable(text), style=style)


def _aligned(cells: Iterable[str], widths: Iterable[int], columns: Iterable[Column]) -> list[str]:
    return [
        cell.ljust(width) if column.left else cell.rjust(width)
        for cell, width, column in zip(cells, widths, columns, strict=True)
    ]


def _markdown(cell: Cell) -> str:
    text = printable(cell).replace("\n", " ").replace("|", "\\|").replace("<", "\\<")
    return f"`{text}`" if isinstance(cell, Code) else text


def _html(cell: Cell) -> str:
    if isinstance(cell, Code):
        return f"<code>{escape(cell.text)}</code>"
    if isinstance(cell, Number):
        return escape(cell.value) + (f" <small>{escape(cell.interval)}</small>" if cell.interval else "")
    return escape(printable(cell)).replace("\n", "<br>").replace("_", "_<wbr>")


def _csv(heading: str, cells: Sequence[Cell]) -> list[list[str]]:
    """Returns a column as one of CSV, its heading first; with what is known about the error as more of them."""
    numbers = [cell for cell in cells if isinstance(cell, Number)]
    unit = " %" if numbers and all(number.value.endswith(" %") for number in numbers) else ""
    head = heading.replace(INTERVAL, "") + unit
    columns = [[head, *(cell.value.removesuffix(unit) if isinstance(cell, Number) else str(cell) for cell in cells)]]
    ends = [re.findall(r"-?[\d.]+", cell.interval) if isinstance(cell, Number) else [] for cell in cells]
    names = ("low", "high") if max(map(len, ends), default=0) == 2 else ("s.e.",)
    for index, name in enumerate(names if any(ends) else ()):
        columns.append([f"{head} {name}", *(end[index] if end else "" for end in ends)])
    return columns


def _style(column: Column, cell: Cell) -> str:
    kinds = ["left"] * column.left + ["code"] * isinstance(cell, Code)
    return f' class="{" ".join(kinds)}"' if kinds else ""

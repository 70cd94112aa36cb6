"""The page of errata: what was wrong, what was withdrawn, and which folders are not shown."""

from collections.abc import Sequence
from html import escape

from overcooked_bench.leaderboard.site.entries import Refused
from overcooked_bench.leaderboard.site.errata import Erratum
from overcooked_bench.leaderboard.site.lines import Line
from overcooked_bench.leaderboard.site.pages.look import TITLE, link, whole
from overcooked_bench.rendering.page import note, section
from overcooked_bench.rendering.table import Column, Table


def errata_page(errata: Sequence[Erratum], lines: Sequence[Line], refused: Sequence[Refused]) -> str:
    """Writes the page.

    Args:
        errata: From the results, the latest first.
        lines: All rows.
        refused: Folders that are not shown.
    """
    corrected = Table(
        ["date", Column("about", left=True), Column("what was wrong, and what was done", left=True)],
        [[one.date, one.about, one.said] for one in errata],
    )
    gone = [line for line in lines if line.status == "withdrawn"]
    items = "".join(f"<li>{link(line.page, line.name)} ({line.protocol}): {escape(line.remark)}</li>" for line in gone)
    folders = Table(["folder", Column("reason", left=True)], [[one.name, one.reason] for one in refused])
    body = [
        "<h1>Errata</h1>",
        note("Nothing is deleted: what turned out wrong is listed here, with the date."),
        *section("Corrections", corrected.html() if errata else note("None so far.")),
        *section("Withdrawn", f"<ul>{items}</ul>" if gone else note("Nothing so far.")),
        *section("Not shown", note("Folders of the results that are no entries, and why."), folders.html())
        * bool(refused),
    ]
    return whole(f"Errata: {TITLE}", body, style="td { white-space: normal; }\n")

"""Builds the site: the same results always give the same bytes."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final, NamedTuple

from overcooked_bench.files import shown, write_whole
from overcooked_bench.leaderboard.site.board import games_of
from overcooked_bench.leaderboard.site.curves_page import curves_of, curves_page
from overcooked_bench.leaderboard.site.entries import Entry, EntryError, Refused, read_entries
from overcooked_bench.leaderboard.site.entry_page import entry_page
from overcooked_bench.leaderboard.site.index_page import index_page
from overcooked_bench.leaderboard.site.lines import (
    FEED,
    TABLE_CSV,
    TABLE_JSON,
    as_csv,
    as_feed,
    as_json,
    line_of,
    lines_of,
)

INDEX: Final = "index.html"


class Built(NamedTuple):
    """The result of `build`.

    Attributes:
        entries: How many are shown.
        refused: Folders that are not, and why.
        files: How many files the site has.
    """

    entries: int
    refused: tuple[Refused, ...]
    files: int


def build(results: str | Path, site: str | Path) -> Built:
    """Writes the site of all entries.

    Args:
        results: A folder with one folder for each entry.
        site: A new or empty folder, or one that a former call wrote; pages of entries that are gone are removed.

    Raises:
        EntryError: There are no such results, or the folder holds something else than a site.
    """
    entries, refused = read_entries(results)
    home = Path(site)
    if home.exists() and any(home.iterdir()) and not (home / TABLE_JSON).is_file():
        raise EntryError(f"{shown(home)}: holds something else than a site; give a new folder")
    written, failed = _entry_pages(entries)
    refused += failed
    entries = [entry for entry in entries if entry.key in written]
    games = games_of(entries)
    lines = lines_of(games)
    pages = {TABLE_JSON: as_json(lines), TABLE_CSV: as_csv(lines), FEED: as_feed(lines)}
    pages[INDEX] = index_page(games, refused)
    pages |= {f"curves-{one.mark}.html": curves_page(one) for one in games}
    (home / "entries").mkdir(parents=True, exist_ok=True)
    for key, content in written.items():
        write_whole(home / "entries" / f"{key}.html", content)
    for name, content in pages.items():
        write_whole(home / name, content)
    kept = {f"{entry.key}.html" for entry in entries}
    stale = [file for file in (home / "entries").glob("*.html") if file.name not in kept]
    stale += [file for file in home.glob("curves-*.html") if file.name not in pages]
    for file in stale:
        file.unlink()
    return Built(len(entries), tuple(refused), len(pages) + len(entries))


def _entry_pages(entries: Sequence[Entry]) -> tuple[dict[str, str], list[Refused]]:
    """Writes the page of each entry, by its key; one whose numbers contradict each other is refused."""
    pages, refused = {}, []
    for one in games_of(entries):
        some = [entry for board in one.boards for entry in board.entries]
        wanted = one.scores.settings.report.reference
        reference = next((e.scores for e in some if e.manifest is None and e.name == wanted), None)
        for entry in some:
            try:
                page = entry_page(entry, one, reference)
                line_of(entry, "")
                curves_of(entry.scores)
            except (LookupError, ValueError, TypeError, ArithmeticError, AssertionError) as error:
                refused.append(Refused(entry.key, shown(f"its score.json contradicts itself ({error!r})", 400)))
            else:
                pages[entry.key] = page
    return pages, refused

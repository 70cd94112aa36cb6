"""Builds the site: the same results always give the same bytes."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final, NamedTuple

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.files import shown, write_whole
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.leaderboard.site.board import Games, games_of, parts_of
from overcooked_bench.leaderboard.site.discriminating import Discrimination, discrimination
from overcooked_bench.leaderboard.site.entries import (
    Entry,
    EntryError,
    Refused,
    entry_folders,
    read_entry,
    shipped_rows,
)
from overcooked_bench.leaderboard.site.errata import read_errata
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
from overcooked_bench.leaderboard.site.pages.curves import curves_of, curves_page
from overcooked_bench.leaderboard.site.pages.entry import entry_page
from overcooked_bench.leaderboard.site.pages.errata import errata_page
from overcooked_bench.leaderboard.site.pages.index import index_page
from overcooked_bench.leaderboard.site.pages.layout import layout_page
from overcooked_bench.leaderboard.site.pages.protocol import protocol_page

INDEX: Final = "index.html"
_FOLDERS: Final = ("entries", "layouts", "protocols", "curves")


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
        results: A folder with one folder for each entry, and errata.yaml if there are any.
        site: A new or empty folder, or one that a former call wrote; pages of entries that are gone are removed.

    Raises:
        EntryError: There are no such results, or the folder holds something else than a site.
    """
    folders, errata, home = entry_folders(results), read_errata(results), Path(site)
    if home.exists() and any(home.iterdir()) and not (home / TABLE_JSON).is_file():
        raise EntryError(f"{shown(home)}: holds something else than a site; give a new folder")
    for name in _FOLDERS:
        (home / name).mkdir(parents=True, exist_ok=True)
    rows = shipped_rows()
    references = {(one.scores.protocol.sha256, one.scores.agent.name): one.scores for one in rows}
    entries = [_write(row, references, home) for row in rows]
    refused = []
    for folder in folders:
        try:
            entries.append(_write(read_entry(folder), references, home))
        except (WrongUse, OSError) as error:
            refused.append(_refused(folder, str(error)))
        except (LookupError, ValueError, TypeError, ArithmeticError, AssertionError) as error:
            refused.append(_refused(folder, f"its numbers contradict themselves ({error!r})"))
    games = games_of(entries)
    lines = lines_of(games)
    pages = {TABLE_JSON: as_json(lines), TABLE_CSV: as_csv(lines), FEED: as_feed(lines, errata)}
    pages |= {INDEX: index_page(games, len(refused)), "errata.html": errata_page(errata, lines, refused)}
    pages |= dict(_pages_of_games(games))
    for name, content in pages.items():
        write_whole(home / name, content)
    kept = {*pages, *(f"entries/{entry.key}.html" for entry in entries)}
    for name in _FOLDERS:
        for file in (home / name).glob("*.html"):
            if f"{name}/{file.name}" not in kept:
                file.unlink()
    return Built(len(entries), tuple(refused), len(kept))


def _write(entry: Entry, references: dict[tuple[str, str], Scores], home: Path) -> Entry:
    """Writes the page of an entry, and returns the entry without its partners: of a thousand, nobody needs them."""
    scores = entry.scores
    wanted = scores.settings.report.reference or ""
    found = references.get((scores.protocol.sha256, wanted))
    same = found is not None and (found.pool, found.seed, found.salt) == (scores.pool, scores.seed, scores.salt)
    content = entry_page(entry, found if same else None)
    line_of(entry)
    curves_of(scores)
    write_whole(home / "entries" / f"{entry.key}.html", content)
    entry = replace(entry, parts=parts_of(scores))
    if entry.shipped:
        return entry
    rows = tuple(row for row in scores.rows if row.partner is None)
    layouts = tuple(msgspec.structs.replace(layout, partners=()) for layout in scores.layouts)
    return replace(entry, scores=msgspec.structs.replace(scores, rows=rows, layouts=layouts))


def _refused(folder: Path, reason: str) -> Refused:
    return Refused(shown(folder.name, 100), shown(reason.replace(str(folder), folder.name), 400))


def _pages_of_games(games: list[Games]) -> Iterator[tuple[str, str]]:
    """Yields the pages of protocols and of the shipped layouts that they play."""
    playing: dict[str, list[tuple[Games, Discrimination]]] = {}
    for one in games:
        found = {name: discrimination(one.entries, name) for name in one.scores.settings.play.layouts}
        for name, said in found.items():
            playing.setdefault(name, []).append((one, said))
        yield one.page, protocol_page(one, found)
        yield one.curves, curves_page(one)
    for name, of_games in playing.items():
        if name in layout_names():
            yield f"layouts/{name}.html", layout_page(name, of_games)

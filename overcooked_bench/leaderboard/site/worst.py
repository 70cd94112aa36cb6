"""The worst games of an entry, which its page plays; they are kept without the rest of the episodes.

A score's episodes are megabytes. `worst.json` keeps the few that are watched: start states and joint actions, which are
played again when the page is written, and have to bring the points that were recorded.
"""

from pathlib import Path
from typing import Any, Final

import msgspec

from overcooked_bench.documents import read_json
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.recording import Recording, find_recording
from overcooked_bench.evaluation.scores import EPISODES_FILE, Scores, Source
from overcooked_bench.evaluation.shown.sections.section import Material
from overcooked_bench.evaluation.shown.sections.worst import worst_cells
from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.leaderboard.site.entries import EntryError

WORST_FILE: Final = "worst.json"
SCHEMA: Final = 1
MOST: Final = 3
"""Games that a page plays; each is about 20 kB."""

_MOST_BYTES: Final = 4_000_000


class WorstGames(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What `worst.json` holds.

    Attributes:
        schema: Version of this form.
        agent: The scored agent.
        protocol: What was played.
        games: The episode with the fewest points of each of the worst cells.
    """

    schema: int
    agent: Source
    protocol: Source
    games: tuple[Episode, ...]


def worst_games(scores: Scores, folder: Path | None) -> list[Recording]:
    """Finds the worst games of an entry: in worst.json, else among its episodes; none if it has neither.

    Raises:
        WrongUse: What is there cannot be read, or is of another score.
    """
    if folder is not None and (folder / WORST_FILE).exists():
        return _read(folder / WORST_FILE, scores)
    if folder is None or not (folder / EPISODES_FILE).is_file():
        return []
    return find_worst(scores, folder)


def find_worst(scores: Scores, folder: Path) -> list[Recording]:
    """Finds the worst games among all episodes of a score."""
    cells = worst_cells(Material(scores, folder), MOST)
    return [
        find_recording(folder, layout=cell.layout, partner=cell.partner, seat=cell.mean.seat, worst=True)
        for cell in cells
        if cell.layout in layout_names()
    ]


def write_worst(scores: Scores, found: list[Recording], file: Path) -> None:
    """Writes worst.json, all or nothing."""
    games = tuple(one.episode for one in found)
    kept = WorstGames(schema=SCHEMA, agent=scores.agent, protocol=scores.protocol, games=games)
    write_whole(file, msgspec.json.format(msgspec.json.encode(kept), indent=1) + b"\n")


def _read(file: Path, scores: Scores) -> list[Recording]:
    content: dict[str, Any] = read_json(file, _MOST_BYTES, dict, EntryError)
    try:
        kept = msgspec.convert(content, WorstGames)
    except (ValueError, TypeError) as error:
        raise EntryError(f"{file}: not a {WORST_FILE} of schema {SCHEMA} ({error})") from error
    if (kept.schema, kept.agent, kept.protocol) != (SCHEMA, scores.agent, scores.protocol):
        raise EntryError(f"{file}: of another schema, agent or protocol than the score; write it again")
    if strange := [one.layout for one in kept.games if one.layout not in layout_names()]:
        raise EntryError(f"{file}: {strange[0]!r} is no shipped layout")
    return [Recording(file, game, scores.settings, scores.agent.name) for game in kept.games[:MOST]]

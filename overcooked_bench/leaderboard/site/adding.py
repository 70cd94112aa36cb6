"""Adds an audited result to the results that the page is built from: without its episodes, but for the worst games."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE
from overcooked_bench.evaluation.scores import SCORES_FILE, read_scores
from overcooked_bench.files import check_name, read_regular, shown, write_whole
from overcooked_bench.leaderboard.audit.records import AUDIT_FILE
from overcooked_bench.leaderboard.site.entries import EntryError, read_entry
from overcooked_bench.leaderboard.site.pages.entry import entry_page
from overcooked_bench.leaderboard.site.worst import WORST_FILE, find_worst, write_worst
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, load_manifest

_MOST_BYTES: Final = 64_000_000
_KEPT: Final = (SCORES_FILE, AUDIT_FILE, EXPLAIN_FILE)


def add(result: str | Path, submission: str | Path, results: str | Path) -> Path:
    """Writes the folder of an entry, or writes it again after another audit of the same agent.

    Args:
        result: The folder of a score, with audit.json if it was audited.
        submission: The folder of the submission, with its submission.yaml.
        results: The folder that holds one folder for each entry.

    Returns:
        The entry's folder.

    Raises:
        WrongUse: Something cannot be read, does not fit the rest, or there is an entry of another agent of that name.
    """
    source, home = Path(result), Path(results)
    scores, manifest = read_scores(source), load_manifest(Path(submission) / MANIFEST)
    name = check_name(f"{manifest.name}-{scores.protocol.name}", "the entry's name", EntryError)
    if (home / name / SCORES_FILE).is_file() and read_scores(home / name).agent.sha256 != scores.agent.sha256:
        raise EntryError(f"{shown(home / name)}: another agent has this name, and stays; give the new one another name")
    with TemporaryDirectory() as place:
        stage = Path(place, name)
        stage.mkdir()
        for file in _KEPT:
            if (source / file).exists():
                write_whole(stage / file, read_regular(source / file, _MOST_BYTES, raises=EntryError))
        write_whole(stage / MANIFEST, read_regular(Path(submission) / MANIFEST, _MOST_BYTES, raises=EntryError))
        write_worst(scores, find_worst(scores, source), stage / WORST_FILE)
        entry_page(read_entry(stage), None)
        (home / name).mkdir(parents=True, exist_ok=True)
        for kept in sorted(stage.iterdir()):
            write_whole(home / name / kept.name, kept.read_bytes())
    return home / name

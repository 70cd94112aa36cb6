"""Adds an audited result to the results that the page is built from: without its episodes, but for the worst games."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from overcooked_bench.agents.submissions.content import hash_submission
from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE
from overcooked_bench.evaluation.scores import SCORES_FILE, read_scores
from overcooked_bench.files import check_name, read_regular, shown, write_whole
from overcooked_bench.leaderboard.audit.records import AUDIT_FILE, read_audit
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
        submission: The folder that was scored, with its submission.yaml.
        results: The folder that holds one folder for each entry.

    Returns:
        The entry's folder.

    Raises:
        WrongUse: Something cannot be read or does not fit the rest, the submission is not what was scored, there is an
            entry of another agent of that name, or the entry was withdrawn and the result was not.
    """
    source, home = Path(result), Path(results)
    scores, manifest = read_scores(source), load_manifest(Path(submission) / MANIFEST)
    name = check_name(f"{manifest.name}-{scores.protocol.name}", "the entry's name", EntryError)
    if (home / name / SCORES_FILE).is_file() and read_scores(home / name).agent.sha256 != scores.agent.sha256:
        raise EntryError(f"{shown(home / name)}: another agent has this name, and stays; give the new one another name")
    if hash_submission(submission) != scores.agent.sha256:
        raise EntryError(f"{shown(submission)}: not the files that were scored; score and audit them as they are")
    with TemporaryDirectory() as place:
        stage = Path(place, name)
        stage.mkdir()
        for file in _KEPT:
            if (source / file).exists():
                write_whole(stage / file, read_regular(source / file, _MOST_BYTES, raises=EntryError))
        write_whole(stage / MANIFEST, read_regular(Path(submission) / MANIFEST, _MOST_BYTES, raises=EntryError))
        write_worst(scores, find_worst(scores, source), stage / WORST_FILE)
        entry = read_entry(stage)
        entry_page(entry, None)
        if entry.status != "withdrawn" and _is_withdrawn(home / name):
            raise EntryError(f"{shown(home / name)}: was withdrawn, and stays so; withdraw the new result, too")
        (home / name).mkdir(parents=True, exist_ok=True)
        for file in (*_KEPT, MANIFEST, WORST_FILE):
            if (stage / file).exists():
                write_whole(home / name / file, (stage / file).read_bytes())
            else:
                (home / name / file).unlink(missing_ok=True)
    return home / name


def _is_withdrawn(folder: Path) -> bool:
    return (folder / AUDIT_FILE).exists() and read_audit(folder).status == "withdrawn"

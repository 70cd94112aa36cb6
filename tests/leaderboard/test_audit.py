"""The audit of a tiny result: it passes as it was written, and each kind of tampering is caught.

What is tampered with: every number, text and truth value of score.json, its rows, settings, schema and declined
layouts; every column of the episodes (joint actions, points, soups, partners, seats, sides, start states, hashes,
seeds), with and without checksums made to fit; every fact of the store (salt, seed, protocol, pool, partners, agent);
episodes, partners and start states left out or exchanged; faults; consistent games that nobody played; games of another
agent; the agent's code, weights, files and submission.yaml; the pool; and, in test_audit_records.py, audit.json itself.
"""

import contextlib
import hashlib
import json
import shutil
import sqlite3
from io import StringIO

import msgspec
import numpy as np
import pytest
from rich.console import Console

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.submissions.content import hash_submission
from overcooked_bench.cli import main
from overcooked_bench.evaluation.games.episode import COLUMNS, checksum, pack_actions, read_row
from overcooked_bench.evaluation.games.store import _digest
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE, Source
from overcooked_bench.evaluation.summary import recompute
from overcooked_bench.leaderboard.audit.audit import audit, withdraw
from overcooked_bench.leaderboard.audit.claims import claims_of
from overcooked_bench.leaderboard.audit.records import AuditError, read_audit
from overcooked_bench.leaderboard.audit.terminal import audit_tables
from overcooked_bench.leaderboard.review.reviewing import review
from overcooked_bench.leaderboard.submission.manifest import MANIFEST
from tests.evaluation.made import SCRIPTED_POOL, protocol_text, score
from tests.leaderboard.made import write_submission

AGENT = "hesitant"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """The folder of a result of 24 cells, of which 4 are with a floor."""
    folder = tmp_path_factory.mktemp("audit") / "result"
    rules = read_protocol(protocol_text(episodes=6, layouts=["cramped_room"], horizon=60), "tiny.yaml")
    score(AGENT, rules, output=folder)
    return folder


@pytest.fixture
def result(made, tmp_path):
    return shutil.copytree(made, tmp_path / "result")


def failed(found):
    return {check.name for check in found.checks if check.verdict == "failed"}


def test_an_honest_result_passes_and_is_reproduced(made, tmp_path):
    folder = shutil.copytree(made, tmp_path / "result")
    found = audit(folder, AGENT, everything=True)
    assert failed(found) == set(), found.checks
    assert (found.status, found.cells, found.played, found.official) == ("reproduced", 24, 24, False)
    assert read_audit(folder) == found
    shown = Console(width=100, file=StringIO())
    shown.print(audit_tables(found))
    assert "reproduced" in shown.file.getvalue()
    assert max(map(len, shown.file.getvalue().splitlines())) <= 100


def test_without_the_agent_it_is_reported_and_says_what_was_not_checked(result):
    found = audit(result)
    assert (found.status, found.table, failed(found)) == ("reported", "unranked", set())
    assert {check.name for check in found.checks if check.verdict == "not checked"} == {
        *("the agent", "the agent acts as recorded", "cells played again", "scenarios"),
    }


def test_another_agent_is_not_taken_for_the_scored_one(result):
    assert failed(audit(result, "greedy")) == {"the agent"}


def test_the_command_exits_with_1_if_anything_is_wrong_and_a_withdrawal_is_kept(result, capsys):
    assert main(["leaderboard", "audit", str(result)]) == 0
    assert main(["leaderboard", "withdraw", str(result), "--reason", "a mistake", "--date", "2026-12-01"]) == 0
    edit_score(result, lambda content: content.update(seed=1))
    assert main(["leaderboard", "audit", str(result)]) == 1
    assert "withdrawn on 2026-12-01, a mistake" in capsys.readouterr().out
    assert read_audit(result).status == "withdrawn"


def test_what_is_no_result_is_refused(tmp_path):
    with pytest.raises(AuditError, match="give the folder of a score"):
        audit(tmp_path)
    with pytest.raises(AuditError):
        withdraw(tmp_path, "why")


# Tampering with score.json: every number of it.


def edit_score(folder, change):
    content = json.loads((folder / SCORES_FILE).read_text())
    change(content)
    (folder / SCORES_FILE).write_text(json.dumps(content))


def numbers(content, path=()):
    """Yields the paths of all numbers, texts and truth values of what episodes give."""
    if isinstance(content, dict):
        for key, value in content.items():
            yield from numbers(value, (*path, key)) if (*path, key)[0] not in NOT_GIVEN else ()
    elif isinstance(content, list):
        for index, value in enumerate(content):
            yield from numbers(value, (*path, index))
    elif content is not None:
        yield path


NOT_GIVEN = {"run", "faults", "declined", "scenarios", "settings", "schema"}


def test_every_entry_of_score_json_that_is_changed_is_caught(made):
    from overcooked_bench.evaluation.scores import Scores
    from overcooked_bench.leaderboard.audit.numbers import differences

    found = recompute(made)
    content = json.loads((made / SCORES_FILE).read_text())
    paths = list(numbers(content))
    assert len(paths) > 100
    for path in paths:
        *above, last = path
        place = content
        for key in above:
            place = place[key]
        before = place[last]
        place[last] = f"{before}x" if isinstance(before, str) else not before if before in (True, False) else before + 1
        try:
            edited = msgspec.convert(content, Scores)
        except (msgspec.ValidationError, ValueError):
            edited = None
        assert edited is None or differences(edited, found), path
        place[last] = before
    assert differences(msgspec.convert(content, Scores), found) == []


@pytest.mark.parametrize(
    ("change", "check"),
    [
        (lambda content: content["rows"].pop(), "numbers"),
        (lambda content: content["rows"].append(content["rows"][0]), "numbers"),
        (lambda content: content["settings"]["report"].update(thresholds=[1.0]), "numbers"),
        (lambda content: content["settings"]["play"].update(horizon=61), "numbers"),
        (lambda content: content.update(schema=2), "schema"),
        (lambda content: content.update(declined=[{"layout": "cramped_room", "reason": "no"}]), "protocol"),
    ],
    ids=["row removed", "row doubled", "report", "play", "schema", "declined"],
)
def test_a_score_json_with_other_entries_is_caught(change, check, result):
    edit_score(result, change)
    assert check in failed(audit(result))


# Tampering with episodes.sqlite: with checksums, and score.json, made to fit again.


def rewrite(folder, change=lambda rows: rows, facts=lambda facts: None, repair=True):
    """Changes a store and makes its checksums fit, then score.json where it can be computed."""
    with contextlib.closing(sqlite3.connect(folder / EPISODES_FILE)) as connection, connection:
        rows = [dict(zip(COLUMNS, row, strict=True)) for row in connection.execute("SELECT * FROM episodes")]
        said = dict(connection.execute("SELECT key, value FROM facts"))
        del said["checksum"]
        rows = change(rows)
        facts(said)
        connection.execute("DELETE FROM facts")
        connection.executemany("INSERT INTO facts VALUES (?, ?)", [*said.items(), ("checksum", _digest(said))])
        connection.execute("DELETE FROM episodes")
        marks = ", ".join("?" * len(COLUMNS))
        connection.executemany(f"INSERT INTO episodes VALUES ({marks})", [tuple(row.values()) for row in rows])
        if repair:
            blocks = {}
            for row in rows:
                one = read_row(row.values())
                blocks.setdefault(one.block, []).append(one)
            connection.execute("DELETE FROM blocks")
            entries = [(*key, 0, checksum(key, False, episodes)) for key, episodes in blocks.items()]
            connection.executemany("INSERT INTO blocks VALUES (?, ?, ?, ?, ?)", entries)
    if repair:
        with contextlib.suppress(Exception):
            written = json.loads((folder / SCORES_FILE).read_text())
            fresh = msgspec.structs.replace(recompute(folder), run=written["run"])
            fresh.write(folder / SCORES_FILE)


def every(**changes):
    """Changes columns of all rows."""
    return lambda rows: [{**row, **{key: change(row[key]) for key, change in changes.items()}} for row in rows]


COLUMN_CHANGES = {
    "layout": lambda value: "coordination_ring",
    "training_seed": lambda value: value + 1,
    "episode": lambda value: value + 1,
    "partner": lambda value: f"{value}x",
    "seat": lambda value: 1 - value,
    "side": lambda value: value + 1,
    "partner_sha256": lambda value: "0" * 64,
    "kind": lambda value: "trained",
    "soup_reward": lambda value: value + 20,
    "ego_partial_reward": lambda value: value + 3,
    "partner_partial_reward": lambda value: value + 3,
    "ego_soups": lambda value: value + 1,
    "partner_soups": lambda value: value + 1,
    "start": lambda value: value.replace('"timestep":0', '"timestep":1'),
    "actions": lambda value: value[::-1],
}


@pytest.mark.parametrize("repair", [True, False], ids=["repaired", "as it is"])
@pytest.mark.parametrize("column", COLUMNS)
def test_a_changed_column_of_the_store_is_caught(column, repair, result):
    rewrite(result, every(**{column: COLUMN_CHANGES[column]}), repair=repair)
    assert not audit(result).sound


def test_a_store_that_was_only_written_again_is_not_caught(result):
    rewrite(result)
    assert audit(result).sound


def test_every_column_has_its_tampering():
    assert COLUMN_CHANGES.keys() == set(COLUMNS)


def other_starts(rows):
    """Gives each partner's episodes the start states of the next episode index, and what they bring there."""
    starts = {(row["partner"], row["episode"]): row["start"] for row in rows}
    return [{**row, "start": starts[row["partner"], (row["episode"] + 1) % 6]} for row in rows]


FACTS = {
    "salt": lambda facts: facts.update(salt="another"),
    "seed": lambda facts: facts.update(seed="1"),
    "protocol": lambda facts: facts.update(protocol="0" * 64),
    "pool hash": lambda facts: facts.update(pool="0" * 64),
    "training seeds": lambda facts: facts.update(training_seeds="2"),
    "partners": lambda facts: facts.update(partners=facts["partners"].replace("greedy", "stay")),
    "settings": lambda facts: facts.update(settings=facts["settings"].replace('"episodes":6', '"episodes":5')),
}


@pytest.mark.parametrize("change", FACTS.values(), ids=FACTS.keys())
def test_a_changed_fact_of_the_store_is_caught(change, result):
    def changing(facts):
        before = dict(facts)
        change(facts)
        assert facts != before

    rewrite(result, facts=changing)
    assert not audit(result).sound


ROWS = {
    "an episode removed": lambda rows: rows[1:],
    "an episode doubled under another name": lambda rows: [*rows, {**rows[0], "partner": "another"}],
    "a partner removed": lambda rows: [row for row in rows if row["kind"] != "floor"],
    "a start state removed": lambda rows: [row for row in rows if row["episode"] < 5],
    "start states exchanged": other_starts,
}


@pytest.mark.parametrize("change", ROWS.values(), ids=ROWS.keys())
def test_changed_rows_of_the_store_are_caught(change, result):
    rewrite(result, change)
    assert not audit(result).sound


def test_an_agent_hash_that_was_changed_everywhere_needs_the_agent(result):
    rewrite(result, facts=lambda facts: facts.update(agent="0" * 64))
    assert audit(result).sound
    assert "the agent" in failed(audit(result, AGENT))


def test_training_seeds_that_were_left_out_are_caught_by_the_agent(tmp_path):
    folder, rules = tmp_path / "runs", read_protocol(protocol_text(episodes=1, horizon=40), "tiny.yaml")
    score("partner-blind", rules, output=folder)
    found = audit(folder, "partner-blind")
    assert (failed(found), found.status, found.used_pool) == (set(), "reproduced", False)
    rewrite(
        folder,
        lambda rows: [row for row in rows if row["training_seed"] < 2],
        lambda facts: facts.update(training_seeds="2"),
    )
    assert audit(folder).sound
    assert failed(audit(folder, "partner-blind")) == {"the agent"}, "it has three"


def test_faults_that_were_removed_are_caught(result):
    rewrite(result, lambda rows: [row for row in rows if row["episode"] < 5])
    assert {"faults"} <= failed(audit(result))
    edit_score(result, lambda content: content.update(faults=["cramped_room, training seed 0, episode 5: it raised"]))
    assert "faults" not in failed(audit(result))


def still(rows):
    """Replaces all joint actions by waiting, with the returns that this brings: a store that agrees with itself."""
    zero = dict.fromkeys(
        ("soup_reward", "ego_partial_reward", "partner_partial_reward", "ego_soups", "partner_soups"), 0
    )
    waiting = pack_actions(np.full((60, 2), 4, np.uint8))
    return [{**row, **zero, "actions": waiting} for row in rows]


def test_consistent_games_that_were_never_played_are_caught_by_the_partners(result):
    rewrite(result, still)
    assert failed(audit(result)) == {"partners act as recorded"}


def test_actions_of_another_agent_are_caught_by_the_agent(made, tmp_path):
    """The honest games of one agent are sold as those of another."""
    folder, rules = tmp_path / "other", read_protocol(protocol_text(episodes=6, horizon=60), "tiny.yaml")
    score("random", rules, pool=SCRIPTED_POOL, output=folder)
    with contextlib.closing(sqlite3.connect(made / EPISODES_FILE)) as connection:
        (agent,) = connection.execute("SELECT value FROM facts WHERE key = 'agent'").fetchone()
    rewrite(folder, facts=lambda facts: facts.update(agent=agent, agent_name=AGENT))
    assert {"the agent acts as recorded", "cells played again"} <= failed(audit(folder, AGENT))


# Tampering with files beside them: the agent, its submission.yaml, the pool, and the protocol.


def edited(file, old, new):
    """Replaces a text in a file."""
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


CLAIMS = {
    "nothing": ((), (), "passed"),
    "the agent's": (("licence: MIT", "licence: ISC"), (), "failed"),
    "the result's": ((), ("human_data: false", "human_data: true"), "failed"),
    "both, and no longer the score's": (("training_seeds: 1", "training_seeds: 2"),) * 2 + ("failed",),
    "the pledge": ((), ("pledge: true", "pledge: false"), "failed"),
}


@pytest.mark.parametrize(("ours", "beside", "verdict"), CLAIMS.values(), ids=CLAIMS.keys())
def test_a_changed_submission_yaml_is_caught(ours, beside, verdict, result, tmp_path):
    folder = write_submission(tmp_path / "mine")
    shutil.copy(folder / MANIFEST, result)
    for place, change in ((folder, ours), (result, beside)):
        if change:
            edited(place / MANIFEST, *change)
    assert [check.verdict for check in claims_of(result, str(folder), recompute(result)).checks] == [verdict]


FILES = {
    "the weights": lambda folder: np.savez(folder / "weights-0.npz", weight=np.zeros((96, 6)), bias=np.ones(6)),
    "the code": lambda folder: (folder / "agent.py").write_text((folder / "agent.py").read_text() + "# else\n"),
    "submission.yaml": lambda folder: edited(folder / MANIFEST, "licence: MIT", "licence: ISC"),
    "a file more": lambda folder: (folder / "more.txt").write_text("more"),
}


@pytest.mark.parametrize("change", FILES.values(), ids=FILES.keys())
def test_a_changed_file_of_an_agent_changes_its_hash_which_the_audit_compares(change, tmp_path):
    folder = write_submission(tmp_path / "mine")
    before = hash_submission(folder)
    change(folder)
    assert hash_submission(folder) != before


def test_a_changed_pool_is_caught(result, tmp_path):
    pool = shutil.copytree(SCRIPTED_POOL, tmp_path / "pool")
    assert failed(audit(result, pool=pool)) == set()
    assert {"pool", "cells"} <= failed(audit(result, pool="dev-v0"))
    edited(pool / "manifest.json", '"role": "floor"', '"role": "partner"')
    with pytest.raises(AuditError, match=r"manifest\.json.*name the pool that was played with"):
        audit(result, pool=pool)


def test_a_result_with_another_pool_than_the_protocols_is_in_order_only_if_who_audits_names_it(tmp_path):
    """So the hidden twin's maintainers audit; it carries the pool's hash and its partners, and is not ranked."""
    rules = read_protocol(protocol_text(episodes=1, horizon=20, pool_sha256="a" * 64), "tiny.yaml")
    played = score("hesitant", rules, pool=SCRIPTED_POOL, output=tmp_path / "result").scores
    assert failed(audit(tmp_path / "result", pool=SCRIPTED_POOL)) == set()
    assert failed(audit(tmp_path / "result")) == {"protocol"}
    assert played.pool.sha256 == Pool.load(SCRIPTED_POOL).hash
    assert "is not that of the protocol" in played.unranked
    assert len(played.layouts[0].partners) == 2


def test_the_pools_that_a_submission_names_decide_its_table(made, tmp_path):
    """Also where only the result's folder says it, as in a reported result."""
    scores = msgspec.structs.replace(recompute(made), pool=Source("v1", "0" * 64))
    folder = write_submission(tmp_path / "mine")
    (beside := tmp_path / "result").mkdir()
    for pools, used in (("[]", False), ("[train-v1]", False), ("[dev-v1, v1]", True)):
        for key in ("training_pools", "selection_pools"):
            text = (folder / MANIFEST).read_text().replace(f"{key}: []", f"{key}: {pools}")
            (beside / MANIFEST).write_text(text)
            claims = claims_of(beside, None, scores)
            assert (claims.used_pool, claims.checks[0].verdict) == (used, "passed")
            assert claims.sha256 == hashlib.sha256(text.encode()).hexdigest()


@pytest.mark.slow
def test_a_packed_submission_is_audited_in_isolation(tmp_path, capsys):
    """From the template to a standing, by the commands; it trained with no pool."""
    folder = write_submission(tmp_path / "mine")
    rules = tmp_path / "tiny.yaml"
    rules.write_text(protocol_text(episodes=6, horizon=40))
    assert main(["submission", "pack", str(folder), "--output", str(tmp_path / "sent")]) == 0
    (packed,) = (tmp_path / "sent").iterdir()
    where = ["--isolate", "--workers", "1"]
    scoring = ["--protocol", str(rules), "--salt", "fresh", "--no-scenarios", "--output", str(tmp_path / "result")]
    assert main(["score", str(packed), *scoring, *where]) == 0
    assert main(["leaderboard", "audit", str(tmp_path / "result"), "--agent", str(packed), *where]) == 0
    found = read_audit(tmp_path / "result")
    assert (found.status, found.table, found.used_pool, found.official) == ("reproduced", "main", False, True)
    assert "secret salt" in capsys.readouterr().out
    entry = tmp_path / "results" / "mine-tiny"
    entry.mkdir(parents=True)
    for file in (tmp_path / "result" / SCORES_FILE, tmp_path / "result" / EPISODES_FILE, folder / MANIFEST, packed):
        shutil.copy(file, entry)
    reviewed = review(
        tmp_path, "".join(f"A\tresults/mine-tiny/{file.name}\n" for file in entry.iterdir()), isolate="best"
    )
    assert (reviewed.problems, reviewed.sound, reviewed.status) == ((), True, "reproduced")
    np.savez(tmp_path / "mine" / "weights-0.npz", weight=np.zeros((96, 6)), bias=np.ones(6))
    assert main(["leaderboard", "audit", str(tmp_path / "result"), "--agent", str(folder), *where]) == 1
    assert failed(read_audit(tmp_path / "result")) == {"the agent"}

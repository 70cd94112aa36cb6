"""Folders of results for the tests of the leaderboard's page: the shipped score of `greedy` under other names."""

import hashlib
from pathlib import Path

import msgspec

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.scores import Source, read_scores
from overcooked_bench.leaderboard.audit.records import SCHEMA as AUDIT_SCHEMA
from overcooked_bench.leaderboard.audit.records import Audit, Check

MANIFEST = """schema: 1
name: {name}
contact: ann@example.org
licence: MIT
link: {link}
commit: null
method: {method}
joint_steps: {steps}
partner_runs: 0
human_data: {human}
training_pools: {pools}
selection_pools: []
observation: {observation}
training_seeds: {seeds}
pledge: true
"""


def shifted(scores, name, shift, seeds):
    """The score of a method of as many seeds, each of whose headlines over all layouts is higher by `shift`."""
    rows = []
    for row in scores.rows:
        if row.metric == "n" and row.partner is None and row.stratum is None:
            runs = tuple(row.value + shift + 0.01 * (seed - seeds / 2) for seed in range(seeds))
            low, high = row.value + shift - 0.04, row.value + shift + 0.04
            row = msgspec.structs.replace(row, value=row.value + shift, low=low, high=high, per_repetition=runs)
        elif row.metric == "n" and row.partner is not None:
            row = msgspec.structs.replace(row, value=row.value + shift)
        rows.append(row)
    overall = next(row.estimate for row in rows if row.metric == "n" and row.about == ("n", (), *[None] * 6))
    return msgspec.structs.replace(
        *(scores,),
        agent=Source(name, hashlib.sha256(name.encode()).hexdigest()),
        training_seeds=seeds,
        overall=Estimate(*overall),
        unranked=None if scores.protocol.name == "v1" else scores.unranked,
        rows=tuple(rows),
    )


def write_entry(results, name, shift=0.0, seeds=5, audited=True, withdrawn="", scores=None, agent=None, **said):
    """Writes the folder of an entry, and gives it."""
    folder = Path(results) / name
    folder.mkdir(parents=True)
    scores = shifted(scores or read_scores(REFERENCES / "v1.json"), agent or name, shift, seeds)
    scores.write(folder / "score.json")
    known = {
        "method": "PPO",
        "steps": 1000,
        "human": "false",
        "pools": "[]",
        "observation": "lossless",
        "link": "null",
        **said,
    }
    (folder / "submission.yaml").write_text(MANIFEST.format(name=name, seeds=seeds, **known))
    if audited:
        audit = audit_of(folder, scores, used="v1" in known["pools"])
        (audit.withdraw(withdrawn, "2026-11-30") if withdrawn else audit).write(folder / "audit.json")
    return folder


def audit_of(folder, scores, used=False):
    """An audit with which nothing is wrong, of all cells."""
    return Audit(
        schema=AUDIT_SCHEMA,
        date="2026-11-29",
        version="0.1.0",
        protocol=scores.protocol,
        agent=scores.agent,
        pool=scores.pool,
        score_sha256=hashlib.sha256((folder / "score.json").read_bytes()).hexdigest(),
        episodes_sha256="0" * 64,
        salt=scores.salt,
        official=False,
        seed=1,
        cells=40,
        played=40,
        used_pool=used,
        unranked=None,
        checks=(Check("summary", "passed", "every number was computed again"),),
    )

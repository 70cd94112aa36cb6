"""A study's games as a table: one row per game, as CSV."""

import csv
from io import StringIO
from typing import Final

from overcooked_bench.human.study.log import StudyLog

COLUMNS: Final = (
    *("study", "code", "participant", "complete", "game", "layout", "condition", "partner", "partner_sha256", "label"),
    *("seat", "points", "soups", "steps", "late"),
)
"""Of the table; then one column per question. `complete` is 1 if the participant has played and answered everything."""


def as_csv(log: StudyLog) -> str:
    """Returns all games that were played to their end, by participant and game."""
    study, out = log.study, StringIO()
    questions = tuple(study.plan.questions)
    rows = csv.writer(out, lineterminator="\n")
    rows.writerow((*COLUMNS, *questions))
    for code, one in sorted(log.participants.items(), key=lambda item: (item[1].number, item[0])):
        trials = study.trials(one.number)
        complete = len(one.played) == len(trials) and log.unanswered(code) is None
        for played in one.played:
            trial, answers = trials[played.game], one.answers.get(played.game, {})
            rows.writerow(
                (
                    *(study.plan.name, code, one.number, int(complete), played.game, trial.layout, trial.condition),
                    *(trial.partner, played.partner, trial.label, trial.seat, f"{played.points:g}", played.soups),
                    *(played.steps, played.late, *(answers.get(question, "") for question in questions)),
                )
            )
    return out.getvalue()

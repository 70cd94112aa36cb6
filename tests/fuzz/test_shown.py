"""What is read of a score and of its explanation can be shown and compared, whatever else the files say."""

import json
from contextlib import suppress
from dataclasses import replace
from io import StringIO

import msgspec
import pytest
from rich.console import Console

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.comparing.compare import compare
from overcooked_bench.evaluation.explaining.reasons import PAIRINGS, REASONS, Soups
from overcooked_bench.evaluation.explaining.records import (
    EXPLAIN_FILE,
    Explanation,
    ExplanationError,
    Game,
    LayoutExplanation,
    Moment,
    Worst,
    read_explanation,
)
from overcooked_bench.evaluation.explaining.summary import by_axis, sum_up
from overcooked_bench.evaluation.metric import find_metrics
from overcooked_bench.evaluation.scores import SCORES_FILE, ScoresError, read_scores
from overcooked_bench.evaluation.shown.comparison import comparison_tables
from overcooked_bench.evaluation.shown.comparison_page import write_comparison
from overcooked_bench.evaluation.shown.explanation import explanation_tables
from overcooked_bench.evaluation.shown.report import gather, write_report
from overcooked_bench.evaluation.shown.sections.failure import failure_section
from overcooked_bench.evaluation.shown.terminal import score_tables
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.leaderboard.site.board import games_of, parts_of
from overcooked_bench.leaderboard.site.discriminating import discrimination
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.lines import as_csv, lines_of
from overcooked_bench.leaderboard.site.pages.entry import entry_page
from overcooked_bench.leaderboard.site.pages.protocol import protocol_page
from tests.evaluation.comparing.made import REPORT, agent, method
from tests.fuzz.harness import TRIES, attack, seeded
from tests.fuzz.mutators import as_json, trees_of

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore:Glyph")]  # of characters that a font does not have

EVERYTHING = msgspec.structs.replace(REPORT, metrics=tuple(metric.facts.name for metric in find_metrics()))
SHOWN_AS_PAGE = 5
"""One in so many scores is shown as a page, too, which takes a second."""


def printed(laid):
    console = Console(file=StringIO(), width=100)
    console.print(laid)
    return console.file.getvalue()


@TRIES
def test_scores_that_are_read_are_shown_and_compared(tries, tmp_path):
    file = tmp_path / SCORES_FILE
    pairs = [(make(0, report=EVERYTHING), make(1, report=EVERYTHING, name="other")) for make in (agent, method)]
    seeds, others = [msgspec.to_builtins(one) for one, _ in pairs], [other for _, other in pairs]
    count = iter(range(10**9))

    def read(content: bytes) -> None:
        file.write_bytes(content)
        scores = read_scores(file)
        assert "\x1b" not in printed(score_tables(scores, Beside(others[0]), explain=True))
        for other in others:
            with suppress(WrongUse):
                found = compare(scores, other)
                assert "\x1b" not in printed(comparison_tables(found))
                write_comparison(found, tmp_path / "comparison.html")
        if next(count) % SHOWN_AS_PAGE == 0:
            write_report(scores, tmp_path)
            entry = Entry("mine", scores, shipped=True)
            page = entry_page(replace(entry, parts=parts_of(scores)), others[0])
            assert page.count("</script>") == page.count("<script")
            (games,) = games_of([entry])
            protocol_page(games, {name: discrimination([entry], name) for name in scores.settings.play.layouts})
            as_csv(lines_of([games]))

    inputs = as_json(trees_of(seeds, seeded("shown")))
    attack("shown scores", [json.dumps(one).encode() for one in seeds], inputs, read, ScoresError, tries).check()


def explanation(scores):
    """An explanation of three moments on one layout."""
    kitchens = Kitchens("cramped_room", 1)
    kitchens.reset(seed=0)
    soups = Soups((0.0,) * 4, (3.0,) * 4, (3.0,) * 4, (3.0,))
    moments = tuple(
        Moment(
            **dict(training_seed=0, episode=i, partner=f"own-{i}", stratum="own", seat=0, step=60, soups=soups),
            **dict(reason="clash", differ=("dishes",) if i else (), agree=() if i else ("dishes",)),
        )
        for i in range(3)
    )
    games = {pairing: Game(repeat=0, soups=0.0, actions=("SUD", "LRI")) for pairing in PAIRINGS}
    state = kitchens.state(0).to_dict()
    worst = Worst(name="moment-1", moment=0, conventions=({}, {}), state=state, games=games, scenario=None)
    shares = sum_up([("cramped_room", moment) for moment in moments])
    layout = LayoutExplanation(
        **dict(layout="cramped_room", shares=shares, axes=by_axis("cramped_room", ("dishes",), moments)),
        **dict(conventions={"0": "dishes=top"}, moments=moments, worst=(worst,)),
    )
    return Explanation(
        **dict(agent=scores.agent, pool=scores.pool, protocol=scores.protocol, cooking="auto", steps=100, repeats=4),
        **dict(reasons={reason: meaning.meaning for reason, meaning in REASONS.items()}, interval="95 %"),
        **dict(layouts=(layout,), strata={"own": shares}, total=shares),
    )


@TRIES
def test_explanations_that_are_read_are_shown(tries, tmp_path):
    scores = agent(0)
    whole = explanation(scores).to_json().encode()

    def read(content: bytes) -> None:
        (tmp_path / EXPLAIN_FILE).write_bytes(content)
        section = failure_section(gather(scores, tmp_path))
        found = read_explanation(tmp_path)
        assert "\x1b" not in printed(explanation_tables(found))
        if content == whole:
            assert "The worst moments" in "".join(section.parts)

    inputs = as_json(trees_of([json.loads(whole)], seeded("explanations")))
    attack("shown explanations", [whole], inputs, read, ExplanationError, tries).check()

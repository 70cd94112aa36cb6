"""What a user sees at the end of a run: one table that fits, short notes, and the rest behind --explain."""

from io import StringIO

import msgspec
import pytest
from rich.console import Console

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.cli import main
from overcooked_bench.evaluation import beside as module
from overcooked_bench.evaluation.beside import Beside, beside
from overcooked_bench.evaluation.protocol import load_protocol, read_protocol
from overcooked_bench.evaluation.references import reference_scores
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.evaluation.shown.terminal import score_tables
from overcooked_bench.evaluation.summary import recompute
from tests.agents.made import record, scripted, write_policy
from tests.evaluation.made import DRAW, SCRIPTED_POOL, changed, protocol_text, reporting, score, write_agent

STRATA = {"sp-0": "own", "sp-1": "other-trainers", "greedy": "scripted", "clockwise": "human"}


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """Four partners of four strata on one layout, with bounds, and a floor."""
    home = tmp_path_factory.mktemp("pools") / "strangers"
    bound = dict(floor_agent="stay", low=90, high=110, episodes=9, responder="greedy", responder_sha256="0" * 64)
    partners = []
    for name, stratum in STRATA.items():
        if name.startswith("sp"):
            write_policy(home / "cramped_room" / name, int(name[-1]))
        entry = record(name) if name.startswith("sp") else scripted(name)
        bounds = (Bound(side=0, floor=0, ceiling=40, **bound),)
        partners.append(msgspec.structs.replace(entry, stratum=stratum, bounds=bounds))
    write_manifest(home, "strangers", [*partners, scripted("stay", role="floor")])
    return home


@pytest.fixture(scope="module")
def rules(pool):
    v1 = load_protocol("v1").report
    protocol = read_protocol(protocol_text(horizon=120), "p.yaml")
    protocol = changed(protocol, pool=str(pool), self_play=True)
    return reporting(protocol, **{name: getattr(v1, name) for name in v1.__struct_fields__})


@pytest.fixture(scope="module")
def scored(rules, tmp_path_factory):
    return score(f"{rules.play.pool}/cramped_room/sp-1", rules, output=tmp_path_factory.mktemp("scores") / "mine-tiny")


def shown(scores, *arguments, **more):
    console = Console(width=100, file=StringIO())
    console.print(score_tables(scores, *arguments, **more))
    return console.file.getvalue()


def table_of(text):
    """The rows of the only table: the first word -> the whole line."""
    table = text.partition("───\n")[2].partition("One agent")[0]
    return {line.split()[0]: line for line in table.splitlines() if line.strip()}


def test_a_score_returns_its_table_as_plain_text(scored):
    for explain in (False, True):
        lines = shown(scored.scores, explain=explain).rstrip().splitlines()
        assert scored.table(explain) == "\n".join(line.rstrip() for line in lines)


def test_one_table_with_the_reference_below(scored, rules):
    scores = scored.scores
    text = shown(scores, Beside(reference_scores(rules)))
    assert max(map(len, text.splitlines())) <= 100
    assert text.count("───\n") == 1
    rows = table_of(text)
    assert rows.keys() == {"cramped_room", "mean", "greedy"}
    n, h50 = (scores.find(name, layout="cramped_room") for name in ("n", "h50"))
    assert f" {n.estimate.text(2)} " in rows["cramped_room"]
    assert f" {100 * h50.value:.0f} % " in rows["cramped_room"]
    for stratum in STRATA.values():
        assert f" {scores.find('n', layout='cramped_room', stratum=stratum).value:.2f}" in rows["cramped_room"]
    plain = " ".join(text.split())
    for words in ("own", "scripts", "One agent: intervals over partners and start states.", "--explain", "H50: share"):
        assert words in plain
    assert "needs 19" not in text


def test_the_rest_is_behind_explain(scored, rules):
    text = shown(scored.scores, Beside(reference_scores(rules)), explain=True)
    assert max(map(len, text.splitlines())) <= 100
    assert "…" not in text
    for words in ("worst partner", "≥5", "itself", "potted", "its partners", "blocked", "nothing about retraining"):
        assert words in text
    assert "--explain" not in text


def test_a_layout_without_the_others_stands_beside_the_reference_there(scored, rules):
    partial = msgspec.structs.replace(scored.scores, overall=None, unranked="coordination_ring not played to the end")
    rows = table_of(shown(partial, Beside(reference_scores(rules))))
    assert list(rows) == ["cramped_room", "greedy", "mean"]
    assert rows["mean"].split()[-1] == "none"


def test_the_criterion_is_a_column_and_never_ranks(scored, pool, rules, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "load_protocol", lambda name: criterion)
    criterion = changed(reporting(rules, headlines=(), criterion=None), horizon=60)
    criterion = msgspec.structs.replace(criterion, name="people")
    agent = f"{pool}/cramped_room/sp-1"
    other = score(agent, criterion, output=scored.folder.parent / f"{scored.scores.agent.name}-people").scores
    found = beside(scored.scores, scored.folder)
    assert found == Beside(None, other)
    text = shown(scored.scores, found)
    assert table_of(text)["cramped_room"].endswith(f" {other.find(layout='cramped_room').value:.1f}")
    assert "never ranked" in " ".join(text.split())
    assert beside(scored.scores, tmp_path / "elsewhere").criterion is None
    stay = score("stay", criterion, output=tmp_path / f"{scored.scores.agent.name}-people").scores
    assert stay.agent != scored.scores.agent
    assert beside(scored.scores, tmp_path / "mine-tiny").criterion is None, "another agent of the same name"


def test_columns_that_can_be_spared_make_room(scored):
    ends = {}
    for width in range(100, 60, -1):
        text = shown(scored.scores, width=width)
        head = " ".join(text.split("───")[0].split())
        ends.setdefault(head.partition("human scripts ")[2], text)
        if width > 75:
            assert max(map(len, text.splitlines()[2:9])) <= width
    assert list(ends) == ["away third points", "away points", "points", ""]


def test_a_protocol_that_does_not_rank_shows_standard_errors(scored, rules):
    lite = msgspec.structs.replace(scored.scores, settings=reporting(rules, ranked=False), unranked="never")
    n = scored.scores.find("n", layout="cramped_room")
    text = shown(lite)
    assert "N ± s.e." in text
    assert f" {n.value:.2f} ± {n.error:.2f} " in text
    assert "Not ranked: never." in text


def test_with_a_pool_without_bounds_the_mean_of_layouts_is_shown_and_why_there_is_no_n(rules, tmp_path):
    scores = score("stay", rules, SCRIPTED_POOL, output=tmp_path / "out").scores
    text = shown(scores)
    assert table_of(text)["mean"].split()[-1] == f"{scores.find().value:.1f}"
    assert "N" not in text.split("───")[0].split()
    assert "the pool scripted has no bounds for all partners, so there is no N." in " ".join(text.split())


def test_agents_that_are_partners_are_found_among_them_on_each_layout(pool, rules, tmp_path):
    scores = score(f"{pool}/{{layout}}/sp-1", rules, output=tmp_path / "out").scores
    assert [label.name for label in scores.layouts[0].partners if label.is_ego] == ["sp-1"]
    assert scores.unranked == "strangers-sp-1 is itself among the partners"
    assert recompute(tmp_path / "out").unranked == scores.unranked


@pytest.mark.slow
def test_the_runs_of_a_method_are_listed(rules, tmp_path):
    own = f"{DRAW.replace('return', 'drawn =')}\n        return (drawn + self.training_seed) % 6"
    agent = write_agent(tmp_path / "agent.py", own, training_seeds=5)
    scores = score(agent, rules, output=tmp_path / "out").scores
    assert (scores.kind, scores.unranked) == ("method", None)
    assert "A method of 5 training runs: intervals over them." in shown(scores)
    values = scores.find("n", layout="cramped_room").per_repetition
    long = " ".join(shown(scores, explain=True).split())
    assert f"N of single training seeds: cramped_room {min(values):.2f} to {max(values):.2f}." in long
    assert "No interval sees a failure that is not among them." in long


def test_the_command_takes_the_standard_start_and_explains(pool, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = protocol_text(pool=pool, episodes=1).replace("report:", "report:\n  headlines: [n]")
    (tmp_path / "tiny.yaml").write_text(text.replace("play:", f"play:\n  pool_sha256: {'a' * 64}"))
    arguments = ["score", "stay", "--protocol", "tiny.yaml", "--pool", str(pool), "--no-scenarios", "--workers", "1"]
    assert main([*arguments, "--start", "standard", "--explain"]) == 0
    assert "worst partner" in capsys.readouterr().out
    scores = read_scores(tmp_path / "scores" / "stay-tiny-standard")
    assert (scores.settings.play.start, scores.protocol.name) == ("standard", "tiny-standard")
    assert main(arguments) == 0
    assert "worst partner" not in capsys.readouterr().out

"""What a score says where an agent declines a layout, or a training run of it does."""

import re
from html import unescape
from io import StringIO

import pytest
from rich.console import Console

from overcooked_bench.evaluation.protocol import ProtocolError, read_protocol
from overcooked_bench.evaluation.scores import Declined, read_scores
from overcooked_bench.evaluation.shown.terminal import score_tables
from tests.evaluation.made import protocol_text, score, write_agent


def shown(scores):
    console = Console(width=200, file=StringIO())
    console.print(score_tables(scores))
    return console.file.getvalue()


def going_to(x, y):
    """A script that plays only where this is a cell of the floor; our own code, so no process is started for it."""
    return f"script:{{does: goto, cell: [{x}, {y}]}}"


def test_a_declined_layout_is_listed_and_leaves_no_overall(tmp_path):
    protocol = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"]), "p.yaml")
    scores, folder, *_ = score(going_to(1, 3), protocol, output=tmp_path / "out")
    assert [layout.layout for layout in scores.layouts] == ["coordination_ring"]
    ((layout, reason),) = [(one.layout, one.reason) for one in scores.declined]
    assert layout == "cramped_room"
    assert (scores.overall, scores.find(), scores.unranked) == (None, None, "cramped_room declined")
    for text in (unescape((folder / "report.html").read_text()), shown(scores)):
        assert f"Declined: cramped_room ({reason})." in " ".join(text.split())
        assert "No overall score" in text
    whole = score("stay", protocol, output=tmp_path / "all").scores
    assert whole.overall == whole.find().estimate
    some = score("stay", protocol, layouts=["cramped_room"], output=tmp_path / "some").scores
    assert (some.overall, some.unranked) == (None, "coordination_ring not played to the end")
    scores, folder, *_ = score(going_to(20, 20), protocol, output=tmp_path / "nothing")
    assert (scores.layouts, scores.overall) == ((), None)
    assert [one.layout for one in read_scores(folder).declined] == ["cramped_room", "coordination_ring"]


@pytest.mark.slow
def test_an_agent_is_asked_once_per_layout_before_anything_is_played(tmp_path):
    protocol = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"]), "p.yaml")
    log = tmp_path / "log.txt"
    make = f"open({str(log)!r}, 'a').write(layout + '\\n')\n    if layout == 'cramped_room': raise UnknownLayout('no')"
    score(write_agent(tmp_path / "agent.py", make=make, training_seeds=2), protocol, output=tmp_path / "out")
    made = log.read_text().split()
    assert made[:2] == ["cramped_room", "coordination_ring"]
    assert made[2:] == ["coordination_ring"] * 4  # two blocks, and one of them twice more


@pytest.mark.slow
def test_a_training_run_that_declines_alone_is_at_fault(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", make="if training_seed: raise UnknownLayout('no')", training_seeds=2)
    scores = score(agent, protocol, output=tmp_path / "out").scores
    assert scores.declined == ()
    assert re.match(r"cramped_room, training seed 1: it declines \(no\)", scores.faults[0])


def test_a_frozen_agent_plays_its_own_layout_alone(pool_folder, tmp_path):
    protocol = read_protocol(protocol_text(layouts=["coordination_ring", "cramped_room"]), "p.yaml")
    scores, *_ = score(f"{pool_folder}/cramped_room/sp-1", protocol, output=tmp_path / "out")
    assert [layout.layout for layout in scores.layouts] == ["cramped_room"]
    assert scores.declined == (Declined("coordination_ring", "it plays only cramped_room"),)
    with pytest.raises(ProtocolError, match="plays only cramped_room"):
        score(f"{pool_folder}/cramped_room/sp-1", protocol, layouts=["coordination_ring"], output=tmp_path / "b")

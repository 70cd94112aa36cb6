"""Scores of submissions that are edited, keep state, change what is shared, or end or block their process."""

import json
import re

import pytest

from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.cli import main
from overcooked_bench.evaluation.games import cutting
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.score import score
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE
from tests.evaluation.made import protocol_text, write_agent

pytestmark = pytest.mark.slow  # every one starts a process


def run(agent, protocol, output, **settings):
    return score(agent, protocol, output=output, scenarios=False, **settings)


def test_a_score_does_not_outlive_a_change_beside_the_file(protocol, tmp_path):
    (tmp_path / "helper.py").write_text("NAME = 'stay'\n")
    agent = tmp_path / "mine.py"
    agent.write_text(
        "from helper import NAME\nfrom overcooked_bench import load_agent\n\n"
        "def make_agent(layout, training_seed):\n    return load_agent(NAME, layout)\n"
    )
    first = run(agent, protocol, tmp_path / "out")
    assert first.episodes > 0
    assert run(agent, protocol, tmp_path / "out").episodes == 0
    (tmp_path / "helper.py").write_text("NAME = 'greedy'\n")
    with pytest.raises(StoreError, match="belongs to another agent"):
        run(agent, protocol, tmp_path / "out")
    other = run(agent, protocol, tmp_path / "fresh")
    assert other.scores.agent.sha256 != first.scores.agent.sha256


def test_state_that_outlives_a_block_is_reported(protocol, tmp_path, capsys):
    agent = write_agent(tmp_path / "mine.py", act="return rng.integers(0, 6, n)")
    agent.write_text(agent.read_text() + "\nrng = np.random.default_rng(0)\n")
    rules = tmp_path / "p.yaml"
    rules.write_text(protocol_text())
    arguments = ["--protocol", str(rules), "--output", str(tmp_path / "out"), "--no-scenarios"]
    assert main(["score", str(agent), *arguments]) == 0
    assert "warning: mine plays a block differently when it is played again" in capsys.readouterr().err
    (warning,) = json.loads((tmp_path / "out" / SCORES_FILE).read_text())["run"]["warnings"]
    assert warning.startswith("mine plays a block differently")
    honest = run(write_agent(tmp_path / "honest.py"), protocol, tmp_path / "honest")
    assert "warnings" not in honest.scores.run


def test_a_hang_costs_its_layout_and_no_other(tmp_path, monkeypatch):
    monkeypatch.setattr(cutting, "LEAST_ROWS", 4)  # a block for each start state
    rules = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"], episodes=3), "p.yaml")
    act = "while self.layout == 'cramped_room': pass\n        return np.full(n, 4)"
    scores, folder, *_ = run(write_agent(tmp_path / "a.py", act=act), rules, tmp_path / "out", act_timeout=1)
    (fault,) = scores.faults
    assert re.match("cramped_room, training seed 0, episode 0: act, step 0: no answer within 1 s", fault)
    with Store(folder / EPISODES_FILE) as store:
        assert store.blocks() == {("coordination_ring", 0, episode) for episode in range(3)}


def test_a_process_that_ends_while_the_submission_is_imported(protocol, tmp_path, capfd):
    agent = tmp_path / "a.py"
    agent.write_text("import os\nos._exit(0)\n")
    with pytest.raises(AgentError, match=r"a\.py: loading: the worker process ended with exit code 0"):
        run(agent, protocol, tmp_path / "out")


@pytest.mark.parametrize("patched", ["np.ascontiguousarray", "np.empty"])
def test_a_submission_that_breaks_what_others_use_is_at_fault(protocol, tmp_path, patched):
    """Partners fail of it, or the game itself does."""
    act = f"{patched} = lambda *_, **__: 1 / 0\n        return [4] * n"
    (fault, *_) = run(write_agent(tmp_path / "a.py", act=act), protocol, tmp_path / "out").scores.faults
    assert re.match("cramped_room, training seed 0, episodes 0 to 1.*does (this one|the agent) change.*", fault)


@pytest.mark.parametrize(("when", "workers"), [("top", 1), ("act", 2)])
def test_a_submission_that_changes_the_directory(protocol, tmp_path, monkeypatch, workers, when):
    monkeypatch.chdir(tmp_path)
    chdir = "__import__('os').chdir('/')"
    act = f"{chdir}\n        return np.full(n, 4)" if when == "act" else "return np.full(n, 4)"
    agent = write_agent(tmp_path / "a.py", act=act)
    if when == "top":
        agent.write_text(f"{chdir}\n{agent.read_text()}")
    scored = run("a.py", protocol, "out", workers=workers)
    assert scored.scores.faults == ()
    assert (tmp_path / "out" / SCORES_FILE).is_file()

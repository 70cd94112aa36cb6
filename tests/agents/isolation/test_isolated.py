"""Agents in processes of their own play as they do here, and fail with the same words."""

import os
import re
from dataclasses import replace

import numpy as np
import pytest

from overcooked_bench import UnknownLayout
from overcooked_bench.agents.agent import UnknownLayout as Unknown
from overcooked_bench.agents.catalogue import find, find_unchanged
from overcooked_bench.agents.isolation import bubblewrap
from overcooked_bench.agents.isolation.settings import IsolationError, isolate
from overcooked_bench.agents.pools.lineage import Origin
from overcooked_bench.agents.seated import Seated, SeatedFault
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.protocol import read_protocol
from tests.evaluation.made import DRAW, block, protocol_text, write_agent
from tests.isolating import LEVELS, isolation_of

pytestmark = pytest.mark.slow  # every test starts processes

SEEDED = "return np.random.randint(0, 6, n)"
BY_STATE = "return [(s.chefs[0].position[0] + len(s.objects) + step) % 6 for s in observations]"


@pytest.fixture(autouse=True)
def _no_other_submission():
    yield
    find_unchanged.cache_clear()


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize(
    ("act", "observation"),
    [(DRAW, "lossless"), (SEEDED, "features"), (BY_STATE, "state")],
    ids=["draws", "seeded", "state"],
)
def test_episodes_are_the_same_isolated_or_not(tmp_path, level, act, observation):
    agent = write_agent(tmp_path / "a.py", act=act, observation=observation)
    here = block(read_protocol(protocol_text(horizon=20), "p.yaml"), agent)
    apart = play_block(replace(here, isolation=isolation_of(level)))
    assert apart.fault is None
    assert apart.episodes == play_block(here).episodes


@pytest.mark.parametrize("level", LEVELS)
def test_every_agent_has_a_process_in_which_no_other_has_been(tmp_path, level):
    agent = write_agent(tmp_path / "a.py", act="made.append(1)\n        return np.full(n, len(made))")
    agent.write_text(agent.read_text() + "\nmade = []\n")
    make = find(agent, isolation=isolation_of(level)).make
    for _ in range(2):
        one = make("cramped_room", 0)
        one.reset("cramped_room", np.zeros(1, np.int64), np.zeros(1, np.uint64))
        assert one.act(np.zeros((1, 22, 4, 5), np.uint8)).tolist() == [1]


ACTS = {
    "raises": "raise ValueError('oh')",
    "exits": "raise SystemExit(3)",
    "one too few": "return np.zeros(n - 1, int)",
    "out of range": "return [0, 7, 9][:n]",
    "no numbers": "return ['a'] * n",
    "not a number": "return np.full(n, np.nan)",
    "declines late": "raise UnknownLayout('too late')",
    "of one game": "from overcooked_bench.agents.agent import GameError; raise GameError('row 1: oh', 1)",
}


def test_faults_have_the_same_words_isolated_or_not(tmp_path):
    text = write_agent(tmp_path / "a.py", act="exec(acts[self.training_seed])", training_seeds=len(ACTS)).read_text()
    text = text.replace("exec(acts[self.training_seed])", "return answer(self.training_seed, n)")
    text += "\ndef answer(which, n):\n" + "".join(
        f"    if which == {which}:\n        {act}\n" for which, act in enumerate(ACTS.values())
    )
    (tmp_path / "a.py").write_text(text)
    makers = find(tmp_path / "a.py").make, find(tmp_path / "a.py", isolation=isolation_of("weak")).make
    for which in range(len(ACTS)):
        said = []
        for make in makers:
            seated = Seated(make("cramped_room", which), "it", np.arange(3), np.zeros(3, np.int64))
            seated.reset("cramped_room", np.arange(3, dtype=np.uint64))
            with pytest.raises(SeatedFault) as caught:
                seated.act(np.zeros((3, 22, 4, 5), np.uint8))
            said.append((str(caught.value), caught.value.row, caught.value.step))
        assert said[0] == said[1]


def test_what_a_submission_says_about_itself_is_asked_for(tmp_path):
    declines = "if training_seed: raise UnknownLayout('not here')"
    agent = write_agent(tmp_path / "a.py", training_seeds=3, make=declines)
    agent.write_text('CODEBASE = "other"\nPEOPLE = ["2019-00"]\n' + agent.read_text())
    here, apart = find(agent), find(agent, isolation=isolation_of("weak"))
    assert (apart.name, apart.sha256, apart.training_seeds) == (here.name, here.sha256, 3)
    assert apart.origin == here.origin == Origin("other", ("2019-00",))
    with pytest.raises(Unknown, match="not here"):
        apart.make("cramped_room", 1)
    assert Unknown is UnknownLayout
    for make in (here.make, apart.make):
        with pytest.raises(AgentError, match=r"a\.py: no training seed 3; TRAINING_SEEDS = 3 means 0 to 2"):
            make("cramped_room", 3)
    os.utime(agent, (0, 0))
    with pytest.raises(AgentError, match=r"a\.py was changed after it was hashed"):
        apart.make("cramped_room", 0)


def test_a_submission_that_cannot_be_imported_is_at_fault(tmp_path):
    (tmp_path / "a.py").write_text("import nothing_of_this_name\n")
    with pytest.raises(AgentError, match=r"a\.py, line 1: ModuleNotFoundError.*\(while it was imported\)"):
        find(tmp_path / "a.py", isolation=isolation_of("weak"))
    with pytest.raises(AgentError, match=r"b\.py: no such file"):
        find(tmp_path / "b.py", isolation=isolation_of("weak"))


def test_strict_isolation_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    bubblewrap.missing.cache_clear()
    try:
        weak = isolate("best", 1.0)
        with pytest.raises(IsolationError, match=r"bubblewrap is not installed.*apt-get install bubblewrap"):
            isolate("strict", 1.0)
    finally:
        bubblewrap.missing.cache_clear()
    assert weak.level == "weak"
    assert re.match("Isolation was weak .bubblewrap is not installed.", weak.sentence)

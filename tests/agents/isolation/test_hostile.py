"""Hostile submissions, isolated with and without bubblewrap: none changes anything but its own score.

Each file in `hostile/` is a submission that attacks at its third step and says "reached ..." where it got through;
SECURITY.md lists them with what came of them.
"""

import platform
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from overcooked_bench.agents.catalogue import find_unchanged
from overcooked_bench.agents.isolation.bubblewrap import missing
from overcooked_bench.agents.isolation.seccomp import MACHINES
from overcooked_bench.agents.isolation.settings import Limits
from overcooked_bench.agents.kinds import identity_of
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.score import score
from overcooked_bench.evaluation.scores import EPISODES_FILE
from tests.evaluation.made import block, changed, protocol_text
from tests.isolating import LEVELS, isolation_of

pytestmark = pytest.mark.slow  # every test starts processes

FOLDER = Path(__file__).with_name("hostile")
SECURITY = Path(__file__).parents[3] / "SECURITY.md"
RULES = read_protocol(protocol_text(horizon=6, episodes=2), "tiny.yaml")
HARMLESS, HONEST = "harmless", "honest"
LEAST = Limits(memory=1 << 30, file_bytes=1 << 24)
"""So little that what grows without end is at its limit at once."""


@dataclass(frozen=True)
class Attack:
    """What comes of a hostile submission.

    Attributes:
        faults: What the fault of each training seed says; none where it plays on.
        reached: What it may reach in weak isolation; in a sandbox nothing ever.
        seconds: The time limit of a call.
        limits: Of its process.
        weak: Whether it is played in weak isolation, too.
        alike: Whether it plays as a harmless one does where it is not at fault.
        certain: Whether it is at fault for certain.
        at_loading: Whether it is at fault before any game.
    """

    faults: tuple[str, ...] = ()
    reached: frozenset[str] = frozenset()
    seconds: float = 60.0
    limits: Limits = field(default=Limits())
    weak: bool = True
    alike: bool = True
    certain: bool = True
    at_loading: bool = False


ANSWER = "act: it sent a message that is no answer"
ATTACKS: Mapping[str, Attack] = {
    # these play on
    "blind_partner": Attack(),
    "clock": Attack(alike=False),
    "edit_store": Attack(reached=frozenset({"the store"})),
    "fork_bomb": Attack(),
    "kill_others": Attack(),
    "network": Attack(),
    "noise": Attack(),
    "outlive": Attack(),
    "parent_memory": Attack(reached=frozenset({"memory of another process"})),  # not of root's, and not everywhere
    "patch_game": Attack(),
    "raise_limits": Attack(),
    "read_files": Attack(reached=frozenset({"the pools", "files", "other processes in /proc"})),
    "search_memory": Attack(),
    "write_files": Attack(reached=frozenset({"a place to write"})),
    # these are at fault
    "allocate": Attack(("MemoryError",), limits=LEAST),
    "burn_cpu": Attack(
        ("its process was ended by SIGXCPU: it had used its 1 s of CPU time",), limits=Limits(cpu_seconds=1)
    ),
    "crash": Attack(("its process was ended by SIGSEGV",)),
    "fill_disk": Attack(("OSError.*(No space left|File too large)",), limits=LEAST, weak=False),
    "forge": Attack(
        (
            r"act returned the action 255 in row 0",
            "act: it sent an answer of 9,223,372,036,854,775,808 bytes",
            "act: it sent an answer to another request",
            ANSWER,
            r"act\(\) raised GameError",
            r"act returned the shape \(0,\)",
        )
    ),
    "garbage": Attack((ANSWER, ANSWER)),
    "leave": Attack(("its process ended with exit code 0",)),
    "lie_about_facts": Attack(("TRAINING_SEEDS is 1000000000",), at_loading=True),
    "scribble": Attack(("act",), certain=False),
    "send_pickle": Attack((ANSWER,)),
    "sleep": Attack(("act: no answer within 2 s",), seconds=2.0),
    "thread_bomb": Attack(("can't start new thread",), limits=LEAST),
    "wrong_answers": Attack(("act returned",) * 9),
}


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A user's folder: submissions, a score beside them, and files that are nobody else's business."""
    home = tmp_path_factory.mktemp("user")
    shutil.copytree(FOLDER, home / "submissions", ignore=shutil.ignore_patterns("__pycache__"))
    (home / "elsewhere.txt").write_text("private")
    score("greedy", RULES, output=home / "out", scenarios=False)
    yield home
    find_unchanged.cache_clear()


@pytest.fixture(scope="module")
def before(home):
    """What a harmless and an honest submission play before any attack."""
    return {name: play(home, name, None).episodes for name in (HARMLESS, HONEST)}


def play(home, name, level, attack=None, training_seed=0):
    """Plays a block, isolated or, if the level is None, here."""
    agent, attack = home / "submissions" / f"{name}.py", attack or Attack()
    isolation = level and replace(isolation_of(level, attack.seconds), limits=attack.limits)
    sha256 = identity_of(agent, "submission").sha256
    made = block(RULES, training_seed=training_seed)
    return play_block(replace(made, agent=str(agent), agent_sha256=sha256, isolation=isolation))


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("name", ATTACKS)
def test_a_hostile_submission_changes_nothing_but_its_own_score(home, before, level, name, capsys):
    attack = ATTACKS[name]
    if level == "weak" and not (attack.weak and platform.machine() in MACHINES):
        pytest.skip("this would harm the machine that tests it")
    if attack.at_loading:
        with pytest.raises(AgentError, match=attack.faults[0]):
            play(home, name, level, attack)
    for seed, fault in enumerate(() if attack.at_loading else attack.faults):
        found = play(home, name, level, attack, training_seed=seed).fault
        where = rf"cramped_room, training seed {seed}, episode 0, partners? .*, step \d: .*{fault}"
        assert re.match(where, found or "") or not attack.certain
    for _ in range(0 if attack.faults else 2):  # again, where something was left for it
        outcome = play(home, name, level, attack)
        assert outcome.fault is None
        assert outcome.episodes == before[HARMLESS] or not attack.alike
    said = capsys.readouterr().err.splitlines()
    reached = {line.removeprefix("reached ") for line in said if line.startswith("reached ")}
    assert reached <= (set() if level == "strong" else attack.reached)
    assert play(home, HONEST, None).episodes == before[HONEST]


@pytest.mark.parametrize("level", LEVELS)
def test_a_score_says_what_happened_where_and_keeps_what_was_played(home, tmp_path, monkeypatch, level):
    isolation_of(level)
    if level == "weak":
        monkeypatch.setenv("PATH", "/nowhere")
        missing.cache_clear()
    rules = changed(RULES, layouts=("cramped_room", "coordination_ring"))
    agent, out = home / "submissions" / "leave_later.py", tmp_path / "out"
    scores = score(agent, rules, output=out, isolate="best", scenarios=False).scores
    missing.cache_clear()
    (fault,) = scores.faults
    assert re.match(r"coordination_ring, training seed 0, .*step 2: act: its process ended with exit code 0", fault)
    assert scores.run["isolation"]["level"] == level
    with Store(out / EPISODES_FILE) as store:
        assert {layout for layout, *_ in store.blocks()} == {"cramped_room"}


def test_every_hostile_submission_is_tried_and_listed():
    files = {file.stem for file in FOLDER.glob("*.py")} - {"common", HARMLESS, HONEST, "leave_later"}
    assert files == set(ATTACKS)
    listed = set(re.findall(r"^\| `(\w+)` \|", SECURITY.read_text(), re.MULTILINE))
    assert listed == set(ATTACKS)

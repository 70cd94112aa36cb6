import hashlib
import json
import shutil
import sqlite3
from collections import Counter
from contextlib import closing

import msgspec
import pytest

from overcooked_bench.agents.policies.policy import load_policy, save_policy
from overcooked_bench.agents.seated import SeatedFault
from overcooked_bench.agents.submissions.content import hash_submission
from overcooked_bench.errors import AgentFault, WrongUse
from overcooked_bench.evaluation.explaining.explain import explain
from overcooked_bench.evaluation.explaining.reasons import FAILURES, PAIRINGS, reason_for
from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE, ExplanationError, read_explanation
from overcooked_bench.evaluation.games.play import play_episodes
from overcooked_bench.evaluation.games.store import StoreError
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE
from overcooked_bench.evaluation.summary import recompute
from overcooked_bench.scenarios.items import load_items
from overcooked_bench.scenarios.runner import run_scenarios
from tests.evaluation.explaining.conftest import HABITS, LAYOUT
from tests.evaluation.made import protocol_text, score, write_agent
from tests.isolating import isolation_of

pytestmark = pytest.mark.slow


def reasons(explanation, partner):
    return Counter(moment.reason for moment in explanation.layouts[0].moments if moment.partner == partner)


def test_habits_that_do_not_fit_are_a_clash_that_is_named(explained):
    found = reasons(explained.explanation, "sp-4")
    assert found["clash"] >= 0.5 * found.total()
    (layout,) = explained.explanation.layouts
    assert layout.conventions == {"0": "onions=bottom, dishes=middle"}
    for moment in layout.moments:
        if moment.partner == "sp-4":
            assert (moment.differ, moment.agree) == (("onions", "dishes"), ())
    onions = next(axis for axis in layout.axes if axis.axis == "onions" and axis.differ)
    differ = [moment.reason for moment in layout.moments if "onions" in moment.differ and moment.reason != "nothing"]
    assert onions.shares.moments == len(differ)
    assert onions.shares.reasons["clash"].value == pytest.approx(differ.count("clash") / len(differ))


@pytest.mark.parametrize("partner", ["stay", "onion_courier"])
def test_partners_that_reach_nothing_alone_are_weak(explained, partner):
    found = reasons(explained.explanation, partner)
    assert found["weak partner"] > 0.5 * found.total()
    assert set(found) <= {"weak partner", "neither", "works"}


def test_an_agent_that_does_not_know_what_to_do_is_out_of_its_experience(rules, strangers, tmp_path):
    folder = score("random", rules, pool=strangers, output=tmp_path / "out").folder
    found = reasons(explain(folder, pool=strangers, moments=15).explanation, "sp-4")
    assert found["inexperience"] >= 0.7 * found.total()
    assert not found["clash"]
    assert not found["weak partner"]


def test_two_copies_of_one_policy_do_not_clash(rules, strangers, tmp_path):
    """The control: an agent whose partner has the same habits, as its weights differ by a thousandth."""
    policy = load_policy(strangers / LAYOUT / "sp-4.safetensors")
    weights = {name: 1.001 * tensor for name, tensor in policy.weights.items()}
    agent = str(save_policy(tmp_path / "same", policy.architecture, weights).weights)
    folder = score(agent, rules, pool=strangers, output=tmp_path / "out").folder
    found = reasons(explain(folder, agent=agent, pool=strangers, moments=24).explanation, "sp-4")
    assert found["works"] >= 0.8 * found.total()


def test_the_same_folder_is_explained_in_the_same_bytes(explained, scored, strangers, tmp_path):
    shutil.copytree(scored, tmp_path / "copy")
    for file in (tmp_path / "copy" / "moments").iterdir():
        file.unlink()
    (tmp_path / "copy" / "moments" / "moment-old-1.scenario.yaml").write_text("id: moment-old-1\n")
    explain(tmp_path / "copy", agent=HABITS, pool=strangers, workers=2, moments=24)
    files = {file.relative_to(scored) for file in scored.rglob("*") if file.is_file()}
    assert files == {file.relative_to(tmp_path / "copy") for file in (tmp_path / "copy").rglob("*") if file.is_file()}
    for file in files:
        assert (scored / file).read_bytes() == (tmp_path / "copy" / file).read_bytes()


def test_what_is_written_is_read_again_and_can_be_summed_up(explained):
    explanation = read_explanation(explained.folder)
    assert explanation == explained.explanation
    (layout,) = explanation.layouts
    counted = [moment for moment in layout.moments if moment.reason != "nothing"]
    assert len(layout.moments) == 24
    assert layout.shares.moments == len(counted)
    for moment in layout.moments:
        assert moment.reason == reason_for(moment.soups)
    for reason, share in layout.shares.reasons.items():
        assert share.value == pytest.approx(sum(one.reason == reason for one in counted) / len(counted))
    assert layout.shares.fails.value == pytest.approx(sum(layout.shares.reasons[one].value for one in FAILURES))
    assert sum(shares.moments for shares in explanation.strata.values()) == len(counted)


def test_the_worst_moments_can_be_watched_as_they_were_played(explained):
    (layout,) = explained.explanation.layouts
    assert len(layout.worst) == 3
    for worst in layout.worst:
        moment = layout.moments[worst.moment]
        assert moment.reason in ("clash", "inexperience", "neither")
        for pairing in PAIRINGS:
            *_, (last, points) = frames = list(worst.frames(layout.layout, pairing, explained.explanation.cooking))
            assert len(frames) == 101
            assert last.timestep == moment.step + 100
            assert points == 20 * worst.games[pairing].soups
            assert worst.games[pairing].soups in getattr(moment.soups, pairing)


def test_the_worst_moments_are_scenarios_that_run(explained):
    (layout,) = explained.explanation.layouts
    folder = explained.folder / "moments"
    for worst in layout.worst:
        assert worst.scenario == f"{worst.name}.scenario.yaml"
        (scenario,) = {item.scenarios[0] for item in load_items(folder / worst.scenario)}
        assert scenario.layout.name == LAYOUT
        moment, seat = layout.moments[worst.moment], layout.moments[worst.moment].seat
        assert list(scenario.state.chefs[0].position) == worst.state["players"][seat]["position"]
        assert moment.partner in scenario.why
    assert all(item.status == "failed" for item in run_scenarios("stay", folder, repeats=1).items)
    assert run_scenarios("greedy", folder, repeats=1).passed >= len(layout.worst)


def test_a_score_of_something_else_is_refused(scored, strangers, tmp_path):
    with pytest.raises(WrongUse, match=r"greedy is not the agent that was scored .* with --agent"):
        explain(scored, agent="greedy", pool=strangers)
    with pytest.raises(WrongUse, match=r"no agent named 'gredy'.* name the agent that was scored with --agent"):
        explain(scored, agent="gredy", pool=strangers)
    with pytest.raises(WrongUse, match=r"dev-v0: not the pool that .* was played with .* with --pool"):
        explain(scored, pool="dev-v0")
    with pytest.raises(WrongUse, match="no episodes on cramped_room; choose among forced_coordination"):
        explain(scored, layouts=["cramped_room"], pool=strangers)
    with pytest.raises(WrongUse, match=r"episodes\.sqlite: it names no pool; .* with --pool"):
        explain(scored)
    short = read_protocol(protocol_text(layouts=[LAYOUT], pool=str(strangers), episodes=1), "short.yaml")
    with pytest.raises(WrongUse, match="a horizon of 150 or more"):
        explain(score("stay", short, output=tmp_path / "short").folder)


def forge(scored, folder, **facts):
    """Copies a score, whose store then says what it is told to, with checksums that match."""
    shutil.copytree(scored, folder)
    with closing(sqlite3.connect(folder / EPISODES_FILE)) as connection, connection:
        for key, value in facts.items():
            connection.execute("DELETE FROM facts WHERE key = ?", (key,))
            connection.executemany("INSERT INTO facts VALUES (?, ?)", [(key, value)] * (value is not None))
        found = dict(connection.execute("SELECT key, value FROM facts WHERE key != 'checksum'"))
        checksum = hashlib.sha256(json.dumps(sorted(found.items())).encode()).hexdigest()
        connection.execute("UPDATE facts SET value = ? WHERE key = 'checksum'", (checksum,))
    return folder


@pytest.mark.parametrize("name", ["evil.py", "evil.py:make_other", "evil"])
def test_code_that_only_a_score_names_is_not_run(name, scored, strangers, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = f"open({str(tmp_path / 'ran')!r}, 'w').close()"
    (tmp_path / "evil").mkdir()
    for file in ("evil.py", "evil/agent.py"):
        write_agent(tmp_path / file, make=text)
        (tmp_path / file).write_text(f"{text}\n{(tmp_path / file).read_text()}")
    sha256 = hash_submission("evil" if name == "evil" else "evil.py")
    folder = forge(scored, tmp_path / "score", agent_given=name, agent=sha256)
    with pytest.raises(WrongUse, match=f"episodes.sqlite: .* only if you name it yourself: --agent {name}"):
        explain(folder, pool=strangers)
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(
    ("facts", "said"),
    [
        ({"training_seeds": "x"}, "training_seeds"),
        ({"training_seeds": "0"}, "training_seeds"),
        ({"training_seeds": "9" * 30}, "training_seeds"),
        ({"seed": "x"}, "seed"),
        ({"seed": "9" * 5000}, "seed"),
    ],
    ids=["seeds are words", "no seeds", "many seeds", "the seed is a word", "a huge seed"],
)
def test_a_store_that_does_not_say_what_it_is_is_refused_by_name(facts, said, scored, strangers, tmp_path):
    folder = forge(scored, tmp_path / "score", **facts)
    for read in (lambda: explain(folder, agent=HABITS, pool=strangers), lambda: recompute(folder)):
        with pytest.raises(StoreError, match=f"episodes.sqlite: what identifies the score .*{said}"):
            read()
    nobody = forge(scored, tmp_path / "nobody", agent=None)
    with pytest.raises(WrongUse, match="is not the agent that was scored"):
        explain(nobody, pool=strangers)


@pytest.fixture
def here(monkeypatch):
    """Plays submissions in this process, which is faster; what they do in one of their own is tested below."""
    for module in ("score", "explaining.explain"):
        monkeypatch.setattr(f"overcooked_bench.evaluation.{module}.runs_code", lambda _: False)


ACT = """import os; return (
            os._exit(3) if os.path.exists({0!r} + "/exit") else
            np.full(n, 9) if os.path.exists({0!r} + "/fault") else np.random.randint(0, 6, n)
        )"""
"""Acts at random, from the global generator, and does something else if a file appears that is not a part of it."""


@pytest.fixture
def two_runs(here, rules, strangers, tmp_path):
    """A submission of two training runs, and the folder of its score."""
    (tmp_path / "agent").mkdir()
    agent = write_agent(tmp_path / "agent" / "mine.py", act=ACT.format(str(tmp_path)), training_seeds=2)
    return agent, score(agent, rules, pool=strangers, output=tmp_path / "out").folder


def test_training_runs_share_the_moments_and_are_units(two_runs, strangers, tmp_path):
    agent, folder = two_runs
    explanation = explain(folder, agent=agent, pool=strangers, moments=6).explanation
    (layout,) = explanation.layouts
    assert Counter(moment.training_seed for moment in layout.moments) == {0: 3, 1: 3}
    assert set(layout.conventions) == {"0", "1"}
    assert "over training seeds where that is wider" in explanation.interval
    assert explain(folder, agent=agent, pool=strangers, moments=6).explanation == explanation
    (tmp_path / "fault").touch()
    with pytest.raises(SeatedFault, match="the scored agent, step 0: act returned the action 9"):
        explain(folder, agent=agent, pool=strangers, moments=6)


def test_a_submission_that_ends_its_process_ends_with_one_message(two_runs, strangers, tmp_path, monkeypatch):
    agent, folder = two_runs
    monkeypatch.setattr("overcooked_bench.evaluation.explaining.explain.runs_code", lambda _: True)
    (tmp_path / "exit").touch()
    with pytest.raises(AgentFault, match=f"mine on {LAYOUT}: .*process"):
        explain(folder, agent=agent, pool=strangers, moments=1)


def test_a_mirrored_kitchen_is_explained_through_the_mirror(strangers, tmp_path):
    mirrored = f"{LAYOUT}-mirrored"
    text = protocol_text(layouts=[mirrored], pool="null", horizon=250, episodes=2, object_probability=0.0)
    agent = HABITS.replace(LAYOUT, "{layout}")
    folder = score(agent, read_protocol(text, "p.yaml"), pool=strangers, output=tmp_path / "out").folder
    (layout,) = explain(folder, pool=strangers, moments=12).explanation.layouts
    assert (layout.layout, layout.axes, layout.conventions) == (mirrored, (), {})
    assert layout.shares.soups["agent"].value > 1
    (worst, *_) = layout.worst
    assert run_scenarios("greedy", folder / "moments" / worst.scenario, repeats=1).passed >= 1


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda it: it.update(schema=2), "schema"),
        (lambda it: it.update(more=1), "more"),
        (lambda it: it["layouts"][0]["worst"][0].update(moment=99), "cannot be shown .it is none of the moments"),
        (lambda it: it["layouts"][0]["worst"][0]["games"].pop("pair"), "has not all games"),
        (lambda it: it["layouts"][0]["worst"][0]["games"]["pair"].update(actions=["U", ""]), "one chef has 1 actions"),
        (lambda it: it["layouts"][0]["worst"][0].update(state={}), "cannot be shown"),
        (lambda it: it["layouts"][0].update(layout="nosuch"), "cannot be shown"),
        (lambda it: it["layouts"][0].update(layout="cramped_room"), "cannot be shown"),
        (lambda it: it["layouts"][0]["moments"][0]["soups"].update(pair=[]), "soups.pair"),
        (lambda it: it.update(reasons={}), "reasons explains"),
        (lambda it: it["total"]["reasons"].pop("clash"), "total"),
        (lambda it: it["total"]["soups"].pop("pair"), "total"),
        (lambda it: it["total"].update(fails=None), "total"),
        (lambda it: it["layouts"][0]["worst"][0]["games"]["pair"].update(actions=["U", "X"]), "actions"),
        (lambda it: it["layouts"][0]["moments"][0].update(reason="magic"), "reason"),
    ],
    ids=[
        *("schema", "key", "moment", "game", "uneven", "state", "no layout", "other layout", "no soups", "meanings"),
        *("shares", "soups", "no share", "actions", "reason"),
    ],
)
def test_a_damaged_file_is_refused(explained, tmp_path, change, said):
    content = json.loads(explained.explanation.to_json())
    change(content)
    (tmp_path / EXPLAIN_FILE).write_bytes(msgspec.json.encode(content))
    with pytest.raises(ExplanationError, match=f"{EXPLAIN_FILE}.*{said}"):
        read_explanation(tmp_path)


def test_the_two_policies_reach_soups_alone():
    """What makes the clash above one: each of the two policies knows its work."""
    from overcooked_bench.agents.catalogue import load_agent

    for name in ("sp-0", "sp-4"):
        pair = tuple(load_agent(f"dev-v1/{LAYOUT}/{name}", LAYOUT) for _ in range(2))
        assert play_episodes(LAYOUT, pair, episodes=20).soup_reward.mean() > 100


def test_an_isolated_submission_is_explained_in_the_same_words(rules, strangers, tmp_path):
    isolation_of("strong")
    agent = write_agent(tmp_path / "mine.py")
    folder = score(agent, rules, pool=strangers, output=tmp_path / "out", isolate="strict").folder
    apart = explain(folder, agent=agent, pool=strangers, moments=2, isolate="strict")
    assert apart.explanation == explain(folder, agent=agent, pool=strangers, moments=2).explanation

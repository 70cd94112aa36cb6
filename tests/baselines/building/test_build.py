import json
import multiprocessing
import shutil
import signal
import subprocess
import sys
import time
import types

import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import ScriptedReference
from overcooked_bench.baselines import self_play
from overcooked_bench.baselines.building import build, queue
from overcooked_bench.baselines.building.build import PoolBuildError, missing, publish, train_run
from overcooked_bench.baselines.building.command import main
from overcooked_bench.baselines.building.config import PoolConfigError, load_pool_config
from overcooked_bench.baselines.learning.people import people_behind
from overcooked_bench.baselines.running import monitor
from overcooked_bench.baselines.running.parts import checkpoints
from overcooked_bench.baselines.running.run import Snapshot
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.evaluation.pools import half
from overcooked_bench.processes import start_process
from tests.agents.made import record, write_policy
from tests.baselines.pools import OVERRIDES, THREE_AGENTS, group, pool_config, write_config
from tests.baselines.running.test_checkpoint import press_ctrl_c
from tests.baselines.tiny import MADE, UPDATE, tiny

LAYOUT = "cramped_room"


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """A pool of two runs, trained in this process: the folder that holds `runs` and `pool`."""
    home = tmp_path_factory.mktemp("built")
    for run in pool_config(home).runs():
        assert train_run(run, home / "runs" / run.path)
        publish(run, home / "runs" / run.path, home / "pool")
    return home


def test_a_human_proxy_gives_its_clone_and_its_last_policy(tmp_path):
    overrides = {**OVERRIDES, "games": str(MADE), "clone_epochs": 2, "lesson_batch": 8}
    proxies = {"method": "human-proxy", "overrides": overrides}
    config = pool_config(
        tmp_path,
        group("human", **proxies, keep=["final", "clone"]),
        group("cloned", **proxies | {"overrides": overrides | {"stage": "clone"}}, first=1),
    )
    for run in config.runs():
        assert train_run(run, tmp_path / "runs" / run.path)
        publish(run, tmp_path / "runs" / run.path, tmp_path / "pool")
    agents = {agent.name: agent for agent in Pool.load(tmp_path / "pool").agents(LAYOUT)}
    assert {name: round(agent.trained.done, 2) == 1 for name, agent in agents.items()} == {
        **{"cloned-0": True, "human-0": True, "human-0-clone": False}
    }
    assert {agent.stratum for agent in agents.values()} == {"human"}
    assert {agent.people for agent in agents.values()} == {tuple(f"2019-{pair:02d}" for pair in range(0, 17, 2))}
    final, clone = agents["human-0"].trained, agents["human-0-clone"].trained
    assert final.steps - clone.steps == 5 * UPDATE
    assert agents["human-0"].lineage == agents["human-0-clone"].lineage != agents["cloned-0"].lineage
    assert set(final.settings["drawn"]) | set(final.settings["held_out"]) == {f"2019-{k:02d}" for k in range(0, 12, 2)}
    assert missing(config, tmp_path / "pool") == []


def test_agents_are_written_with_all_that_is_known(built):
    pool = Pool.load(built / "pool")
    assert [agent.name for agent in pool.agents(LAYOUT)] == ["other-0", "sp-0", "sp-0-early", "sp-0-half"]
    entries = [pool.agent(LAYOUT, name) for name in ("sp-0", "sp-0-early", "sp-0-half")]
    assert [entry.stratum for entry in entries] == ["self-play", "untrained", "half-trained"]
    assert {entry.lineage for entry in entries} == {"tests of pools/cramped_room/sp-0"}
    final, early, half = (entry.trained for entry in entries)
    assert [agent.checkpoint for agent in (early, half, final)] == [0, 0.4, 1]
    assert [agent.steps for agent in (early, half, final)] == [0, 2 * UPDATE, 5 * UPDATE]
    assert (final.method, final.configuration, final.namespace) == ("self-play", "fast", "tests of pools")
    assert final.settings["epochs"] == OVERRIDES["epochs"]
    assert not {"layout", "seed", "method", "training_seed"} & final.settings.keys()
    assert final.self_play.episodes == 100
    assert 0 < final.profile.entropy < 1.8
    assert len({entry.sha256 for entry in pool.manifest.entries}) == 4
    assert missing(pool_config(built), built / "pool") == []


def test_scripted_partners_stand_beside_the_trained_ones(built, tmp_path):
    polite = {"name": "polite", "behaviour": {"does": "carry", "yields": True}}
    scripted = [{"name": "greedy"}, {"name": "idle", "agent": "stay", "role": "floor"}, polite]
    config = pool_config(tmp_path, scripted=scripted)
    for run in config.runs():
        publish(run, built / "runs" / run.path, tmp_path / "pool")
    found = {entry.name: entry for entry in Pool.load(tmp_path / "pool").partners(LAYOUT)}
    assert found["greedy"].reference == ScriptedReference(agent="greedy", version=1)
    assert (found["idle"].role, found["idle"].lineage) == ("floor", "scripted/stay")
    assert found["polite"].reference.behaviour == polite["behaviour"]
    assert len(found) == 7
    assert missing(config, tmp_path / "pool") == []
    with pytest.raises(PoolBuildError, match="holds other scripted partners"):
        missing(pool_config(tmp_path), tmp_path / "pool")
    for wrong, message in ((("gredy", None), "no scripted agent named 'gredy'"), (("x", {"does": "fly"}), "fly")):
        with pytest.raises(PoolConfigError, match=message):
            pool_config(tmp_path, scripted=[{"name": wrong[0], "behaviour": wrong[1]}])


def test_a_stopped_run_goes_on_to_the_same_agents(built, tmp_path, monkeypatch):
    run = pool_config(built).runs()[0]
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 2 * UPDATE // 4 + 8)
        assert not train_run(run, tmp_path / "run")
    assert not (tmp_path / "run" / "agents.json").exists()
    assert train_run(run, tmp_path / "run")
    publish(run, tmp_path / "run", tmp_path / "pool")
    ours, theirs = Pool.load(tmp_path / "pool"), Pool.load(built / "pool")
    assert list(ours.agents(LAYOUT)) == [agent for agent in theirs.agents(LAYOUT) if agent.name != "other-0"]


def test_a_finished_run_is_not_trained_again(built, monkeypatch):
    monkeypatch.setattr(build, "find_method", lambda _: pytest.fail("trained again"))
    run = pool_config(built).runs()[0]
    before = (built / "pool" / "manifest.json").read_bytes()
    assert train_run(run, built / "runs" / run.path)
    publish(run, built / "runs" / run.path, built / "pool")
    assert (built / "pool" / "manifest.json").read_bytes() == before


def test_half_is_what_reaches_half_of_the_end(built, monkeypatch):
    """The choice alone: the returns are made up, as are the policies' files."""
    reached = {"final": 200, "at-0.2": 40, "at-0.4": 90, "at-0.6": 120, "at-0.8": 190}
    monkeypatch.setattr(half, "load_policy", lambda file: file)
    found = lambda file, horizon: types.SimpleNamespace(self_play=types.SimpleNamespace(mean=reached[file]))  # noqa: E731
    monkeypatch.setattr(half, "measure", found)
    files = {name: types.SimpleNamespace(weights=name) for name in reached}
    snapshots = {float(name[3:]): Snapshot(file, 0) for name, file in files.items() if name != "final"}
    outcome = types.SimpleNamespace(files=files["final"], steps=5 * UPDATE, snapshots=snapshots)

    def kept(keep):
        shares = [0.2, 0.4, 0.6, 0.8]
        (run,) = pool_config(built, group(keep=keep, snapshots=shares)).runs()
        return {kind: file.weights for kind, (file, _, _) in build._keep(run, outcome).items()}

    assert kept(["final", "half", "early"]) == {"final": "final", "half": "at-0.4", "early": "at-0.2"}
    assert kept(["half"]) == {"half": "at-0.4"}
    reached["at-0.4"] = 20
    assert kept(["half"]) == {"half": "at-0.6"}
    assert checkpoints(outcome, tiny()).half() == 0.6, "fictitious co-play chooses the same one"
    reached["final"] = 0  # nothing learned: the least that there is beside `early`
    assert kept(["half", "early"]) == {"half": "at-0.4", "early": "at-0.2"}


@pytest.mark.parametrize(
    ("groups", "others", "message"),
    [
        ([group(**THREE_AGENTS), group("other", first=1)], {"name": "b"}, "holds the pool 'tiny', not 'b'"),
        ([group(**THREE_AGENTS)], {}, "does not name .cramped_room/other-0."),
        ([group(**THREE_AGENTS), group("other", first=2)], {}, "seed was"),
        (
            [group(**THREE_AGENTS), group("other", first=1, overrides={**OVERRIDES, "epochs": 9})],
            {},
            "epochs was 2, is 9",
        ),
        ([group(**THREE_AGENTS), group("other", first=1, overrides={**OVERRIDES, "steps": 999})], {}, "steps was 320"),
    ],
    ids=["name", "fewer", "seed", "setting", "steps"],
)
def test_another_configurations_pool_is_refused(built, tmp_path, groups, others, message):
    with pytest.raises(PoolBuildError, match=message):
        missing(pool_config(tmp_path, *groups, **others), built / "pool")


def test_what_a_pool_lacks_is_listed(built, tmp_path):
    config = pool_config(tmp_path, group(**{**THREE_AGENTS, "count": 2}), group("other", first=5))
    assert [run.path for run in missing(config, tmp_path / "none")] == [
        f"{LAYOUT}/{n}" for n in ("sp-0", "other-0", "sp-1")
    ]


def test_another_configurations_run_is_not_published(built, tmp_path):
    folder = built / "runs" / LAYOUT / "other-0"
    (run,) = pool_config(tmp_path, group("other", first=1, overrides={**OVERRIDES, "gamma": 0.5})).runs()
    with pytest.raises(PoolBuildError, match=r"gamma was 0\.99, is 0\.5"):
        publish(run, folder, tmp_path / "pool")
    (run,) = pool_config(tmp_path, group("another", first=1)).runs()
    with pytest.raises(PoolBuildError, match="kept other agents"):
        publish(run, folder, tmp_path / "pool")
    assert not (tmp_path / "pool").exists()


def test_the_command_publishes_what_is_there(built, tmp_path, capsys, monkeypatch):
    """Both runs are finished: one after the other is put into a new pool, without a process."""

    class Ended:
        sentinel, exitcode, pid = 0, 1, 1
        join = kill = lambda self: None

    monkeypatch.setattr(queue, "start_process", lambda *_, name: pytest.fail("trained again"))
    monkeypatch.setattr(queue, "wait", lambda sentinels, timeout: sentinels)
    where = {"runs": str(built / "runs"), "output": str(tmp_path / "pool")}
    config = str(write_config(tmp_path))
    assert main(config, **where, limit=1) == 0
    told = capsys.readouterr().out
    assert "cramped_room sp-0-half: 0 [0, 0] points with itself after 128 steps" in told
    assert told.endswith(f"{tmp_path / 'pool'}: 1 runs are missing\n")
    assert main(config, **where, groups=["other"], layouts=[LAYOUT]) == 0
    assert capsys.readouterr().out.endswith("complete (cramped_room, other)\n")
    assert (tmp_path / "pool" / "manifest.json").read_bytes() == (built / "pool" / "manifest.json").read_bytes()
    monkeypatch.setattr(queue, "start_process", lambda *_, name: Ended())
    new = {"runs": str(tmp_path / "runs"), "output": str(tmp_path / "new")}
    assert main(config, **new, limit=1) == 1
    assert "failed: cramped_room/sp-0" in capsys.readouterr().err
    Ended.exitcode = 130
    with pytest.raises(KeyboardInterrupt):
        main(config, **new)


def test_the_runs_of_another_salt_are_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(queue, "wait", lambda sentinels, timeout: sentinels)
    config = write_config(tmp_path, group())
    (run,) = load_pool_config(config, "one").runs()
    where = {"runs": str(tmp_path / "runs"), "output": str(tmp_path / "pool")}
    assert train_run(run, tmp_path / "runs" / run.path)
    assert main(str(config), **where, salt="one") == 0
    assert main(str(config), **where, salt="two") == 2
    told = capsys.readouterr()
    assert told.out.endswith("complete\n")
    assert (
        "in the namespace 'tests of pools/one', not of 'tiny' in 'tests of pools/two'; give the same --salt" in told.err
    )


def test_the_stratum_is_the_configurations_and_the_codebase_the_methods(built, tmp_path, monkeypatch):
    (run,) = pool_config(tmp_path, group("other", first=1, stratum="own")).runs()
    (entry,) = publish(run, built / "runs" / run.path, tmp_path / "pool")
    assert (entry.stratum, entry.trained.stratum, entry.trained.codebase) == ("own", "self-play", None)
    monkeypatch.setattr(self_play, "CODEBASE", "elsewhere", raising=False)
    shutil.copytree(built / "runs" / run.path, tmp_path / "run")
    (tmp_path / "run" / "agents.json").unlink()
    assert train_run(run, tmp_path / "run")
    (entry,) = publish(run, tmp_path / "run", tmp_path / "pool")
    assert entry.trained.codebase == "elsewhere"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nowhere"], "Shipped are "),
        (["dev-v1", "--layouts", "bottleneck"], "has no layout 'bottleneck'"),
        (["dev-v1", "--groups", "bc"], "has no group 'bc'; it has sp, biased, half"),
        (["dev-v1", "--workers", "0"], "give a whole number from 1"),
    ],
    ids=["config", "layout", "group", "workers"],
)
def test_mistakes_end_in_one_message(arguments, words, tmp_path, monkeypatch, capsys):
    from overcooked_bench.cli import main as program

    monkeypatch.chdir(tmp_path)
    try:
        code = program(["pool", "build", *arguments])
    except SystemExit as stop:  # argparse
        code = stop.code
    assert code == 2
    assert words in capsys.readouterr().err
    assert json.dumps([*tmp_path.iterdir()]) == "[]"


@pytest.mark.parametrize("algorithm", ["a2c", "dqn"])
def test_the_steps_of_a_snapshot_are_those_it_had(algorithm, tmp_path, monkeypatch):
    done, freeze = [], monitor.freeze
    note = lambda stem, model, settings: (done.append(model.num_timesteps), freeze(stem, model, settings))  # noqa: E731
    monkeypatch.setattr(monitor, "freeze", note)
    settings = {**OVERRIDES, "algorithm": algorithm, "steps": 6 * UPDATE, "rollout": 32}
    one = group(method="best-response", overrides=settings, keep=["final", "half"], snapshots=[0.55])
    (run,) = pool_config(tmp_path, one).runs()
    assert train_run(run, tmp_path / "run")
    half = next(r for r in publish(run, tmp_path / "run", tmp_path / "pool") if r.name.endswith("half"))
    assert [half.trained.steps] == done


def test_a_run_that_cannot_be_published_does_not_end_the_others(built, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(queue, "wait", lambda sentinels, timeout: sentinels)
    overrides = {**OVERRIDES, "gamma": 0.5}
    runs = pool_config(tmp_path, group(**{**THREE_AGENTS, "overrides": overrides}), group("other", first=1)).runs()
    result = queue.build(runs, built / "runs", tmp_path / "pool", 1)
    assert (result.failed, result.finished) == ([runs[0].path], [runs[1].path])
    assert "gamma was 0.99, is 0.5" in capsys.readouterr().out


def test_the_snapshot_of_a_population_is_one_of_the_longer_final_run(tmp_path):
    settings = {**OVERRIDES, "candidates": 1, "chosen": 1, "agents": 0, "per_episode": 1, "candidate_steps": 3 * UPDATE}
    settings |= {"steps": 4 * UPDATE, "development": "greedy"}
    one = group(method="population", overrides=settings, keep=["final", "half"], snapshots=[0.5])
    (run,) = pool_config(tmp_path, one).runs()
    assert train_run(run, tmp_path / "run")
    records = {record.name: record for record in publish(run, tmp_path / "run", tmp_path / "pool")}
    assert (records["sp-0-half"].trained.steps, records["sp-0-half"].trained.checkpoint) == (3 * UPDATE, 0.5)
    assert records["sp-0"].trained.steps == 6 * UPDATE


def test_a_population_enters_with_the_steps_of_its_agent(tmp_path):
    settings = {**OVERRIDES, "agents": 2, "rounds": 2, "pair_episodes": 1, "steps": 4 * UPDATE}
    (run,) = pool_config(tmp_path, group(method="pbt", overrides=settings)).runs()
    assert train_run(run, tmp_path / "run")
    (record,) = publish(run, tmp_path / "run", tmp_path / "pool")
    assert (record.trained.steps, record.trained.checkpoint) == (4 * UPDATE, 1)
    with pytest.raises(PoolConfigError, match="keeps the policies of every round"):
        pool_config(tmp_path, group(method="pbt", overrides=settings, keep=["half"], snapshots=[0.5]))


@pytest.mark.slow
def test_ctrl_c_while_a_run_still_loads_stops_it(tmp_path):
    (run,) = pool_config(tmp_path, group(overrides={**OVERRIDES, "steps": 10_000 * UPDATE})).runs()
    process = start_process(queue._work, build.train_run, run, tmp_path / "run", name="run")
    queue._stop([process], at_once=False)
    process.join(120)
    assert process.exitcode == 130


@pytest.mark.slow
def test_ctrl_c_while_the_queue_starts_a_run_reaches_the_run(tmp_path, monkeypatch):
    def start(*arguments, name):
        signal.raise_signal(signal.SIGINT)
        return start_process(*arguments, name=name)

    monkeypatch.setattr(queue, "start_process", start)
    runs = pool_config(tmp_path, group(count=2, overrides={**OVERRIDES, "steps": 10_000 * UPDATE})).runs()
    result = queue.build(runs, tmp_path / "runs", tmp_path / "pool", 1)
    assert result == queue.Result(stopped=True)
    assert multiprocessing.active_children() == []


@pytest.mark.slow
def test_processes_are_stopped_by_ctrl_c_and_go_on_to_the_same_pool(tmp_path):
    """The command as people run it: two processes, Ctrl-C while they train, and the same command again."""
    longer = {**OVERRIDES, "steps": 80 * UPDATE}
    groups = (
        group(overrides=longer, keep=["early", "final"], snapshots=[0.5]),
        group("other", first=1, overrides=longer),
    )
    program = [sys.executable, "-c", "import sys; from overcooked_bench.cli import main; sys.exit(main())"]
    command = [*program, "pool", "build", str(write_config(tmp_path, *groups)), "--workers", "2"]
    command += ["--runs", str(tmp_path / "runs"), "--output", str(tmp_path / "pool")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as queue:
        deadline = time.monotonic() + 200
        while not [*tmp_path.glob("runs/*/*/logs/*")] and time.monotonic() < deadline:
            time.sleep(0.02)
        queue.send_signal(signal.SIGINT)
        _, said = queue.communicate(timeout=300)
    assert queue.returncode == 130, said
    assert "Traceback" not in said
    assert len([*tmp_path.glob("runs/*/*/agents.json")]) < 2
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("complete\n")
    for run in pool_config(tmp_path, *groups).runs():
        assert train_run(run, tmp_path / "again" / run.path)
        publish(run, tmp_path / "again" / run.path, tmp_path / "whole")
    assert (tmp_path / "pool" / "manifest.json").read_bytes() == (tmp_path / "whole" / "manifest.json").read_bytes()


@pytest.mark.parametrize(
    "content", ["[]", "{", '{"seconds": 1, "agents": [1]}', '{"seconds": 1, "agents": [{"policy": "../../x"}]}', ""]
)
def test_a_damaged_list_of_agents_is_one_message(content, built, tmp_path, monkeypatch, capsys):
    run = pool_config(built).runs()[0]
    shutil.copytree(built / "runs" / run.path, tmp_path / "runs" / run.path)
    (tmp_path / "runs" / run.path / "agents.json").write_text(content)
    with pytest.raises(PoolBuildError, match=r"agents\.json.*remove the file"):
        publish(run, tmp_path / "runs" / run.path, tmp_path / "pool")


def test_an_agent_of_a_run_is_a_file_of_that_run(built, tmp_path):
    run = pool_config(built).runs()[0]
    shutil.copytree(built / "runs" / run.path, tmp_path / "run")
    file = tmp_path / "run" / "agents.json"
    file.write_text(file.read_text().replace('"policy": "policy"', '"policy": "../policy"'))
    with pytest.raises(PoolBuildError, match="is not in this folder"):
        publish(run, tmp_path / "run", tmp_path / "pool")


def test_who_trains_with_people_is_at_home_with_them(tmp_path):
    """Partners that were made from people: the agent that trained with them says so in its run and in its pool."""
    write_policy(tmp_path / "people" / LAYOUT / "clone-0")
    write_policy(tmp_path / "people" / LAYOUT / "clone-1", 1)
    clones = [record("clone-0", people=("2019-00", "2019-02")), record("clone-1", seed=1, people=("2019-02",))]
    write_manifest(tmp_path / "people", "people", clones)
    partners = ["greedy", str(tmp_path / "people")]
    config = pool_config(tmp_path, group(method="best-response", overrides={**OVERRIDES, "partners": partners}))
    (run,) = config.runs()
    assert train_run(run, tmp_path / "run")
    (entry,) = publish(run, tmp_path / "run", tmp_path / "pool")
    assert entry.people == ("2019-00", "2019-02")
    assert json.loads((tmp_path / "run" / "config.json").read_text())["people"] == ["2019-00", "2019-02"]
    assert "people" not in entry.trained.settings
    assert missing(config, tmp_path / "pool") == []
    one = ["stay", str(tmp_path / "people/cramped_room/clone-1"), str(tmp_path / "people/coordination_ring/clone-0")]
    assert people_behind(one, LAYOUT) == ("2019-02",)
    of_run = "run/policy.safetensors", "run/snapshots/0.5.safetensors", "run/clone/policy.json"
    for where in ("people/{layout}/clone-0", "pool/cramped_room/sp-0.json", *of_run):
        assert people_behind([str(tmp_path / where)], LAYOUT) == ("2019-00", "2019-02")
    assert people_behind(["greedy", "dev-v0", "dev-v0/cramped_room/sp-0", "my_agent.py"], LAYOUT) == ()

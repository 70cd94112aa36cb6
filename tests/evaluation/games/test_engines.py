"""Engines with real processes: some die, some hang, some are left behind by a parent that was killed."""

import os
import signal
import subprocess
import sys
import time

import dask
import pytest

from overcooked_bench.agents.pools.pool import PoolError
from overcooked_bench.agents.watch import calling
from overcooked_bench.evaluation.games import engines
from overcooked_bench.evaluation.games.apart import EngineError
from overcooked_bench.evaluation.games.engines import map_tasks, open_engine, refuse


def act(task):
    """Does what a task says, in whatever process it runs."""
    what, value = task
    if what == "exit":
        os._exit(value)
    if what == "kill":
        os.kill(os.getpid(), value)
    if what == "loop":
        with calling(f"act, step {value}"):
            while True:
                pass
    if what == "sleep":
        time.sleep(value)
    if what == "start":
        return subprocess.Popen(["sleep", "60"]).pid
    if what == "raise":
        raise PoolError(f"no pool named {value!r}")
    if what == "die in a call":
        with calling("reset"):
            os._exit(value)
    return "done", what, os.getpid()


def lost(task, why):
    return "lost", task[0], why


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    with open(f"/proc/{pid}/stat") as file:  # a process that nobody has waited for yet is dead all the same
        return file.read().rpartition(")")[2].split()[0] != "Z"


def gone(pids, within=20):
    give_up = time.monotonic() + within
    while any(alive(pid) for pid in pids):
        assert time.monotonic() < give_up, "a worker is left"
        time.sleep(0.05)
    return True


ENGINES = ["local", "dask", "ray"]


@pytest.mark.slow
@pytest.mark.parametrize("engine", ENGINES)
def test_a_task_costs_itself_alone_when_its_process_dies_or_hangs(engine):
    tasks = [
        ("exit", 0),
        ("loop", 12),
        ("kill", signal.SIGKILL),
        ("die in a call", 7),
        *[("work", i) for i in range(5)],
    ]
    with open_engine(engine, 2, apart=True) as opened:
        found = list(opened.map(act, tasks, lost, patience=1.0))
        with pytest.raises(PoolError, match="no pool named 'x'") as caught:
            list(opened.map(act, [("raise", "x")], lost))
        assert [how for how, *_ in opened.map(act, [("work", 0)], lost)] == ["done"]
    assert "in a worker process" in caught.value.__notes__[0]
    assert sorted(result[:2] for result in found) == sorted(
        ("lost" if what != "work" else "done", what) for what, _ in tasks
    )
    why = {what: told for how, what, told in found if how == "lost"}
    assert why["exit"] == "the worker process ended with exit code 0"
    assert why["loop"].startswith("act, step 12: no answer within 1 s; --act-timeout")
    assert "SIGKILL, perhaps for lack of memory" in why["kill"]
    assert why["die in a call"] == "reset: the worker process ended with exit code 7"


def test_one_worker_apart_is_another_process_and_stays_for_the_next_tasks():
    with open_engine("local", 1, apart=True) as engine:
        pids = {pid for _ in range(2) for _, _, pid in engine.map(act, [("work", 0)], refuse)}
        assert len(pids) == 1
        assert os.getpid() not in pids
    assert gone(pids)
    assert [pid for _, _, pid in map_tasks(act, [("work", 0)])] == [os.getpid()]


def test_without_another_answer_a_dead_process_is_an_engine_error():
    with pytest.raises(EngineError, match="exit code 3; finished work is kept"):
        list(map_tasks(act, [("exit", 3)], workers=2))


def test_what_a_task_started_ends_with_its_worker():
    with open_engine("local", 1, apart=True) as engine:
        (child,) = engine.map(act, [("start", 0)], refuse)
        assert alive(child)
    assert gone([child])


SCRIPT = """
import signal
import sys
from overcooked_bench.evaluation.games.engines import open_engine, refuse
from tests.evaluation.games.test_engines import act
signal.signal(signal.SIGINT, signal.default_int_handler)  # in the background it is ignored
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup it is ignored
print("the script runs", flush=True)
with open_engine("local", 2) as engine:
    tasks = [("work", 0), ("work", 1), (sys.argv[1], 1000), ("sleep", 1000)]
    for _, _, pid in engine.map(act, tasks, refuse):
        print(pid, flush=True)
"""


@pytest.mark.parametrize(("how", "last"), [("KILL", "loop"), ("TERM", "sleep"), ("INT", "loop"), ("HUP", "sleep")])
def test_workers_follow_their_parent(how, last, tmp_path):
    """A plain script without `if __name__ == "__main__"`, which no worker runs again."""
    (tmp_path / "script.py").write_text(SCRIPT)
    environment = {**os.environ, "PYTHONPATH": os.getcwd()}
    with subprocess.Popen(
        [sys.executable, tmp_path / "script.py", last],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=environment,
    ) as parent:
        assert parent.stdout.readline() == "the script runs\n"
        pids = [int(parent.stdout.readline()) for _ in range(2)]
        time.sleep(0.2)
        parent.send_signal(signal.Signals[f"SIG{how}"])
        assert parent.wait(20) != 0
        assert parent.stdout.read() == ""
        assert gone(pids)


LEFT = """
from overcooked_bench.evaluation.games import engines
from overcooked_bench.evaluation.games.engines import map_tasks
from tests.evaluation.games.test_engines import act
results = map_tasks(act, [("work", 0), ("sleep", 1000)], workers=2)
print(next(results)[2])
kept = results.gi_frame
raise ValueError("the user's own mistake")
"""


def test_an_iteration_that_is_left_standing_does_not_keep_the_program():
    done = subprocess.run([sys.executable, "-c", LEFT], capture_output=True, text=True, timeout=60)
    assert done.returncode == 1
    assert gone([int(done.stdout)])


def test_what_a_task_prints_is_no_result(capfd):
    with open_engine("local", 1, apart=True) as engine:
        assert len(list(engine.map(say, ["a line"], refuse))) == 1
    assert capfd.readouterr() == ("", "a line\nby its own file\n")


def say(line):
    print(line, flush=True)
    os.write(1, b"by its own file\n")


def kill_once(task):
    """Kills its own process the first time, or with "parent" the worker of a cluster that started it."""
    whom, marker = task
    if whom and not os.path.exists(marker):
        open(marker, "w").close()
        os.kill(os.getppid() if whom == "parent" else os.getpid(), signal.SIGKILL)
    return whom


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "whom"), [("local", "itself"), ("dask", "parent"), ("ray", "parent")])
def test_a_task_whose_worker_is_killed_is_done_again(engine, whom, tmp_path):
    tasks = [(whom, str(tmp_path / "killed")), *[("", "")] * 5]
    with open_engine(engine, 2) as opened:
        assert sorted(opened.map(kill_once, tasks, refuse)) == [*[""] * 5, whom]
    assert (tmp_path / "killed").exists()


@pytest.mark.slow
def test_a_cluster_that_does_not_answer_or_has_other_versions_is_one_line(monkeypatch):
    nowhere = {"scheduler-address": "tcp://127.0.0.1:9", "distributed.comm.timeouts.connect": "1s"}
    with dask.config.set(nowhere), pytest.raises(EngineError, match=r"no scheduler answers at tcp://127\.0"):
        list(map_tasks(act, [("work", 0)], engine="dask"))
    monkeypatch.setattr(engines, "versions", lambda: ("numpy 0.1",))
    with pytest.raises(EngineError, match=r"worker of the cluster has overcooked-bench .*has numpy 0\.1;"):
        list(map_tasks(act, [("work", 0)], engine="dask"))

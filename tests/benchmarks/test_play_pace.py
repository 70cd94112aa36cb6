"""Whether twenty people who play at once keep the pace of `overcooked-bench play`."""

import threading
import time

import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.human.server.house import Terms
from tests.human.server.serving import running

PEOPLE, STEPS, PACE, WINDOW, LEAST = 20, 100, 0.15, 0.02, 0.95

pytestmark = pytest.mark.benchmark


def test_twenty_games_at_once_keep_the_pace(benchmark, capsys):
    """Each plays with a trained agent; a step is on time if it is heard within 20 ms of its time.

    The time of a step is that of the game's first step and whole intervals after it.
    """
    heard: dict[int, list[float]] = {number: [] for number in range(PEOPLE)}

    def listen(server, number):
        with server.page() as page:
            page.send("consent", agree=False)
            page.send("begin", layout="cramped_room", seat=number % 2, partner=partner)
            while page.hear("frame", "end")["type"] == "frame":
                heard[number].append(time.perf_counter())
                page.send("press", action=number % 6)

    def play():
        with running(terms=Terms(("cramped_room",), PACE, STEPS, 0.0)) as server:
            threads = [threading.Thread(target=listen, args=(server, number)) for number in range(PEOPLE)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()

    partner = f"dev-v1/cramped_room/{Pool.load('dev-v1').agents('cramped_room')[0].name}"
    benchmark.pedantic(play, rounds=1)
    late = [abs(at - (times[0] + PACE * step)) for times in heard.values() for step, at in enumerate(times) if step]
    share = sum(each <= WINDOW for each in late) / len(late)
    benchmark.extra_info["share within 20 ms"] = share
    with capsys.disabled():
        print(
            f"\n{PEOPLE} games at once: {share:.1%} of {len(late)} steps within 20 ms; worst {1000 * max(late):.0f} ms"
        )
    assert share >= LEAST
    assert all(len(times) == STEPS for times in heard.values())

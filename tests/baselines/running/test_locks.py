from threading import Event, Thread

from overcooked_bench.baselines.running import locks
from overcooked_bench.baselines.running.locks import alone, locked


def test_one_process_at_a_time(tmp_path):
    with locked(tmp_path / "run", wait=False) as ours:
        assert ours
        with locked(tmp_path / "run", wait=False) as theirs:
            assert not theirs
    with locked(tmp_path / "run", wait=False) as again:
        assert again


def test_who_comes_second_says_so_and_waits(tmp_path, monkeypatch):
    order, waits = [], Event()
    monkeypatch.setattr(locks, "print", lambda *words, **_: (order.append(words[0]), waits.set()), raising=False)

    def second():
        with alone(tmp_path):
            order.append("second")

    thread = Thread(target=second)
    with alone(tmp_path):
        thread.start()
        assert waits.wait(60)
        order.append("first")
    thread.join(60)
    assert order == [f"{tmp_path}: another process trains there; waiting for it to end", "first", "second"]

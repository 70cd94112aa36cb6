"""The progress bar of commands on a terminal."""

from functools import partial
from io import StringIO
from types import SimpleNamespace

import rich.console

from overcooked_bench.commands import common


def test_it_says_what_is_done_how_fast_and_what_is_left(monkeypatch):
    shown, clock = StringIO(), iter((0, 2))
    terminal = partial(rich.console.Console, file=shown, force_terminal=True, width=120)
    monkeypatch.setattr(rich.console, "Console", lambda stderr: terminal())
    monkeypatch.setattr(common, "time", SimpleNamespace(monotonic=lambda: next(clock)))
    with common.ProgressBar("loading") as tell:
        tell("blocks, cramped_room", 1, 8, 30)
        tell("blocks, cramped_room", 3, 8, 90)
    for words in ("blocks, cramped_room", "3/8", " 30 episodes/s", "left"):
        assert words in shown.getvalue()


def test_it_is_not_shown_in_a_file(capsys):
    with common.ProgressBar("loading") as tell:
        tell("games", 1, 2)
    assert capsys.readouterr() == ("", "")

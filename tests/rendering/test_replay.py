import io

import numpy as np
import pytest
from PIL import Image

from overcooked_bench import Kitchens, Layout
from overcooked_bench.rendering.gif import write_gif
from overcooked_bench.rendering.picture import draw
from overcooked_bench.rendering.replay import frames_of, play_in_terminal, save_gif, save_poster_gif, thinned
from tests.rendering.scenes import played, some_state

CRAMPED = Layout.load("cramped_room")


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("cooking", ["auto", "manual"])
def test_joint_actions_reproduce_states_and_points(cooking):
    start, actions, points = played("cramped_room", 60, cooking)
    frames = list(frames_of("cramped_room", start.to_dict(), actions, cooking, 400))
    assert len(frames) == 61
    assert frames[0] == (start, 0)
    assert points >= 20
    assert frames[-1][1] == points
    kitchens = Kitchens("cramped_room", 1, cooking=cooking)
    kitchens.set_state(0, start)
    for row, (state, _) in zip(actions, frames[1:], strict=True):
        kitchens.step(row[None])
        assert kitchens.state(0) == state


def test_a_whole_episode_ends_at_the_horizon():
    start, actions, _ = played("cramped_room", 30)
    assert [state.timestep for state, _ in frames_of(CRAMPED, start, actions, horizon=30)] == list(range(31))


def test_actions_that_cannot_be_are_refused():
    start, actions, _ = played("cramped_room", 30)
    with pytest.raises(ValueError, match="30 joint actions from step 0 go beyond the horizon of 20"):
        list(frames_of(CRAMPED, start, actions, horizon=20))
    with pytest.raises(ValueError, match=r"the shape \(60,\); give \(T, 2\)"):
        list(frames_of(CRAMPED, start, actions.ravel()))
    with pytest.raises(ValueError, match="chef 0: action 14"):
        list(frames_of(CRAMPED, start, actions + 9))


@pytest.mark.parametrize(
    ("count", "every", "kept"), [(7, 1, range(7)), (7, 3, (0, 3, 6)), (8, 3, (0, 3, 6, 7)), (1, 5, (0,))]
)
def test_thinning_keeps_the_first_and_the_last(count, every, kept):
    assert list(thinned(range(count), every)) == list(kept)


def test_a_gif_has_every_frame_and_looks_like_the_pictures(tmp_path):
    start, actions, _ = played("cramped_room", 12)
    frames = list(frames_of(CRAMPED, start, actions))
    path = save_gif(tmp_path / "episode.gif", CRAMPED, frames, tile_size=32, fps=10)
    with Image.open(path) as film:
        assert film.n_frames == 13
        assert film.info["loop"] == 0
        for k, (state, points) in enumerate(frames):
            film.seek(k)
            shown = np.asarray(film.convert("RGB")).astype(int)
            wanted = draw(CRAMPED, state, tile_size=32, caption=f"step {k}   {points:g} points")
            assert np.abs(shown - wanted).max() < 40
            assert np.abs(shown - wanted).mean() < 1.5
            assert film.info["duration"] == (100 if k < 12 else 2000)


def test_a_gif_of_each_fourth_frame(tmp_path):
    start, actions, _ = played("cramped_room", 10)
    path = save_gif(tmp_path / "episode.gif", CRAMPED, frames_of(CRAMPED, start, actions), every=4, names=("a", "b"))
    with Image.open(path) as film:
        assert film.n_frames == 4


def test_a_gif_keeps_frames_without_change(tmp_path):
    picture = draw(CRAMPED, some_state(CRAMPED), tile_size=16)
    path = write_gif(tmp_path / "still.gif", [picture] * 5, 10)
    with Image.open(path) as film:
        assert film.n_frames == 5
        film.seek(4)
        assert np.array_equal(np.asarray(film.convert("RGB")), _as_shown(picture, tmp_path))


def _as_shown(picture, folder):
    with Image.open(write_gif(folder / "one.gif", [picture], 10)) as film:
        return np.asarray(film.convert("RGB"))


def test_a_whole_episode_makes_a_small_gif(tmp_path):
    start, actions, _ = played("counter_circuit", 400)
    layout = Layout.load("counter_circuit")
    path = save_gif(tmp_path / "episode.gif", layout, frames_of(layout, start, actions), tile_size=32)
    assert path.stat().st_size < 1_000_000
    with Image.open(path) as film:
        assert film.n_frames == 401


def test_several_kitchens_in_one_gif(tmp_path):
    names = ["cramped_room", "forced_coordination"]
    episodes = [(Layout.load(name), played(name, length)) for name, length in zip(names, (9, 12), strict=True)]
    kitchens = [(layout, frames_of(layout, start, actions)) for layout, (start, actions, _) in episodes]
    with Image.open(save_poster_gif(tmp_path / "both.gif", kitchens, tile_size=16)) as film:
        assert film.n_frames == 10


def test_a_terminal_is_redrawn_in_place():
    start, actions, points = played("cramped_room", 3)
    out = Terminal()
    assert play_in_terminal(CRAMPED, frames_of(CRAMPED, start, actions), fps=50, names=("x", "y"), out=out) == points
    text = out.getvalue()
    assert text.count("\x1b[J") == 3
    assert text.count("seat 0: x   seat 1: y") == 4


def test_elsewhere_the_first_and_the_last_frame_are_printed():
    start, actions, points = played("cramped_room", 3)
    out = io.StringIO()
    assert play_in_terminal(CRAMPED, frames_of(CRAMPED, start, actions), fps=0.01, out=out) == points
    text = out.getvalue()
    assert text.isascii()
    assert [line.split()[1] for line in text.splitlines() if line.startswith("step")] == ["0", "3"]


def test_a_small_terminal_is_none(monkeypatch):
    monkeypatch.setenv("COLUMNS", "10")
    start, actions, _ = played("cramped_room", 3)
    out = Terminal()
    play_in_terminal(CRAMPED, frames_of(CRAMPED, start, actions), fps=0.01, out=out)
    assert "\x1b" not in out.getvalue()


def test_nothing_to_show_is_told(tmp_path):
    with pytest.raises(ValueError, match="at least one frame"):
        save_gif(tmp_path / "no.gif", CRAMPED, [])
    assert not (tmp_path / "no.gif").exists()
    with pytest.raises(ValueError, match="no frames"):
        play_in_terminal(CRAMPED, [], out=io.StringIO())
    with pytest.raises(ValueError, match="every=0"):
        save_gif(tmp_path / "no.gif", CRAMPED, [], every=0)
    with pytest.raises(ValueError, match="fps=0"):
        play_in_terminal(CRAMPED, [], fps=0)

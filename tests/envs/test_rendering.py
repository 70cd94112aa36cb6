import re
import warnings

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordVideo

NAME = "Overcooked/CrampedRoom-v0"


@pytest.mark.parametrize("render_mode", ["rgb_array", "ansi"])
def test_gymnasium_finds_no_fault_in_the_frames(render_mode):
    check_env(gym.make(NAME, render_mode=render_mode).unwrapped)


def test_a_picture_changes_with_the_kitchen():
    env = gym.make(NAME, render_mode="rgb_array", seat=0)
    env.reset(seed=0)
    first = env.render()
    env.step(1)
    second = env.render()
    assert first.dtype == np.uint8
    assert first.ndim == 3
    assert first.shape[2] == 3
    assert first.shape == second.shape
    assert not np.array_equal(first, second)


def test_text_has_a_line_for_each_row():
    env = gym.make(NAME, render_mode="ansi")
    env.reset(seed=0)
    plain = re.sub(r"\x1b\[[0-9;]*m", "", env.render())
    assert plain.splitlines()[0] == "######[_]######"
    assert "\x1b" not in plain


def test_without_a_mode_nothing_is_drawn():
    env = gym.make(NAME).unwrapped
    env.reset()
    assert env.render() is None
    assert gym.make_vec(NAME, 2).render() is None


def test_a_list_of_frames():
    env = gym.make(NAME, render_mode="rgb_array_list")
    env.reset(seed=0)
    env.step(4)
    assert len(env.render()) == 2


def test_a_batch_draws_every_kitchen():
    envs = gym.make_vec(NAME, 3, render_mode="rgb_array")
    envs.reset(seed=0)
    frames = envs.render()
    assert len(frames) == 3
    assert all(frame.shape == frames[0].shape for frame in frames)
    texts = gym.make_vec(NAME, 2, render_mode="ansi")
    texts.reset(seed=0)
    assert [type(text) for text in texts.render()] == [str, str]


def test_a_video_is_recorded(tmp_path):
    pytest.importorskip("moviepy")
    env = RecordVideo(gym.make(NAME, render_mode="rgb_array", horizon=3), str(tmp_path / "video"), disable_logger=True)
    env.reset(seed=0)
    for _ in range(3):
        env.step(1)
    env.close()
    assert [path.suffix for path in (tmp_path / "video").iterdir() if path.stat().st_size > 500] == [".mp4"]


def test_human_frames_are_shown_by_gymnasiums_wrapper(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*trying to use 'human' rendering.*")
        env = gym.make(NAME, render_mode="human")
    env.reset(seed=0)
    env.step(4)
    assert pygame.display.get_surface().get_size() == (240, 192)
    env.close()

"""What the README shows runs as it stands there."""

import re
from pathlib import Path

import pytest

from overcooked_bench import play_episodes
from overcooked_bench.agents import UnknownLayout
from overcooked_bench.agents.submission import load_submission

README = (Path(__file__).parents[1] / "README.md").read_text("utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
SUBMISSIONS = [block for block in BLOCKS if "def make_agent" in block]
SCRIPTS = [block for block in BLOCKS if "def make_agent" not in block]


def submission(text, tmp_path):
    (tmp_path / "agent.py").write_text(text)
    return load_submission(tmp_path / "agent.py")


@pytest.mark.parametrize("text", SUBMISSIONS[:2], ids=["a_batch", "one_game_at_a_time"])
def test_a_submission_plays(text, tmp_path):
    shown = submission(text, tmp_path)
    assert shown.training_seeds == 1
    pair = (shown.make_agent("cramped_room", 0), shown.make_agent("cramped_room", 0))
    assert play_episodes("cramped_room", agents=pair, episodes=3, horizon=20).soup_reward.shape == (3,)


def test_the_network_plays_what_it_has_weights_for(tmp_path):
    import torch
    from safetensors.torch import save_file

    body = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(440, 8), torch.nn.ReLU(), torch.nn.Linear(8, 6))
    save_file(body.state_dict(), tmp_path / "cramped_room-4.safetensors")
    shown = submission(SUBMISSIONS[2], tmp_path)
    assert shown.training_seeds == 5
    pair = (shown.make_agent("cramped_room", 4), shown.make_agent("cramped_room", 4))
    assert play_episodes("cramped_room", agents=pair, episodes=3, horizon=20).soup_reward.shape == (3,)
    with pytest.raises(UnknownLayout, match="no weights for coordination_ring"):
        shown.make_agent("coordination_ring", 0)


@pytest.mark.parametrize("text", SCRIPTS, ids=["environments", "kitchens"])
def test_a_script_runs(text):
    names: dict[str, object] = {}
    exec(compile(text, "README.md", "exec"), names)
    for name in ("env", "many", "own"):
        if name in names:
            observation, _ = names[name].reset(seed=0)
            assert observation in names[name].observation_space
            names[name].step(names[name].action_space.sample())
            names[name].close()
    assert "env" in names or names["views"].shape == (4096, 2, 26, 4, 5)

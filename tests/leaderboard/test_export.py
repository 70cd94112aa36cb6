"""Models of stable-baselines3 become submissions that act as the models do, and nothing of them is unpickled."""

import base64
import json
import pickle
import zipfile

import gymnasium as gym
import numpy as np
import pytest
import torch
from stable_baselines3 import A2C, DQN, PPO
from stable_baselines3.common.torch_layers import FlattenExtractor
from stable_baselines3.common.vec_env import VecFrameStack, VecMonitor, VecNormalize

from overcooked_bench import UnknownLayout
from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.agents.submissions.loading import load_submission
from overcooked_bench.baselines.learning.stock import Convolutions
from overcooked_bench.cli import main
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.envs.sb3_gymnasium import GymnasiumVecEnv
from overcooked_bench.leaderboard.export.convert import _OURS, CONVERTED
from overcooked_bench.leaderboard.export.folder import export
from overcooked_bench.leaderboard.export.sb3_file import ExportError
from overcooked_bench.leaderboard.submission.check import check_submission
from tests.agents.made import write_policy

LARGE = "\n".join(["XXPXX" + "X" * 31, *["O" + " " * 34 + "O"] * 33, "X1 2" + " " * 31 + "X", "XDXS" + "X" * 32])
SHORT = {"n_steps": 32, "batch_size": 32, "n_epochs": 1}
CARROLL = {"features_extractor_class": Convolutions, "net_arch": []}


def vector(layout="CrampedRoom", num_envs=4, **settings):
    return VecMonitor(GymnasiumVecEnv(gym.make_vec(f"Overcooked/{layout}-v0", num_envs=num_envs, **settings)))


def own(layout="cramped_room", num_envs=4, **settings):
    return OvercookedVecEnv(layout, num_envs, **settings)


MODELS = {
    "PPO, MlpPolicy, make_vec": lambda: (PPO("MlpPolicy", vector(), **SHORT), "cramped_room"),
    "PPO, layers of its own": lambda: (
        PPO("MlpPolicy", own(), **SHORT, policy_kwargs={"net_arch": {"pi": [9, 8, 7], "vf": [5]}}),
        "cramped_room",
    ),
    "A2C, ReLU, features": lambda: (
        A2C("MlpPolicy", vector(observation="features"), policy_kwargs={"activation_fn": torch.nn.ReLU}),
        "cramped_room",
    ),
    "PPO, stacked states": lambda: (
        PPO("MlpPolicy", own("counter_circuit", observation="stack_states"), **SHORT),
        "counter_circuit",
    ),
    "PPO, convolutions of Carroll et al.": lambda: (
        PPO(
            "CnnPolicy",
            own("forced_coordination"),
            **SHORT,
            policy_kwargs={**CARROLL, "features_extractor_kwargs": {"filters": 4, "hidden": (8, 7)}},
        ),
        "forced_coordination",
    ),
    "PPO, CnnPolicy": lambda: (
        PPO(
            "CnnPolicy",
            own(LARGE, 2, horizon=40),
            **SHORT,
            policy_kwargs={
                "normalize_images": False,
                "features_extractor_kwargs": {"features_dim": 16, "normalized_image": True},
                "net_arch": {"pi": [6], "vf": []},
            },
        ),
        LARGE,
    ),
    "DQN": lambda: (DQN("MlpPolicy", vector(num_envs=1), learning_starts=20, buffer_size=500), "cramped_room"),
}


def chances_of(model, seen):
    """The distribution that the model's actions are drawn from; for DQN all on its best action."""
    with torch.no_grad():
        tensor, _ = model.policy.obs_to_tensor(seen)
        if isinstance(model, DQN):
            return torch.nn.functional.one_hot(model.q_net(tensor).argmax(1), 6).double().numpy()
        return model.policy.get_distribution(tensor).distribution.probs.double().numpy()


def sharpen(policy, seen):
    """Scales the last layer, as after so few steps all actions are nearly as likely."""
    with torch.no_grad():
        logits = policy.get_distribution(policy.obs_to_tensor(seen)[0]).distribution.logits
        scale = (1 / logits.std(0).max()).clamp(max=20)  # more would show the rounding of float32
        policy.action_net.weight.mul_(scale)
        policy.action_net.bias.sub_(logits.mean(0)).mul_(scale)


def exported(model, folder, layout, **settings):
    model.save(folder / "model.zip")
    return export(folder / "model.zip", folder / "mine", layout, **settings)


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_an_exported_model_acts_as_it_did(name, tmp_path, monkeypatch):
    torch.manual_seed(0)
    model, layout = MODELS[name]()
    model.learn(300)
    rng = np.random.default_rng(0)
    space = model.observation_space
    seen = rng.integers(0, 3, (200, *space.shape)).astype(space.dtype)
    if not isinstance(model, DQN):
        sharpen(model.policy, seen)
    monkeypatch.setattr(pickle, "loads", None)
    written = exported(model, tmp_path, layout)
    monkeypatch.undo()
    submission = load_submission(tmp_path / "mine")
    agent = submission.make_agent(layout, 0)
    agent.reset(layout, np.zeros(200, np.int64), np.arange(200, dtype=np.uint64))
    actions = agent.act(seen)
    chances = chances_of(model, seen)
    assert np.ptp(chances, axis=0).max() > 0.005, "the policy depends on what it sees"
    if isinstance(model, DQN):
        np.testing.assert_array_equal(actions, model.predict(seen, deterministic=True)[0])
    else:
        own_chances = PolicyStack([load_policy(written)]).assign(np.zeros(200, int)).probabilities(seen)
        np.testing.assert_allclose(own_chances, chances, atol=1e-6)
        np.testing.assert_array_equal(own_chances.argmax(1), model.predict(seen, deterministic=True)[0])
        drawn = chances[np.arange(200), actions].mean()
        expected = (chances**2).sum(1).mean()
        assert abs(drawn - expected) < 0.1, "actions are drawn from the distribution"
    problems = [problem.partition(";")[0] for problem in check_submission(tmp_path / "mine").problems]
    assert [problem.partition(": ")[2].partition(" ")[0] for problem in problems] == [
        *("`contact`", "`licence`", "`method`", "`joint_steps`", "`pledge`")
    ]
    (counted,) = [line for line in (tmp_path / "mine" / "submission.yaml").read_text().splitlines() if "counts" in line]
    assert f"# this model counts {model.num_timesteps:,}; environment steps" in counted
    assert counted.count("#") == 1


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """An untrained model."""
    file = tmp_path_factory.mktemp("saved") / "model.zip"
    PPO("MlpPolicy", own(), **SHORT).save(file)
    return file


def changed(saved, folder, name="data", change=None, data=None):
    """A copy of a model with one of its files changed; `change` changes its JSON."""
    with zipfile.ZipFile(saved) as old, zipfile.ZipFile(folder / "changed.zip", "w") as new:
        for other in old.namelist():
            content = old.read(other)
            if other == name and change is not None:
                told = json.loads(content)
                change(told)
                content = json.dumps(told).encode()
            new.writestr(other, data if other == name and data is not None else content)
    return folder / "changed.zip"


class Evil:
    def __reduce__(self):
        return print, ("a pickle was executed",)


def test_pickles_in_a_model_are_not_executed(saved, tmp_path, capsys):
    def poison(told):
        for entry in told.values():
            if isinstance(entry, dict) and ":serialized:" in entry:
                entry[":serialized:"] = base64.b64encode(pickle.dumps(Evil())).decode()

    export(changed(saved, tmp_path, change=poison), tmp_path / "mine", "cramped_room")
    torch.save({"action_net.weight": Evil()}, tmp_path / "evil.pth")
    evil = changed(saved, tmp_path, "policy.pth", data=(tmp_path / "evil.pth").read_bytes())
    with pytest.raises(ExportError, match="does not hold plain weights"):
        export(evil, tmp_path / "other", "cramped_room")
    with pytest.raises(ExportError, match="does not hold plain weights"):
        export(changed(saved, tmp_path, "policy.pth", data=pickle.dumps(Evil(), 2)), tmp_path / "other", "cramped_room")
    assert "executed" not in "".join(capsys.readouterr())
    assert not (tmp_path / "other").exists()


def test_layouts_and_seeds_are_added_one_by_one(saved, tmp_path):
    folder = tmp_path / "mine"
    PPO("MlpPolicy", own("coordination_ring"), **SHORT).save(tmp_path / "ring.zip")
    for seed in (0, 2, 1):
        export(saved, folder, "cramped_room", training_seed=seed)
    export(tmp_path / "ring.zip", folder, "coordination_ring")
    submission = load_submission(folder)
    assert (submission.training_seeds, submission.origin.codebase) == (3, "stable-baselines3")
    assert submission.make_agent("coordination_ring", 0).observation == "lossless"
    for layout, seed in (("coordination_ring", 1), ("forced_coordination", 0), (LARGE, 0)):
        with pytest.raises(UnknownLayout, match="no policy for"):
            submission.make_agent(layout, seed)
    assert "\ntraining_seeds: 3 " in (folder / "submission.yaml").read_text()
    with pytest.raises(ExportError, match="exists already; name another --training-seed"):
        export(saved, folder, "cramped_room", training_seed=1)
    DQN("MlpPolicy", own(), buffer_size=100).save(tmp_path / "dqn.zip")
    with pytest.raises(ExportError, match='says MODE = "sample", and this model plays "greedy"'):
        export(tmp_path / "dqn.zip", folder, "cramped_room", training_seed=3)
    (folder / "agent.py").write_text("x = 1\n")
    with pytest.raises(ExportError, match=r"agent\.py is not one that export writes"):
        export(saved, folder, "cramped_room", training_seed=3)


def test_our_own_policies_are_exported_as_they_are(tmp_path):
    files = write_policy(tmp_path / "policy", layout="cramped_room")
    export(files.weights, tmp_path / "mine", "cramped_room")
    submission = load_submission(tmp_path / "mine")
    assert submission.make_agent("cramped_room", 0).observation == "lossless"
    assert submission.origin.codebase is None
    with pytest.raises(ExportError, match="trained on 'cramped_room'"):
        export(files.weights, tmp_path / "other", "coordination_ring")


class Custom(FlattenExtractor):
    """An extractor whose code is not in the file."""


REFUSED = {
    "frame stack": (lambda: PPO("MlpPolicy", VecFrameStack(own(), 4, "first"), **SHORT), "VecFrameStack"),
    "normalised": (
        lambda: PPO("MlpPolicy", VecNormalize(own(observation="features")), **SHORT).learn(128),
        "in a VecNormalize",
    ),
    "extractor": (
        lambda: PPO("MlpPolicy", own(), **SHORT, policy_kwargs={"features_extractor_class": Custom}),
        "its features extractor is ",
    ),
    "activation": (
        lambda: PPO("MlpPolicy", own(), **SHORT, policy_kwargs={"activation_fn": torch.nn.ELU}),
        "its activation function is torch.nn.modules.activation.ELU",
    ),
    "linear": (lambda: PPO("MlpPolicy", own(), **SHORT, policy_kwargs={"net_arch": []}), "no hidden layer"),
    "another head": (
        lambda: PPO(
            "MlpPolicy",
            own(),
            **SHORT,
            policy_kwargs={
                **CARROLL,
                "features_extractor_kwargs": {"filters": 2, "hidden": (4,)},
                "net_arch": [4],
            },
        ),
        "the last with net_arch=[]",
    ),
    "two observations": (
        lambda: PPO("MlpPolicy", own(observation="lossless26"), **SHORT),
        "--observation jaxmarl or lossless26",
    ),
    "another layout": (lambda: PPO("MlpPolicy", own("coordination_ring"), **SHORT), "on this --layout there are"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_converted_is_said(name, tmp_path):
    make, words = REFUSED[name]
    with pytest.raises(ExportError) as refusal:
        exported(make(), tmp_path, "cramped_room")
    assert words in str(refusal.value)
    assert not (tmp_path / "mine").exists()


def test_rewards_may_have_been_normalised(tmp_path):
    model = PPO("MlpPolicy", VecNormalize(own(), norm_obs=False), **SHORT).learn(128)
    assert exported(model, tmp_path, "cramped_room", raw_observations=True).is_file()


def test_policies_of_sb3_contrib_with_memory_are_refused(tmp_path):
    contrib = pytest.importorskip("sb3_contrib")
    model = contrib.RecurrentPPO("MlpLstmPolicy", own(), **SHORT)
    with pytest.raises(ExportError, match="it has memory"):
        exported(model, tmp_path, "cramped_room")


SAID = {
    "several inputs": (lambda told: told["observation_space"].update({":type:": "<class 'x.Dict'>"}), "several inputs"),
    "a class of somebody": (
        lambda told: told["policy_class"].update({"__module__": "__main__"}),
        "its policy is a class of __main__, whose code is not in the file",
    ),
    "no class": (lambda told: told.pop("policy_class"), "a class of an unknown module"),
    "no settings": (lambda told: told.pop("policy_kwargs"), "add --activation relu or tanh"),
    "nothing": (lambda told: told.clear(), "a class of an unknown module"),
}


@pytest.mark.parametrize("name", SAID)
def test_what_a_file_does_not_say_is_asked_for(name, saved, tmp_path):
    change, words = SAID[name]
    with pytest.raises(ExportError) as refusal:
        export(changed(saved, tmp_path, change=change), tmp_path / "mine", "cramped_room")
    assert words in str(refusal.value)


def test_flags_say_what_the_file_does_not(saved, tmp_path):
    file = changed(saved, tmp_path, change=lambda told: told.pop("policy_kwargs"))
    written = export(file, tmp_path / "mine", "cramped_room", activation="tanh")
    assert load_policy(written).architecture.activation == "tanh"
    with pytest.raises(ExportError, match="the model says tanh; leave the flag out"):
        export(saved, tmp_path / "mine", "cramped_room", training_seed=1, activation="relu")
    PPO("MlpPolicy", own(observation="lossless26"), **SHORT).save(tmp_path / "26.zip")
    written = export(tmp_path / "26.zip", tmp_path / "other", "cramped_room", observation="lossless26")
    assert load_policy(written).architecture.observation == "lossless26"


@pytest.mark.parametrize("data", [b"", b"[]", b"{", b'{"observation_space": 3, "policy_class": [], "x": 1}'])
def test_files_that_are_no_models_are_refused(data, saved, tmp_path):
    with pytest.raises(ExportError):
        export(changed(saved, tmp_path, data=data), tmp_path / "mine", "cramped_room")
    (tmp_path / "text.zip").write_bytes(data)
    for file in ("text.zip", "nowhere.zip"):
        with pytest.raises(ExportError, match=r"not a model of stable-baselines3|no such file"):
            export(tmp_path / file, tmp_path / "mine", "cramped_room")


def test_the_command_exports_and_reports_wrong_use(saved, tmp_path, capsys):
    arguments = ["export", str(saved), str(tmp_path / "mine")]
    assert main([*arguments, "--layout", "cramped_room", "--training-seed", "1"]) == 0
    assert "cramped_room-1.safetensors: written" in capsys.readouterr().out
    assert main([*arguments, "--layout", "cramped_rom"]) == 2
    assert "did you mean 'cramped_room'" in capsys.readouterr().err


def test_our_extractor_has_the_name_that_the_message_says():
    assert f"{Convolutions.__module__}.{Convolutions.__qualname__}" == _OURS
    assert _OURS in CONVERTED


def test_a_vector_environment_gives_stable_baselines3_what_gymnasium_gives():
    env = GymnasiumVecEnv(gym.make_vec("Overcooked/CrampedRoom-v0", num_envs=3, horizon=5, partner="greedy"))
    plain = gym.make_vec("Overcooked/CrampedRoom-v0", num_envs=3, horizon=5, partner="greedy")
    env.seed(7)
    expected, _ = plain.reset(seed=7)
    np.testing.assert_array_equal(env.reset(), expected)
    for step in range(12):
        actions = np.full(3, step % 6)
        seen, rewards, dones, infos = env.step(actions)
        expected, paid, _, over, told = plain.step(actions)
        np.testing.assert_array_equal(seen, expected)
        np.testing.assert_array_equal(rewards, paid)
        np.testing.assert_array_equal(dones, over)
        for i in np.flatnonzero(over):
            np.testing.assert_array_equal(infos[i]["terminal_observation"], told["final_obs"][i])
            assert infos[i]["TimeLimit.truncated"]
    assert env.get_attr("num_envs") == [3, 3, 3]
    with pytest.raises(ValueError, match="rows share one environment"):
        env.env_method("render", indices=[0])
    with pytest.raises(ValueError, match="resets rows in a step of their own"):
        GymnasiumVecEnv(gym.make_vec("CartPole-v1", num_envs=2))

"""Checkpoints of a run from which it resumes exactly.

One file of tensors and plain values, written whole or not at all and read with `weights_only=True`. SB3's own save and
load are not used: they unpickle, and they leave out the environment and the random states.
"""

import json
import os
from collections import deque
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from stable_baselines3 import DQN
from stable_baselines3.common.buffers import ReplayBuffer

from overcooked_bench.envs.sb3 import OvercookedVecEnv

from ..learning.algorithms import AnyLearner
from .place import CheckpointError

FORMAT: Final = 1


def save_checkpoint(
    path: Path, model: AnyLearner, config: dict[str, Any], memory: dict[str, Any] | None = None
) -> None:
    """Writes a run's whole state; only between an update and the next rollout.

    Args:
        path: The file, replaced in one go.
        model: The learner, with an `OvercookedVecEnv`.
        config: The run's resolved configuration, compared on load.
        memory: What else the run remembers, as plain values; `load_checkpoint` gives it back.
    """
    env = _env_of(model)
    assert model._last_episode_starts is not None
    name, keys, position, has_gauss, gauss = np.random.get_state()  # noqa: NPY002 (SB3 shuffles with it)
    arrays = {
        **{f"env.{key}": array for key, array in env.snapshot().items()},
        "numpy.keys": np.asarray(keys),
        "last_obs": np.asarray(model._last_obs),
        "last_episode_starts": np.asarray(model._last_episode_starts),
    }
    plain: dict[str, Any] = {}
    if isinstance(model, DQN):
        plain["dqn"] = _save_replay(model, arrays)
    for name_of_state, state in _recurrent_states(model).items():
        arrays[name_of_state] = state.cpu().numpy()
    content = {
        "format": FORMAT,
        "plain": json.dumps(
            {
                "config": config,
                "num_timesteps": model.num_timesteps,
                "n_updates": model._n_updates,
                "numpy": [name, int(position), int(has_gauss), float(gauss)],
                "episodes": list(model.ep_info_buffer or []),
                "memory": memory or {},
                **plain,
            }
        ),
        "policy": model.policy.state_dict(),
        "optimizer": model.policy.optimizer.state_dict(),
        "torch_random": torch.get_rng_state(),
        "arrays": {key: _as_tensor(array) for key, array in arrays.items()},
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".part")
    with unfinished.open("wb") as file:
        torch.save(content, file)
        file.flush()
        os.fsync(file.fileno())
    os.replace(unfinished, path)


def load_checkpoint(
    path: Path,
    model: AnyLearner,
    config: dict[str, Any],
    before: Callable[[int], None] = lambda joint_steps: None,
) -> dict[str, Any]:
    """Restores a new learner to the state of a checkpoint.

    Args:
        path: The file.
        model: The learner, with the same kitchens and partners.
        config: The run's resolved configuration.
        before: Called with the joint steps done, before the kitchens are restored.

    Returns:
        The memory that was saved.

    Raises:
        CheckpointError: No such file, not readable, or the configuration differs; says in what.
    """
    try:
        content = torch.load(path, map_location="cpu", weights_only=True)
        if content["format"] != FORMAT:
            raise CheckpointError(f"{path}: format {content['format']!r}; this version reads {FORMAT}")
        plain = json.loads(content["plain"])
        check_same(path, plain["config"], config)
        before(plain["num_timesteps"] // (model.n_envs // _env_of(model).kitchens.num_kitchens))
        _apply(content, plain, model)
        return dict(plain.get("memory", {}))
    except CheckpointError:
        raise
    except FileNotFoundError:
        raise CheckpointError(f"{path}: no checkpoint to resume from; start without --resume") from None
    except Exception as error:  # a broken file shows itself in many ways
        fault = str(error).partition("\n")[0]
        raise CheckpointError(
            f"{path}: not a checkpoint of this run, or damaged ({type(error).__name__}: {fault}); "
            "start again without --resume and with another --output"
        ) from None


def load_weights(path: Path, model: AnyLearner) -> None:
    """Loads a run's weights alone, actor and critic, into a new learner of the same network.

    Raises:
        CheckpointError: No such file, not readable, or another network's.
    """
    try:
        model.policy.load_state_dict(torch.load(path, map_location="cpu", weights_only=True)["policy"])
    except Exception as error:  # a broken file shows itself in many ways
        fault = str(error).partition("\n")[0]
        raise CheckpointError(f"{path}: no weights of this network ({fault}); choose another --output") from None


def _env_of(model: AnyLearner) -> OvercookedVecEnv:
    env = model.get_env()
    assert isinstance(env, OvercookedVecEnv)
    return env


def check_same(path: Path, theirs: dict[str, Any], ours: dict[str, Any]) -> None:
    """Compares the configuration that was found in a file with that of the run.

    Raises:
        CheckpointError: They differ; says in what.
    """
    differing = sorted(key for key in {*ours, *theirs} if ours.get(key) != theirs.get(key))
    if differing:
        told = ", ".join(f"{key} was {theirs.get(key)!r}, is {ours.get(key)!r}" for key in differing)
        raise CheckpointError(f"{path}: belongs to another configuration ({told}); choose another --output")


def _apply(content: dict[str, Any], plain: dict[str, Any], model: AnyLearner) -> None:
    arrays = {key: _as_array(value) for key, value in content["arrays"].items()}
    _env_of(model).restore({key.removeprefix("env."): array for key, array in arrays.items() if key.startswith("env.")})
    model.policy.load_state_dict(content["policy"])
    model.policy.optimizer.load_state_dict(content["optimizer"])
    model.num_timesteps, model._n_updates = plain["num_timesteps"], plain["n_updates"]
    model._last_obs = arrays["last_obs"]
    model._last_episode_starts = arrays["last_episode_starts"]
    model.ep_info_buffer = deque(plain["episodes"], maxlen=model._stats_window_size)
    model.ep_success_buffer = deque(maxlen=model._stats_window_size)
    if isinstance(model, DQN):
        _restore_replay(model, arrays, plain["dqn"])
    for name_of_state, state in _recurrent_states(model).items():
        state.copy_(torch.from_numpy(arrays[name_of_state]))
    torch.set_rng_state(content["torch_random"])
    name, position, has_gauss, gauss = plain["numpy"]
    np.random.set_state((name, arrays["numpy.keys"], position, has_gauss, gauss))  # noqa: NPY002


def _recurrent_states(model: AnyLearner) -> dict[str, torch.Tensor]:
    """Returns what the rows of sb3-contrib's recurrent learner remember, by names of our own; nothing of others."""
    states = getattr(model, "_last_lstm_states", None) or ()
    return {f"lstm.{i}": tensor for i, tensor in enumerate(tensor for pair in states for tensor in pair)}


_REPLAY: Final = ("observations", "next_observations", "actions", "rewards", "dones", "timeouts")


def _save_replay(model: DQN, arrays: dict[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """Adds what DQN remembers to the arrays, and gives the rest of its state."""
    replay = model.replay_buffer
    assert type(replay) is ReplayBuffer
    filled = replay.buffer_size if replay.full else replay.pos
    arrays.update({f"replay.{name}": getattr(replay, name)[:filled] for name in _REPLAY})
    return {
        "pos": replay.pos,
        "full": replay.full,
        "calls": model._n_calls,
        "exploration": model.exploration_rate,
        "episode": model._episode_num,
        "actions": model.action_space.np_random.bit_generator.state,
    }


def _restore_replay(model: DQN, arrays: dict[str, np.ndarray[Any, Any]], plain: dict[str, Any]) -> None:
    replay = model.replay_buffer
    assert type(replay) is ReplayBuffer
    for name in _REPLAY:
        stored = arrays[f"replay.{name}"]
        getattr(replay, name)[: len(stored)] = stored
    replay.pos, replay.full = plain["pos"], plain["full"]
    model._n_calls, model._episode_num = plain["calls"], plain["episode"]
    model.exploration_rate = plain["exploration"]
    model.action_space.np_random.bit_generator.state = plain["actions"]


def _as_tensor(array: np.ndarray[Any, Any]) -> dict[str, Any]:
    """Stores any numeric array as bytes with its type, since torch lacks some of numpy's types."""
    data = np.ascontiguousarray(array)
    raw = torch.from_numpy(data.reshape(-1).view(np.uint8).copy())
    return {"type": data.dtype.str, "shape": list(array.shape), "bytes": raw}


def _as_array(stored: dict[str, Any]) -> np.ndarray[Any, Any]:
    return stored["bytes"].numpy().view(np.dtype(stored["type"])).reshape(stored["shape"]).copy()  # type: ignore[no-any-return]

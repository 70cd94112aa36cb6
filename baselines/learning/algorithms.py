"""The algorithms of stable-baselines3 that can train a best response, with settings that suit the kitchens.

`ppo` is our `Learner`; `a2c` and `dqn` are SB3's own classes, unchanged, over the same trunk.
"""

from typing import Final, Literal

import torch
from stable_baselines3 import A2C, DQN
from stable_baselines3.common.on_policy_algorithm import OnPolicyAlgorithm

from overcooked_bench.envs.sb3 import OvercookedVecEnv

from .arguments import ppo_arguments
from .learner import Learner
from .networks import TrunkPolicy, policy_kwargs
from .pressure import Pressure
from .settings import Settings

Algorithm = Literal["ppo", "a2c", "dqn"]
AnyLearner = OnPolicyAlgorithm | DQN

A2C_ROLLOUT: Final = 20
"""Steps of each kitchen between updates of A2C, at most."""
DQN_STEPS: Final = 4
"""The same of DQN."""
_REPLAY: Final = 50_000


def make_learner(
    settings: Settings,
    env: OvercookedVecEnv,
    seed: int,
    pressure: Pressure | None = None,
) -> Learner:
    """Makes PPO's learner, untrained."""
    torch.set_num_threads(settings.threads)
    return Learner(
        TrunkPolicy,
        env,
        **ppo_arguments(settings, seed),
        policy_kwargs=policy_kwargs(settings),
        pressure=pressure,
    )


def make_a2c(settings: Settings, env: OvercookedVecEnv, seed: int) -> A2C:
    """Makes A2C's learner: short rollouts of all kitchens, one step of the optimizer each."""
    torch.set_num_threads(settings.threads)
    return A2C(
        TrunkPolicy,
        env,
        learning_rate=settings.learning_rate_at,
        n_steps=min(A2C_ROLLOUT, settings.rollout),
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        vf_coef=settings.value_coefficient,
        max_grad_norm=settings.max_grad_norm,
        normalize_advantage=True,
        policy_kwargs={**policy_kwargs(settings), "optimizer_kwargs": {"alpha": 0.99, "eps": 1e-5}},
        seed=seed,
        device=settings.device,
    )


def make_dqn(settings: Settings, env: OvercookedVecEnv, seed: int) -> DQN:
    """Makes DQN's learner: as many samples are learned from as PPO takes in its passes over them, divided by epochs."""
    torch.set_num_threads(settings.threads)
    return DQN(
        "MlpPolicy",
        env,
        learning_rate=lambda left: settings.learning_rate_at(left) / 4,
        buffer_size=_REPLAY,
        learning_starts=min(_REPLAY // 5, settings.steps // 10),
        batch_size=DQN_STEPS * settings.num_kitchens,
        gamma=settings.gamma,
        train_freq=DQN_STEPS,
        gradient_steps=1,
        target_update_interval=100 * settings.num_kitchens,
        exploration_fraction=0.3,
        max_grad_norm=10 * settings.max_grad_norm,
        policy_kwargs={**policy_kwargs(settings), "optimizer_kwargs": {"eps": 1e-5}},
        seed=seed,
        device=settings.device,
    )

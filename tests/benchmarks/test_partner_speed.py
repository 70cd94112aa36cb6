"""What partners cost: a step with them, their forward alone, and an update of a learner that trains against them."""

import time
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from overcooked_bench.agents.policies.neural import NeuralAgent, PolicyStack
from overcooked_bench.agents.policies.policy import ARCHITECTURES, Policy, load_policy, save_policy
from overcooked_bench.baselines.learning.learner import Learner
from overcooked_bench.baselines.learning.networks import TrunkPolicy, policy_kwargs
from overcooked_bench.baselines.learning.settings import PartnerSettings
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.benchmarks.measuring import measure

pytestmark = pytest.mark.benchmark

LAYOUT, KITCHENS, PARTNERS, ROLLOUT = "cramped_room", 64, 4, 100
STAY, FROZEN, APART = "against stay", "against four frozen policies", "the same, each asked by itself"
NETWORKS = {"mlp": (128, 128), "cnn": (64, 64, 64)}


class Apart(NeuralAgent):
    """A neural agent that acts in a forward of its own."""


def make_learner(network: str, envs: OvercookedVecEnv, seed: int) -> Learner:
    """PPO as the `fast` configuration has it, with one of the two networks."""
    settings = PartnerSettings(layout=LAYOUT, network=network, hidden=NETWORKS[network])  # type: ignore[arg-type]
    return Learner(
        TrunkPolicy,
        envs,
        n_steps=ROLLOUT,
        batch_size=KITCHENS * ROLLOUT // 8,
        n_epochs=settings.epochs,
        policy_kwargs=policy_kwargs(settings),
        seed=seed,
        device="cpu",
    )


@pytest.fixture(scope="module")
def frozen(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[Policy]]:
    """Four policies of each network as training freezes them, untrained."""
    torch.set_num_threads(1)
    folder = tmp_path_factory.mktemp("frozen")
    return {network: [_freeze(folder / f"{network}-{i}", network, i) for i in range(PARTNERS)] for network in NETWORKS}


def _freeze(stem: Path, network: str, seed: int) -> Policy:
    policy = make_learner(network, kitchens(STAY, []), seed).policy
    told = {"observation": "lossless", "observation_shape": (22, 4, 5), "layout": LAYOUT, "cooking": "auto"}
    architecture = ARCHITECTURES[network](**told, hidden=NETWORKS[network])  # type: ignore[arg-type, call-arg]
    return load_policy(save_policy(stem, architecture, policy.actor_weights()).weights)


def kitchens(what: str, policies: list[Policy]) -> OvercookedVecEnv:
    kind = Apart if what == APART else NeuralAgent
    partners = ["stay"] if what == STAY else [kind(policy) for policy in policies]
    envs = OvercookedVecEnv(LAYOUT, KITCHENS, partners=partners, shaping=1.0)
    envs.seed(0)
    return envs


def facts(what: str) -> dict[str, str]:
    return {"kind": "partners", "what": what}


@pytest.mark.parametrize("what", [STAY, FROZEN, APART])
@pytest.mark.parametrize("network", NETWORKS)
def test_a_step(benchmark: Any, frozen: dict[str, list[Policy]], network: str, what: str) -> None:
    envs = kitchens(what, frozen[network])
    envs.reset()
    actions = cycle(list(np.random.default_rng(0).integers(0, 6, (400, KITCHENS))))
    group = f"a step of {KITCHENS} kitchens, partners {network}"
    measure(benchmark, group, lambda: envs.step(next(actions)), KITCHENS, **facts(what))


@pytest.mark.parametrize("network", NETWORKS)
def test_the_forward_alone(benchmark: Any, frozen: dict[str, list[Policy]], network: str) -> None:
    envs = kitchens(STAY, [])
    seen = envs.reset()
    assignment = PolicyStack(frozen[network]).assign(np.repeat(np.arange(PARTNERS), KITCHENS // PARTNERS))
    group = f"a step of {KITCHENS} kitchens, partners {network}"
    measure(benchmark, group, lambda: assignment.probabilities(seen), KITCHENS, **facts("the stacked forward alone"))


@pytest.mark.parametrize("network", NETWORKS)
def test_an_update_of_a_learner(benchmark: Any, frozen: dict[str, list[Policy]], network: str) -> None:
    """Each update against four frozen policies is timed right after one against `stay`, so that both meet one load."""
    steps = KITCHENS * ROLLOUT
    with_stay, model = (make_learner(network, kitchens(what, frozen[network]), seed=0) for what in (STAY, FROZEN))
    seconds: list[tuple[float, float]] = []
    for learner in (with_stay, model):
        learner.learn(steps)

    def timed(learner: Learner) -> float:
        start = time.perf_counter()
        learner.learn(steps, reset_num_timesteps=False)
        return time.perf_counter() - start

    def setup() -> None:
        seconds.append((timed(with_stay), 0.0))

    def call() -> None:
        seconds[-1] = seconds[-1][0], timed(model)

    benchmark.group = f"an update of {steps} joint steps, learner and partners {network}"
    benchmark.pedantic(call, setup=setup, rounds=4 if network == "cnn" else 15)
    stay, four = np.transpose(seconds)
    benchmark.extra_info |= facts(FROZEN) | {
        "joint_steps": steps,
        "stay_median": float(np.median(stay)),
        "stay_min": float(stay.min()),
        "ratio_to_stay": float(np.median(four / stay)),
    }
    assert model.num_timesteps == with_stay.num_timesteps == steps * (1 + len(seconds))

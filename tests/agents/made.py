"""Small policies and pool entries for the tests of agents."""

import numpy as np

from overcooked_bench.agents.policies.lstm import Lstm
from overcooked_bench.agents.policies.policy import Cnn, Mlp, Policy, PolicyFiles, load_policy, save_policy
from overcooked_bench.agents.pools.records import Entry, Profile, ScriptedReference, SeatProfile, SelfPlay, Training


def small_mlp(layout="cramped_room", shape=(22, 4, 5), **others):
    settings = {"observation": "lossless", "cooking": "auto", "hidden": (8, 5), "activation": "relu", **others}
    return Mlp(layout=layout, observation_shape=shape, **settings)


def small_cnn(observation="lossless", layout="cramped_room", shape=(22, 4, 5), **others):
    settings = {"cooking": "auto", "filters": 3, "hidden": (7, 5), "previous": 2 * (observation == "stack_states")}
    return Cnn(observation=observation, layout=layout, observation_shape=shape, **(settings | others))


def small_lstm(layout="cramped_room", shape=(22, 4, 5), **others):
    settings = {"observation": "lossless", "cooking": "auto", "trunk": (6,), "units": 5, "head": (4,), **others}
    return Lstm(layout=layout, observation_shape=shape, **settings)


def random_weights(architecture, seed, scale=0.1):
    rng = np.random.default_rng(seed)
    return {name: rng.normal(0, scale, shape) for name, shape in architecture.tensor_shapes().items()}


def write_policy(stem, seed=0, **settings) -> PolicyFiles:
    architecture = small_mlp(**settings)
    return save_policy(stem, architecture, random_weights(architecture, seed))


def make_policy(folder, seed=0, **settings) -> Policy:
    return load_policy(write_policy(folder / f"policy-{seed}", seed, **settings).weights)


SEAT = SeatProfile(
    **{"mean": 100.0, "low": 95.0, "high": 105.0, "partial_reward": 40.0},
    **{"pots": 7.5, "plates": 2.5, "deliveries": 5.0, "counter_drops": 1.0, "counter_pickups": 0.5},
)


def record(name="sp-0", layout="cramped_room", **others):
    """A policy's entry; others are keys of the entry or of its training."""
    training = {
        "method": "self-play",
        "seed": 2**63 + 5,
        "namespace": "tests",
        "settings": {"learning_rate": 1e-3, "hidden": (128, 128), "steps": 10},
        "steps": 10,
        "self_play": SelfPlay(mean=200, low=190.5, high=210.0, episodes=100),
        "configuration": "fast",
        "checkpoint": 1,
        "codebase": None,
        "profile": Profile(entropy=0.5, seats=(SEAT, SEAT)),
    }
    entry = {"reference": None, "role": "partner", "stratum": "self-play", "lineage": f"{layout}/{name}"}
    entry["training"] = Training(**(training | {key: value for key, value in others.items() if key in training}))
    given = {key: value for key, value in others.items() if key not in training}
    return Entry(name=name, layout=layout, **(entry | given))


def scripted(name, layout="cramped_room", version=1, role="partner"):
    """The entry of a scripted agent."""
    reference = ScriptedReference(agent=name, version=version)
    return Entry(
        name=name, layout=layout, reference=reference, role=role, stratum="scripted", lineage=f"scripted/{name}"
    )

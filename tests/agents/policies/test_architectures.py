"""The networks, against the same computed by hand: loops over cells in numpy, float64."""

import itertools
import json

import msgspec
import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.agents.policies.architectures import ARCHITECTURES, Cnn
from overcooked_bench.agents.policies.neural import NeuralAgent, PolicyStack
from overcooked_bench.agents.policies.policy import PolicyError, load_policy, save_policy
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.grid import Grid
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.agents.made import random_weights, small_cnn, small_lstm, small_mlp

GRIDS = {
    "cramped_room": (4, 5),
    "counter_circuit": (5, 8),
}
SHAPED = [name for name, observation in OBSERVATIONS.items() if isinstance(observation, Grid)]


def leaky(x):
    return np.where(x > 0, x, 0.01 * x)


def convolved(image, kernels, biases, padding):
    image = np.pad(image, ((0, 0), (padding, padding), (padding, padding)))
    size = kernels.shape[-1]
    height, width = image.shape[1] - size + 1, image.shape[2] - size + 1
    out = np.empty((len(kernels), height, width))
    for y, x in itertools.product(range(height), range(width)):
        window = image[:, y : y + size, x : x + size]
        out[:, y, x] = (kernels * window).sum((1, 2, 3)) + biases
    return leaky(out)


def block(policy, image):
    for i, padding in enumerate((2, 1, 0)):
        image = convolved(image, policy.weights[f"conv.{i}.weight"], policy.weights[f"conv.{i}.bias"], padding)
    return image.reshape(-1)


def plain_chances(policy, observation):
    weights, observation = policy.weights, observation.astype(np.float64)
    if policy.architecture.observation == "stack_states":
        current, *older = [block(policy, image) for image in observation]
        small = [leaky(weights["previous.weight"] @ x + weights["previous.bias"]) for x in older]
        x = np.concatenate([current, *small])
    else:
        x = block(policy, observation)
    for i in range(len(policy.architecture.hidden)):
        x = leaky(weights[f"trunk.{i}.weight"] @ x + weights[f"trunk.{i}.bias"])
    logits = weights["action.weight"] @ x + weights["action.bias"]
    chances = np.exp(logits - logits.max())
    return chances / chances.sum()


def shown(layout, observation, rows):
    """What chefs see in the middle of random play."""
    kitchens = Kitchens(layout, rows, object_probability=0.8, history=3)
    kitchens.reset(seed=1)
    for actions in np.random.default_rng(2).integers(0, 6, (20, rows, 2)):
        kitchens.step(actions)
    return kitchens.observe(observation)[:, 0]


def policies_of(folder, architecture, count=3):
    stems = [folder / f"policy-{seed}" for seed in range(count)]
    for seed, stem in enumerate(stems):
        save_policy(stem, architecture, random_weights(architecture, seed), dtype=np.float32)
    return [load_policy(stem) for stem in stems]


@pytest.mark.parametrize("layout", GRIDS)
@pytest.mark.parametrize("observation", SHAPED)
def test_convolutions_are_those_of_the_paper(tmp_path, layout, observation):
    architecture = small_cnn(observation, layout, OBSERVATIONS[observation].shape(Layout.load(layout)))
    policies, rows = policies_of(tmp_path, architecture), np.array([2, 0, 0, 1])
    observations = shown(layout, observation, len(rows))
    chances = PolicyStack(policies).assign(rows).probabilities(observations)
    expected = [plain_chances(policies[k], seen) for k, seen in zip(rows, observations, strict=True)]
    np.testing.assert_allclose(chances, expected, rtol=1e-4, atol=1e-6)
    assert np.ptp(chances, axis=0).max() > 0.01  # there is something to tell apart


def test_the_current_state_and_each_older_one_has_its_place(tmp_path):
    (policy,) = policies_of(tmp_path, small_cnn("stack_states", "cramped_room", (4, 22, 4, 5)), 1)
    rng = np.random.default_rng(0)
    images = rng.integers(0, 2, (4, 22, 4, 5))
    orders = list(itertools.permutations(range(4)))
    chances = PolicyStack([policy]).assign(np.zeros(24, int)).probabilities(np.stack([images[list(o)] for o in orders]))
    np.testing.assert_allclose(chances[7], plain_chances(policy, images[list(orders[7])]), rtol=1e-4)
    assert len(np.unique(chances.round(6), axis=0)) == 24


@settings(max_examples=20, deadline=None)
@given(index=st.lists(st.integers(0, 2), min_size=1, max_size=8))
def test_a_row_is_its_policys_whoever_else_plays(tmp_path_factory, index):
    architecture = small_cnn("lossless", "cramped_room", (22, 4, 5))
    policies = policies_of(tmp_path_factory.mktemp("cnn"), architecture)
    observations = shown("cramped_room", "lossless", len(index))
    together = PolicyStack(policies).assign(index).probabilities(observations)
    for k, seen, chances in zip(index, observations, together, strict=True):
        alone = PolicyStack([policies[k]]).assign([0]).probabilities(seen[None])
        np.testing.assert_allclose(chances, alone[0], rtol=1e-4, atol=1e-6)


def test_the_published_network_has_the_published_shapes():
    shapes = Cnn(observation="lossless", observation_shape=(22, 5, 5), layout="x", cooking="auto").tensor_shapes()
    assert shapes == {
        "conv.0.weight": (25, 22, 5, 5),
        "conv.0.bias": (25,),
        "conv.1.weight": (25, 25, 3, 3),
        "conv.1.bias": (25,),
        "conv.2.weight": (25, 25, 3, 3),
        "conv.2.bias": (25,),
        "trunk.0.weight": (64, 25 * 3 * 3),
        "trunk.0.bias": (64,),
        "trunk.1.weight": (64, 64),
        "trunk.1.bias": (64,),
        "trunk.2.weight": (64, 64),
        "trunk.2.bias": (64,),
        "action.weight": (6, 64),
        "action.bias": (6,),
    }


def test_the_small_layer_is_shared_by_the_older_states():
    shapes = small_cnn("stack_states", "cramped_room", (4, 22, 4, 5), filters=25, previous=16).tensor_shapes()
    assert shapes["previous.weight"] == (16, 25 * 2 * 3)
    assert shapes["trunk.0.weight"] == (7, 25 * 2 * 3 + 3 * 16)


def test_torch_computes_gradients_through_a_network():
    architecture = small_cnn("stack_states", "cramped_room", (4, 22, 4, 5))
    weights = {
        name: torch.tensor(w[None], dtype=torch.float32, requires_grad=True)
        for name, w in random_weights(architecture, 0).items()
    }
    inputs = torch.from_numpy(shown("cramped_room", "stack_states", 5)).float()[None]
    architecture.forward(weights, inputs).square().sum().backward()
    assert all(weight.grad.abs().sum() > 0 for weight in weights.values())


def test_convolutions_play_a_kitchen(tmp_path):
    agent = NeuralAgent(policies_of(tmp_path, small_cnn("lossless", "cramped_room", (22, 4, 5)), 2), index=[0, 1, 1])
    kitchens = Kitchens("cramped_room", 3)
    agent.reset("cramped_room", np.zeros(3, np.int64), np.arange(3, dtype=np.uint64))
    actions = np.stack([agent.act(kitchens.observe("lossless")[:, 0]) for _ in range(30)])
    assert set(actions.ravel()) == set(range(6))


@pytest.mark.parametrize(
    ("observation", "change", "message"),
    [
        ("lossless", {"observation": "features", "observation_shape": [96]}, "need a grid of at least 3x3"),
        ("lossless", {"observation_shape": [22, 2, 5]}, "need a grid of at least 3x3"),
        ("lossless", {"observation_shape": [1, 4, 22, 4, 5]}, r"\[channels, height, width\]"),
        ("stack_states", {"observation_shape": [4, 5]}, r"\[states, channels, height, width\]"),
        ("lossless", {"filters": 0}, "filters is 0"),
        ("lossless", {"filters": 10**6}, "at most"),
        ("lossless", {"previous": 4}, "0 with others"),
        ("stack_states", {"previous": 0}, "such as 16"),
        ("stack_states", {"previous": -1}, "such as 16"),
        ("lossless", {"hidden": []}, "hidden is"),
        (
            "lossless",
            {"filters": 5},
            r"conv.0.weight has the shape \[3, 22, 5, 5\]; the architecture says \[5, 22, 5, 5\]",
        ),
    ],
    ids=str,
)
def test_a_wrong_description_is_refused(tmp_path, observation, change, message):
    architecture = small_cnn(observation, "cramped_room", OBSERVATIONS[observation].shape(Layout.load("cramped_room")))
    files = save_policy(tmp_path / "cnn", architecture, random_weights(architecture, 0))
    files.architecture.write_text(json.dumps(json.loads(files.architecture.read_text()) | change))
    with pytest.raises(PolicyError, match=message):
        load_policy(files.weights)


@pytest.mark.parametrize(
    "architecture",
    [small_mlp(), small_cnn("stack_states", "cramped_room", (4, 22, 4, 5)), small_lstm()],
    ids=["mlp", "cnn", "lstm"],
)
def test_an_architecture_is_a_value(architecture):
    encoded = msgspec.json.encode(architecture)
    tag = json.loads(encoded)["architecture"]
    again = msgspec.json.decode(encoded, type=ARCHITECTURES[tag])
    assert again == architecture
    assert hash(again) == hash(architecture)

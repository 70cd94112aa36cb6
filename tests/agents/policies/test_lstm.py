"""The network with memory, against the same computed by hand, and against torch's own LSTM."""

import copy

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.agents.policies.ensemble import Ensemble
from overcooked_bench.agents.policies.lstm import Lstm
from overcooked_bench.agents.policies.neural import NeuralAgent, PolicyStack
from overcooked_bench.agents.policies.policy import load_policy, save_policy
from tests.agents.made import make_policy, random_weights, small_lstm

STEPS = 12


@pytest.fixture(scope="module")
def policies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lstm")
    return [made(folder / f"lstm-{seed}", small_lstm(), seed) for seed in range(3)]


def made(stem, architecture, seed=0):
    """A policy whose memory has much to say."""
    return load_policy(save_policy(stem, architecture, random_weights(architecture, seed, 0.7), np.float32).weights)


def shown(rows, seed=0, shape=(22, 4, 5)):
    """What the rows see, step by step: (STEPS, rows, *shape)."""
    return np.random.default_rng(seed).integers(0, 2, (STEPS, rows, *shape), dtype=np.uint8)


def by_torch(policy, views):
    """The chances of one row, (STEPS, 6), by torch's own layers in float64."""
    architecture, weights = policy.architecture, {n: torch.from_numpy(w).double() for n, w in policy.weights.items()}
    values = torch.from_numpy(views).double().flatten(1)
    for i in range(len(architecture.trunk)):
        values = torch.relu(values @ weights[f"trunk.{i}.weight"].T + weights[f"trunk.{i}.bias"])
    lstm = torch.nn.LSTM(values.shape[1], architecture.units).double()
    parts = {"weight_ih": "input.weight", "weight_hh": "memory.weight", "bias_ih": "bias"}
    with torch.no_grad():
        for theirs, ours in parts.items():
            getattr(lstm, f"{theirs}_l0").copy_(weights[f"lstm.{ours}"])
        lstm.bias_hh_l0.zero_()
        values, _ = lstm(values)
    for i in range(len(architecture.head)):
        values = torch.tanh(values @ weights[f"head.{i}.weight"].T + weights[f"head.{i}.bias"])
    return torch.softmax(values @ weights["action.weight"].T + weights["action.bias"], 1).numpy()


def chances(policies, index, views):
    assignment = PolicyStack(policies).assign(index)
    return np.stack([assignment.probabilities(seen) for seen in views])


def start(agent, rows, seed=0):
    agent.reset("cramped_room", np.zeros(rows, np.int64), np.arange(seed, seed + rows, dtype=np.uint64))
    return agent


def actions(agent, views):
    return np.stack([agent.act(seen) for seen in views])


@pytest.mark.parametrize("layers", [{}, {"trunk": ()}, {"head": ()}, {"trunk": (7, 6), "head": (5, 4)}], ids=str)
def test_each_row_goes_through_torchs_own_lstm(tmp_path, layers):
    policy, views = made(tmp_path / "lstm", small_lstm(**layers)), shown(4)
    ours = chances([policy], [0] * 4, views)
    for row in range(4):
        np.testing.assert_allclose(ours[:, row], by_torch(policy, views[:, row]), rtol=1e-4, atol=1e-6)


def test_what_was_seen_before_counts(policies):
    views = shown(2)
    views[1:, 1] = views[1:, 0]
    later = chances(policies[:1], [0, 0], views)[1:]
    assert np.abs(later[:3, 0] - later[:3, 1]).max() > 0.01


@settings(max_examples=25, deadline=None)
@given(index=st.lists(st.integers(0, 2), min_size=2, max_size=8), data=st.data())
def test_a_row_is_its_policys_however_the_batch_is_split(policies, index, data):
    index, views = np.array(index), shown(len(index))
    whole = chances(policies, index, views)
    first = np.array(data.draw(st.lists(st.booleans(), min_size=len(index), max_size=len(index))))
    for part in (first, ~first):
        if part.any():
            alone = chances(policies, index[part], views[:, part])
            np.testing.assert_allclose(whole[:, part], alone, rtol=1e-4, atol=1e-6)


def test_a_reset_forgets(policies):
    agent, views = start(NeuralAgent(policies[0]), 3), shown(3)
    first = actions(agent, views)
    assert (actions(agent, views) != first).any(), "random streams and memory go on"
    assert (actions(start(agent, 3), views) == first).all()


def test_a_copy_in_the_middle_of_an_episode_plays_on_alike(policies):
    agent, views = start(NeuralAgent(policies[0], mode="greedy"), 3), shown(3)
    actions(agent, views)
    twin = copy.deepcopy(agent)
    assert (actions(twin, views) == actions(agent, views)).all()


def test_an_ensemble_mixes_policies_with_memory_and_without(policies, tmp_path):
    plain = make_policy(tmp_path, hidden=(4,))
    index, views = np.array([1, 0, 2, 1, 0]), shown(5)
    ensemble = Ensemble([*policies[:2], plain])
    ensemble.assign(index)
    together = actions(start(ensemble, 5), views)
    for member, policy in enumerate((*policies[:2], plain)):
        rows = np.flatnonzero(index == member)
        alone = NeuralAgent(policy)
        alone.reset("cramped_room", np.zeros(len(rows), np.int64), rows.astype(np.uint64))
        assert (actions(alone, views[:, rows]) == together[:, rows]).all()


def test_inputs_that_never_count_are_dropped(tmp_path):
    architecture = small_lstm(trunk=())
    weights = random_weights(architecture, 0, 0.7)
    weights["lstm.input.weight"][:, 40:] = 0
    policy = load_policy(save_policy(tmp_path / "lstm", architecture, weights, np.float32).weights)
    narrow, live = architecture.narrowed({name: array[None] for name, array in policy.weights.items()})
    assert live.tolist() == list(range(40))
    assert narrow["lstm.input.weight"].shape == (1, 20, 40)
    views = shown(2)
    np.testing.assert_allclose(chances([policy], [0, 0], views)[:, 1], by_torch(policy, views[:, 1]), rtol=1e-4)


def test_the_shapes_are_those_of_torch():
    shapes = Lstm(observation="lossless", observation_shape=(22, 5, 5), layout="x", cooking="auto").tensor_shapes()
    assert shapes == {
        "lstm.input.weight": (256, 550),
        "lstm.memory.weight": (256, 64),
        "lstm.bias": (256,),
        "action.weight": (6, 64),
        "action.bias": (6,),
    }


@pytest.mark.parametrize(
    ("change", "message"),
    [({"units": 0}, "units is 0"), ({"trunk": (0,)}, "trunk is"), ({"head": (4, 0)}, "head is")],
    ids=str,
)
def test_a_wrong_description_is_refused(change, message):
    with pytest.raises(ValueError, match=message):
        small_lstm(**change)

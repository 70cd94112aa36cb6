import json

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.numpy import load_file, save_file

from overcooked_bench import Kitchens, UnknownLayout
from overcooked_bench.agents.policies.neural import NeuralAgent, PolicyError, PolicyStack, load_policy, save_policy
from tests.agents.made import make_policy, random_weights, small_mlp, write_policy


def plain_forward(policy, observation):
    """One row by numpy in float64, written apart from the library."""
    x = observation.reshape(-1).astype(np.float64)
    for i in range(len(policy.architecture.hidden)):
        x = policy.weights[f"trunk.{i}.weight"] @ x + policy.weights[f"trunk.{i}.bias"]
        x = np.maximum(x, 0) if policy.architecture.activation == "relu" else np.tanh(x)
    logits = policy.weights["action.weight"] @ x + policy.weights["action.bias"]
    chances = np.exp(logits - logits.max())
    return chances / chances.sum()


def seen(rows, seed=0, shape=(22, 4, 5)):
    return np.random.default_rng(seed).integers(0, 2, (rows, *shape), dtype=np.uint8)


@pytest.fixture(scope="module")
def policies(tmp_path_factory):
    return [make_policy(tmp_path_factory.mktemp("policies"), seed) for seed in range(4)]


def test_saved_policy_is_what_is_loaded(tmp_path):
    architecture = small_mlp(hidden=(8,), activation="tanh")
    weights = random_weights(architecture, 1)
    files = save_policy(tmp_path / "new" / "sp-0", architecture, {k: torch.tensor(w) for k, w in weights.items()})
    assert [file.name for file in files] == ["sp-0.safetensors", "sp-0.json"]
    assert {array.dtype for array in load_file(files.weights).values()} == {np.dtype(np.float16)}
    for path in (files.weights, files.architecture, tmp_path / "new" / "sp-0"):
        policy = load_policy(path)
        assert policy.name == "sp-0"
        assert policy.architecture == architecture
        for name, array in weights.items():
            np.testing.assert_array_equal(policy.weights[name], array.astype(np.float16).astype(np.float32))
    assert sorted(file.name for file in (tmp_path / "new").iterdir()) == ["sp-0.json", "sp-0.safetensors"]


def test_saving_twice_gives_the_same_bytes(tmp_path):
    first, second = write_policy(tmp_path / "a"), write_policy(tmp_path / "b")
    assert first.weights.read_bytes() == second.weights.read_bytes()
    assert first.architecture.read_bytes() == second.architecture.read_bytes()


def test_the_description_is_readable_json(tmp_path):
    description = json.loads(write_policy(tmp_path / "a").architecture.read_text())
    assert description == {
        "architecture": "mlp",
        "format": 1,
        "observation": "lossless",
        "observation_shape": [22, 4, 5],
        "layout": "cramped_room",
        "cooking": "auto",
        "hidden": [8, 5],
        "activation": "relu",
    }


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"architecture": "gru"}, r"'architecture' is 'gru'; this version knows 'mlp', 'cnn'"),
        ({"format": 2}, "format is 2"),
        ({"hidden": []}, "hidden is"),
        ({"hidden": [8, 6]}, r"trunk.1.weight has the shape \[5, 8\]; the architecture says \[6, 8\]"),
        ({"hidden": [8, 5, 5]}, r"missing: trunk.2.bias, trunk.2.weight"),
        ({"hidden": [10**9, 10**9]}, "at most"),
        ({"activation": "gelu"}, "gelu"),
        ({"observation": "pixels"}, "pixels"),
        ({"observation": "lossless26"}, r"'lossless26' on this layout has \[26, 4, 5\]"),
        ({"observation_shape": [22, 5, 5]}, r"observation_shape is \[22, 5, 5\]"),
        ({"observation_shape": []}, "observation_shape"),
        ({"layout": "kramped_room"}, "did you mean 'cramped_room'"),
        ({"surprise": 1}, "unknown field `surprise`"),
    ],
    ids=str,
)
def test_a_wrong_description_is_refused(tmp_path, change, message):
    files = write_policy(tmp_path / "sp-0")
    files.architecture.write_text(json.dumps(json.loads(files.architecture.read_text()) | change))
    with pytest.raises(PolicyError, match=message) as error:
        load_policy(files.weights)
    assert "sp-0" in str(error.value)


@pytest.mark.parametrize("content", [b"", b"[]", b'{"architecture": []}', b'{"architecture": 1}', b"\xff\xfe", b"{"])
def test_broken_json_is_refused(tmp_path, content):
    files = write_policy(tmp_path / "sp-0")
    files.architecture.write_bytes(content)
    with pytest.raises(PolicyError, match=r"sp-0\.json"):
        load_policy(files.weights)


@settings(max_examples=30, deadline=None)
@given(content=st.binary(max_size=200))
def test_broken_weights_are_refused(tmp_path_factory, content):
    files = write_policy(tmp_path_factory.mktemp("broken") / "sp-0")
    files.weights.write_bytes(content)
    with pytest.raises(PolicyError, match=r"sp-0\.safetensors"):
        load_policy(files.weights)


def test_missing_files_are_named(tmp_path):
    files = write_policy(tmp_path / "sp-0")
    files.weights.unlink()
    with pytest.raises(PolicyError, match=r"sp-0\.safetensors: cannot be read \(no such file"):
        load_policy(files.architecture)
    files.architecture.unlink()
    with pytest.raises(PolicyError, match=r"sp-0\.json: cannot be read \(no such file"):
        load_policy(tmp_path / "sp-0")


def test_wrong_tensors_are_refused_when_loading(tmp_path):
    files = write_policy(tmp_path / "sp-0")
    weights = load_file(files.weights)
    for change, message in (
        ({"action.bias": np.full(6, np.nan, np.float16)}, "infinite, undefined"),
        ({"action.bias": np.zeros(6, np.int32)}, "store float16 or float32"),
        ({"value.bias": np.zeros(1, np.float16)}, "unknown: value.bias"),
    ):
        save_file(weights | change, files.weights)
        with pytest.raises(PolicyError, match=message):
            load_policy(files.weights)
    save_file({"action.bias": np.zeros(10**6, np.float32)}, files.weights)
    with pytest.raises(PolicyError, match="larger than"):
        load_policy(files.weights)


def test_nothing_is_written_of_weights_that_do_not_fit(tmp_path):
    architecture = small_mlp()
    weights = random_weights(architecture, 0)
    for change in ({"action.bias": np.full(6, 1e6)}, {"action.bias": np.zeros(7)}, {"value": np.zeros(1)}):
        with pytest.raises(PolicyError):
            save_policy(tmp_path / "sp-0", architecture, weights | change)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("activation", ["relu", "tanh"])
def test_probabilities_are_those_of_the_network(tmp_path, activation):
    policy = make_policy(tmp_path, activation=activation)
    observations = seen(7)
    chances = PolicyStack([policy]).assign(np.zeros(7, int)).probabilities(observations)
    assert chances.dtype == np.float32
    expected = [plain_forward(policy, observation) for observation in observations]
    np.testing.assert_allclose(chances, expected, rtol=1e-4, atol=1e-6)


@settings(max_examples=25, deadline=None)
@given(index=st.lists(st.integers(0, 3), min_size=1, max_size=12))
def test_every_row_is_played_by_its_own_policy(policies, index):
    observations = seen(len(index))
    chances = PolicyStack(policies).assign(index).probabilities(observations)
    expected = [plain_forward(policies[k], observation) for k, observation in zip(index, observations, strict=True)]
    np.testing.assert_allclose(chances, expected, rtol=1e-3, atol=1e-6)


def test_inputs_that_no_policy_looks_at_are_left_out_and_change_nothing(tmp_path):
    architecture, blind = small_mlp(), np.random.default_rng(0).random(440) < 0.7
    policies = []
    for seed in range(2):
        weights = random_weights(architecture, seed)
        weights["trunk.0.weight"][:, blind] = 0
        weights["trunk.0.weight"][:, [3, 5]] = 0
        weights["trunk.0.weight"][:, [3, 5][seed]] = 1  # one of them looks at it
        policies.append(load_policy(save_policy(tmp_path / f"blind-{seed}", architecture, weights).weights))
    narrow, live = architecture.narrowed({n: np.stack([p.weights[n] for p in policies]) for n in policies[0].weights})
    assert live.tolist() == sorted({*np.flatnonzero(~blind).tolist(), 3, 5})
    assert narrow["trunk.0.weight"].shape == (2, 8, len(live))
    for index in ([0, 0, 1, 1], [1, 0, 0]):  # equal neighbouring groups, and others
        observations = seen(len(index))
        chances = PolicyStack(policies).assign(index).probabilities(observations)
        expected = [plain_forward(policies[k], shown) for k, shown in zip(index, observations, strict=True)]
        np.testing.assert_allclose(chances, expected, rtol=1e-3, atol=1e-6)


def test_the_order_of_rows_and_policies_changes_no_bit(policies):
    rng = np.random.default_rng(5)
    index = np.repeat(np.arange(4), 6)
    observations = seen(24)
    expected = PolicyStack(policies).assign(index).probabilities(observations)
    for _ in range(5):
        rows, order = rng.permutation(24), rng.permutation(4)
        stack = PolicyStack([policies[k] for k in order])
        place = np.argsort(order)[index]
        np.testing.assert_array_equal(stack.assign(place[rows]).probabilities(observations[rows]), expected[rows])


def test_a_stack_refuses_what_it_cannot_play(policies, tmp_path):
    with pytest.raises(ValueError, match="different architectures"):
        PolicyStack([policies[0], make_policy(tmp_path, hidden=(4,))])
    with pytest.raises(ValueError, match="at least one"):
        PolicyStack([])
    stack = PolicyStack(policies)
    for index in ([0, 4], [-1, 0], [0.0, 1.0], [], [[0]]):
        with pytest.raises(ValueError, match="index"):
            stack.assign(index)
    with pytest.raises(ValueError, match="shape"):
        stack.assign([0, 1]).probabilities(seen(3))


def test_agents_draw_by_seed_and_step_alone(policies):
    observations, seeds = seen(6), np.arange(100, 106, dtype=np.uint64)
    index = np.array([0, 1, 2, 3, 0, 1])

    def play(rows):
        agent = NeuralAgent(policies, index=index[rows])
        agent.reset("cramped_room", np.zeros(len(rows), np.int64), seeds[rows])
        return np.stack([agent.act(observations[rows]) for _ in range(20)], axis=1)

    everybody = play(np.arange(6))
    assert everybody.dtype == np.int64
    assert len({tuple(row) for row in everybody}) == 6
    np.testing.assert_array_equal(play(np.array([4, 1])), everybody[[4, 1]])


def test_sampling_follows_the_probabilities(policies):
    observation = seen(1)
    rows = 4000
    agent = NeuralAgent(policies[0])
    agent.reset("cramped_room", np.zeros(rows, np.int64), np.arange(rows, dtype=np.uint64))
    counts = np.bincount(agent.act(np.repeat(observation, rows, axis=0)), minlength=6) / rows
    np.testing.assert_allclose(counts, plain_forward(policies[0], observation[0]), atol=0.03)


def test_greedy_takes_the_likeliest_and_the_lowest_of_equals(tmp_path):
    architecture = small_mlp()
    weights = {name: np.zeros(shape) for name, shape in architecture.tensor_shapes().items()}
    weights["action.bias"] = np.array([0, 1, 0, 0, 1, 0])
    agent = NeuralAgent(load_policy(save_policy(tmp_path / "equal", architecture, weights).weights), mode="greedy")
    agent.reset("cramped_room", np.zeros(3, np.int64), np.arange(3, dtype=np.uint64))
    assert agent.act(seen(3)).tolist() == [1, 1, 1]


def test_agents_play_their_own_layout_alone(policies):
    agent = NeuralAgent(policies[0])
    for layout in ("coordination_ring", "cramped_room-mirrored"):
        with pytest.raises(UnknownLayout, match="was trained on 'cramped_room'"):
            agent.reset(layout, np.zeros(1, np.int64), np.zeros(1, np.uint64))


def test_wrong_use_of_an_agent_is_told(policies):
    with pytest.raises(ValueError, match="choose 'sample' or 'greedy'"):
        NeuralAgent(policies[0], mode="best")  # type: ignore[arg-type]
    agent = NeuralAgent(policies)
    with pytest.raises(ValueError, match="before reset"):
        agent.act(seen(1))
    with pytest.raises(ValueError, match=r"assign\(index\)"):
        agent.reset("cramped_room", np.zeros(2, np.int64), np.zeros(2, np.uint64))
    agent.assign([0, 1, 2])
    with pytest.raises(ValueError, match="2 episodes"):
        agent.reset("cramped_room", np.zeros(2, np.int64), np.zeros(2, np.uint64))


def test_agents_play_a_kitchen(policies):
    kitchens = Kitchens("cramped_room", 8)
    kitchens.reset(seed=1)
    seats = [NeuralAgent(policies, index=np.arange(8) % 4), NeuralAgent(policies[0])]
    for seat, agent in enumerate(seats):
        agent.reset("cramped_room", np.full(8, seat), np.arange(8, dtype=np.uint64) + np.uint64(10 * seat))
    for _ in range(10):
        views = kitchens.observe("lossless")
        kitchens.step(np.stack([agent.act(views[:, seat]) for seat, agent in enumerate(seats)], axis=1))
    assert kitchens.state(0).timestep == 10

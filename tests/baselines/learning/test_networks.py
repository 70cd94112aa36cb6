import numpy as np
import pytest
import torch

from overcooked_bench import Kitchens, Layout
from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.learning.inputs import spreader
from overcooked_bench.baselines.learning.networks import CnnTrunk, Trunk, TrunkPolicy
from overcooked_bench.kitchen.observations.grid import Grid
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.baselines.tiny import tiny, tiny_learner
from tests.kitchen.strategies import joint_actions

NETWORKS = ("mlp", "cnn")
GRIDS = [name for name, observation in OBSERVATIONS.items() if isinstance(observation, Grid)]


def seen_in_play(observation, layout="coordination_ring"):
    """Observations of random play, among them urgent ones, (B, ...)."""
    kitchens = Kitchens(layout, 4, horizon=60, object_probability=0.5, history=3)
    kitchens.reset(seed=1)
    views = []
    for actions in joint_actions(0, 80, 4):
        kitchens.step(actions)
        views.append(kitchens.observe(observation))
    return np.concatenate(views).reshape(-1, *views[0].shape[2:])


def opinionated_learner(config):
    """A learner whose actions are far from equally likely, as those of a fresh one are."""
    model = tiny_learner(config, 3)
    torch.manual_seed(0)
    with torch.no_grad():
        model.policy.action_net.weight.normal_(0, 3)
    return model


@pytest.mark.parametrize("network", NETWORKS)
@pytest.mark.parametrize("observation", GRIDS)
def test_the_frozen_actor_is_the_learners_policy(observation, network, tmp_path):
    config = tiny(layout="coordination_ring", observation=observation, network=network, hidden=(16, 12), previous=5)
    model = opinionated_learner(config)
    policy, views = model.policy, seen_in_play(observation)
    with torch.no_grad():
        theirs = policy.get_distribution(torch.from_numpy(views)).distribution.probs.numpy()
    assert theirs.max() > 0.8
    with torch.no_grad():
        for parameter in policy.parameters():  # as they are stored, so that only the arithmetic is compared
            parameter.copy_(parameter.half().float())
        theirs = policy.get_distribution(torch.from_numpy(views)).distribution.probs.numpy()
    frozen = load_policy(freeze(tmp_path / "policy", model, config).weights)
    ours = PolicyStack([frozen]).assign(np.zeros(len(views), int)).probabilities(views)
    np.testing.assert_allclose(ours, theirs, atol=1e-4)


@pytest.mark.parametrize("observation", GRIDS)
def test_the_first_convolution_is_the_one_over_the_whole_picture(observation):
    """Against torch's own convolutions; on a layout that is not square."""
    policy = opinionated_learner(tiny(layout="cramped_room", observation=observation, network="cnn")).policy
    trunk = policy.features_extractor
    assert isinstance(trunk, CnnTrunk)
    views = torch.from_numpy(seen_in_play(observation, "cramped_room"))
    states = 4 if observation == "stack_states" else 1
    x = views.float().reshape(len(views) * states, *views.shape[-3:])
    with torch.no_grad():
        for layer in (trunk.first, trunk.second, trunk.third):
            x = torch.nn.functional.leaky_relu(layer(x))
        ours = trunk._convolve(trunk.compact(views).reshape(len(x), -1))
    assert x.abs().max() > 0.1
    torch.testing.assert_close(ours, x.flatten(1), atol=1e-4, rtol=1e-4)


@pytest.mark.parametrize("observation", GRIDS)
def test_whole_observations_come_back_out_of_compact_ones(observation):
    views = seen_in_play(observation)
    config = tiny(layout="coordination_ring", observation=observation)
    trunk = tiny_learner(config, 0).policy.features_extractor
    back = spreader(Layout.load("coordination_ring"), observation, views.shape[1:])
    assert np.array_equal(back(trunk.compact(torch.from_numpy(views))).numpy(), views)


def test_a_frozen_actor_stays_as_it_is_when_training_goes_on():
    policy = opinionated_learner(tiny()).policy
    weights = policy.actor_weights()
    before = {name: tensor.clone() for name, tensor in weights.items()}
    with torch.no_grad():
        for parameter in policy.parameters():
            parameter += 1
    assert all(tensor.equal(before[name]) for name, tensor in weights.items())


def test_the_trunk_is_shared_and_all_of_it_is_trained():
    policy = tiny_learner(tiny(hidden=(16, 12)), 0).policy
    assert isinstance(policy, TrunkPolicy)
    assert isinstance(policy.features_extractor, Trunk)
    assert policy.pi_features_extractor is policy.vf_features_extractor is policy.features_extractor
    sizes = {tuple(parameter.shape) for group in policy.optimizer.param_groups for parameter in group["params"]}
    live = len(policy.features_extractor.live)
    assert sizes == {(16, live), (16,), (12, 16), (12,), (6, 12), (6,), (1, 12), (1,)}


@pytest.mark.parametrize("network", NETWORKS)
def test_every_parameter_gets_a_gradient(network):
    model = opinionated_learner(tiny(network=network, observation="stack_states", previous=3))
    views = torch.from_numpy(seen_in_play("stack_states", "cramped_room"))
    logs, values = model.policy.judge(model.policy.compact(views))
    (logs[:, 0].sum() + values.sum()).backward()
    assert all(parameter.grad is not None and parameter.grad.any() for parameter in model.policy.parameters())


def test_a_dead_input_changes_nothing_and_a_live_one_does():
    policy = opinionated_learner(tiny()).policy
    views = torch.from_numpy(seen_in_play("lossless", "cramped_room")[:1])
    live = policy.features_extractor.live
    dead = torch.tensor(sorted(set(range(views.numel())) - set(live.tolist())))

    def logits(changed):
        other = views.clone().flatten()
        other[changed] = 9
        with torch.no_grad():
            return policy.get_distribution(other.view_as(views)).distribution.logits

    assert logits(dead).equal(logits(torch.tensor([], dtype=torch.long)))
    assert not logits(live[:1]).equal(logits(torch.tensor([], dtype=torch.long)))


def test_values_at_the_horizon_are_those_of_training():
    """SB3 asks `predict_values` for the value of a truncated episode's last state, past `extract_features`."""
    policy = opinionated_learner(tiny()).policy
    views = torch.from_numpy(seen_in_play("lossless", "cramped_room"))
    with torch.no_grad():
        _, values, _ = policy(views)
        assert policy.predict_values(views).equal(values)

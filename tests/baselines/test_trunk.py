import numpy as np
import pytest
import torch

from overcooked_bench import Kitchens
from overcooked_bench.agents.neural import PolicyStack
from overcooked_bench.agents.policy import load_policy, save_policy
from overcooked_bench.baselines.self_play import make_learner
from overcooked_bench.baselines.trunk import Trunk, TrunkPolicy, frozen_actor
from overcooked_bench.kitchen.kitchens import GRID_PLANES
from tests.baselines.tiny import tiny
from tests.kitchen.strategies import joint_actions


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
    model = make_learner(config, 3)
    torch.manual_seed(0)
    with torch.no_grad():
        model.policy.action_net.weight.normal_(0, 3)
    return model


@pytest.mark.parametrize("observation", GRID_PLANES)
def test_the_frozen_actor_is_the_learners_policy(observation, tmp_path):
    config = tiny(layout="coordination_ring", observation=observation, hidden=(16, 12))
    model = opinionated_learner(config)
    views = seen_in_play(observation)
    with torch.no_grad():
        theirs = model.policy.get_distribution(torch.from_numpy(views)).distribution.probs.numpy()
    assert theirs.max() > 0.9
    architecture, weights = frozen_actor(model.policy, observation, "coordination_ring", "auto", config.hidden)
    for dtype, tolerance in ((np.float32, 1e-5), (np.float16, 5e-2)):
        policy = load_policy(save_policy(tmp_path / "policy", architecture, weights, dtype).weights)
        assert policy.architecture == architecture
        ours = PolicyStack([policy]).assign(np.zeros(len(views), int)).probabilities(views)
        np.testing.assert_allclose(ours, theirs, atol=tolerance)


def test_a_frozen_actor_stays_as_it_is_when_training_goes_on():
    model = opinionated_learner(tiny())
    _, weights = frozen_actor(model.policy, "lossless", "cramped_room", "auto", (16,))
    before = {name: tensor.clone() for name, tensor in weights.items()}
    with torch.no_grad():
        for parameter in model.policy.parameters():
            parameter += 1
    assert all(tensor.equal(before[name]) for name, tensor in weights.items())


def test_the_trunk_is_shared_and_all_of_it_is_trained():
    model = make_learner(tiny(hidden=(16, 12)), 0)
    policy = model.policy
    assert isinstance(policy, TrunkPolicy)
    assert isinstance(policy.features_extractor, Trunk)
    assert policy.pi_features_extractor is policy.vf_features_extractor is policy.features_extractor
    assert [layer.out_features for layer in policy.features_extractor.linears()] == [16, 12]
    sizes = {tuple(parameter.shape) for group in policy.optimizer.param_groups for parameter in group["params"]}
    live = len(policy.features_extractor.live)
    assert sizes == {(16, live), (16,), (12, 16), (12,), (6, 12), (6,), (1, 12), (1,)}


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

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from overcooked_bench import Layout
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.learning.inputs import spreader
from overcooked_bench.baselines.learning.learner import Batch
from overcooked_bench.baselines.learning.pressure import FLOOR, Pressure, clipped, kl_divergence, member_logs
from overcooked_bench.baselines.presets import config_names, load_config
from tests.baselines.tiny import tiny, tiny_learner
from tests.kitchen.strategies import law

P = (0.1679, 0.1647, 0.1644, 0.1663, 0.1713, 0.1654)
TABLE_7_1 = {
    (0.0336, 0.0729, 0.0467, 0.5419, 0.1431, 0.1617): 0.449,
    (0.0453, 0.1906, 0.1270, 0.2221, 0.0942, 0.3207): 0.183,
    (0.1875, 0.1851, 0.1663, 0.1369, 0.1414, 0.1828): 0.009,
}
LOGITS = arrays(np.float32, (5, 6), elements=st.floats(-8, 8, width=32))
SOUPS = {"R0": 0.5, "R1": 1.0, "R2": 1.5}


def logs_of(chances):
    return torch.tensor([chances], dtype=torch.float64).log()


@pytest.mark.parametrize("q", TABLE_7_1)
def test_the_printed_divergences_of_the_thesis(q):
    assert round(kl_divergence(logs_of(P), logs_of(q)).item(), 3) == TABLE_7_1[q]


@law
@given(logits=LOGITS, others=LOGITS)
def test_the_divergence_is_torchs(logits, others):
    p, q = (torch.distributions.Categorical(logits=torch.from_numpy(x)) for x in (logits, others))
    ours = kl_divergence(p.logits, q.logits)
    torch.testing.assert_close(ours, torch.distributions.kl_divergence(p, q), atol=1e-5, rtol=1e-5)
    assert (ours > -1e-5).all()
    assert kl_divergence(p.logits, p.logits).abs().max() < 1e-6


@law
@given(logits=LOGITS, members=st.lists(LOGITS, min_size=1, max_size=4))
def test_the_mean_over_members_is_the_divergence_from_their_mean_logs(logits, members):
    p = torch.log_softmax(torch.from_numpy(logits), 1)
    qs = torch.stack([torch.log_softmax(torch.from_numpy(q), 1) for q in members])
    mean = torch.stack([kl_divergence(p, q) for q in qs]).mean(0)
    torch.testing.assert_close(kl_divergence(p, qs.mean(0)), mean, atol=1e-4, rtol=1e-4)


@pytest.mark.parametrize("name", SOUPS)
def test_an_episodes_reward_is_bounded_by_so_many_soups(name):
    config = load_config("population", name, layout="cramped_room")
    steps = clipped(torch.full((400,), 1e6), config.reward_coefficient, config.reward_clip)
    assert steps.sum().item() == pytest.approx(20 * SOUPS[name])
    little = clipped(torch.tensor([0.0, 0.1]), config.reward_coefficient, config.reward_clip)
    assert little.tolist() == pytest.approx([0.0, 0.1 * config.reward_coefficient])


def test_the_rows_of_table_7_2():
    rows = {
        name: (c.reward_coefficient, c.reward_clip, c.loss_coefficient, c.loss_clip)
        for name in config_names("population")[:9]
        for c in [load_config("population", name, layout="cramped_room")]
    }
    assert rows == {
        "no_diversity": (0.0, 0.0, 0.0, 0.0),
        "R0": (0.08, 0.025, 0.0, 0.0),
        "R1": (0.15, 0.05, 0.0, 0.0),
        "R2": (0.1, 0.075, 0.0, 0.0),
        "L0": (0.0, 0.0, 0.08, 0.03),
        "L1": (0.0, 0.0, 0.12, 0.07),
        "L2": (0.0, 0.0, 0.1, 0.15),
        "R0L0": (0.08, 0.02, 0.08, 0.02),
        "R1L1": (0.1, 0.04, 0.1, 0.03),
    }


@pytest.fixture(scope="module")
def members(tmp_path_factory):
    """Three frozen policies, of two architectures."""
    home = tmp_path_factory.mktemp("members")
    policies = []
    for k, others in enumerate(({}, {}, {"network": "cnn", "hidden": (8,)})):
        config = tiny(**others)
        model = tiny_learner(config, k)
        torch.manual_seed(k)
        with torch.no_grad():
            model.policy.action_net.weight.normal_(0, 2)
        policies.append(load_policy(freeze(home / str(k), model, config).weights))
    return policies


def pressure_of(members, **settings):
    spread = spreader(Layout.load("cramped_room"), "lossless", members[0].architecture.observation_shape)
    return Pressure(members, spread, **settings)


def some_batch(model, size=40):
    live = len(model.policy.features_extractor.live)
    generator = torch.Generator().manual_seed(5)
    seen = (torch.rand(size, live, generator=generator) < 0.2).to(torch.uint8)
    actions = torch.randint(0, 6, (size,), generator=generator)
    logs = model.policy.judge(seen)[0].detach()
    others = torch.log_softmax(torch.randn(size, 6, generator=generator), 1)
    advantages, returns = torch.randn(2, size, generator=generator)
    return Batch(seen, actions, logs.gather(1, actions[:, None])[:, 0], advantages, returns, others)


def test_members_are_asked_together_and_averaged(members):
    observations = torch.rand(7, *members[0].architecture.observation_shape)
    together = member_logs(members, lambda begin, end: observations[begin:end], 7)
    alone = [
        torch.log_softmax(
            m.architecture.forward({n: torch.from_numpy(w)[None] for n, w in m.weights.items()}, observations[None])[0],
            1,
        ).clamp(min=FLOOR)
        for m in members
    ]
    torch.testing.assert_close(together, torch.stack(alone).mean(0), atol=1e-5, rtol=1e-5)


def test_the_reward_of_a_rollout_is_the_clipped_divergence_in_each_state(members):
    model = tiny_learner(tiny(), 0)
    pressure = pressure_of(members, reward_coefficient=0.1, reward_clip=0.12)
    seen = some_batch(model).seen.view(10, 4, -1)
    logs = model.policy.judge(seen.flatten(0, 1))[0].detach().view(10, 4, 6)
    rewards = pressure.watch(seen, logs)
    assert rewards.shape == (10, 4)
    for t, row in ((0, 0), (9, 3)):
        expected = 0.1 * kl_divergence(logs[t, row], pressure.others[t, row]).item()
        assert rewards[t, row] == pytest.approx(min(expected, 0.12), abs=1e-6)
    assert rewards.max() <= np.float32(0.12)
    assert (rewards < np.float32(0.12)).any()


@pytest.mark.parametrize("clip", [10.0, 0.05])
def test_the_gradient_of_the_loss_term_is_its_numerical_derivative(members, clip):
    """In double precision, for the term alone and for the whole loss."""
    model = tiny_learner(tiny(), 0)
    model.pressure = pressure_of(members, loss_coefficient=0.12, loss_clip=clip)
    batch = some_batch(model)
    model.policy.double()
    batch = batch._replace(
        **{name: getattr(batch, name).double() for name in ("log_probs", "advantages", "returns", "others")}
    )
    trunk = model.policy.features_extractor
    trunk.features = lambda seen: torch.relu(trunk.layers[0](seen.double()))
    head = model.policy.action_net.weight

    def bonus():
        return model.pressure.bonus(model.policy.judge(batch.seen)[0], batch.others)

    for function in (bonus, lambda: model.loss(batch, 0.2)[0]):
        model.policy.zero_grad()
        function().backward()
        gradient, change = head.grad.clone(), 1e-6
        for place in ((0, 0), (3, 7), (5, 15)):
            with torch.no_grad():
                head[place] += change
                above = function().item()
                head[place] -= 2 * change
                below = function().item()
                head[place] += change
            assert gradient[place].item() == pytest.approx((above - below) / (2 * change), abs=1e-6)
        assert gradient.abs().max() > 1e-4


def test_beyond_the_clip_there_is_no_gradient(members):
    model = tiny_learner(tiny(), 0)
    pressure = pressure_of(members, loss_coefficient=1e6, loss_clip=0.03)
    batch = some_batch(model)
    bonus = pressure.bonus(model.policy.judge(batch.seen)[0], batch.others)
    bonus.backward()
    assert bonus.item() == pytest.approx(0.03)
    assert model.policy.action_net.weight.grad.abs().max() == 0


def test_the_term_lowers_the_loss_by_itself(members):
    model = tiny_learner(tiny(), 0)
    batch = some_batch(model)
    plain = model.loss(batch, 0.2)[0].item()
    model.pressure = pressure_of(members, loss_coefficient=0.1, loss_clip=1.0)
    pressed, parts = model.loss(batch, 0.2)
    assert parts["kl_bonus"].item() > 0.01
    assert pressed.item() == pytest.approx(plain - parts["kl_bonus"].item(), abs=1e-6)

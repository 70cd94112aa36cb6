"""What every method's settings refuse, before any training."""

from dataclasses import replace
from functools import partial
from typing import get_type_hints

import pytest

from overcooked_bench.baselines.learning.settings import SettingsError
from overcooked_bench.baselines.methods import METHODS
from overcooked_bench.baselines.pbt import Leg, scheduled
from overcooked_bench.baselines.presets import config_class
from overcooked_bench.baselines.self_play import Config as SelfPlay
from tests.baselines.tiny import SETTINGS, UPDATE

WRONG = [
    ("self-play", {"gamma": 1.5}, "gamma=1.5; give a share from 0 to 1"),
    ("self-play", {"gae_lambda": -0.1}, "gae_lambda=-0.1; give a share from 0 to 1"),
    ("self-play", {"learning_rate": 0.0}, "learning_rate=0.0; give a number above 0"),
    ("self-play", {"clip": float("nan")}, "clip=nan; give a number above 0"),
    ("self-play", {"max_grad_norm": -1.0}, "max_grad_norm=-1.0; give a number above 0"),
    ("self-play", {"entropy_end": -0.1}, "entropy_end=-0.1; give a number from 0"),
    ("self-play", {"value_coefficient": -1.0}, "value_coefficient=-1.0; give a number from 0"),
    ("self-play", {"restarts": -1}, "restarts=-1; give a number from 0"),
    ("biased-self-play", {"bias_weights": ()}, "need at least one entry each"),
    ("best-response", {"per_episode": 5}, "at most one partner for each of the 4 kitchens"),
    ("best-response", {"per_episode": -1}, "per_episode=-1"),
    ("partner-sampling", {"per_episode": 5}, "at most one partner for each of the 4 kitchens"),
    ("partner-sampling", {"save_every": 0}, "save_every=0"),
    ("pretrained-partners", {"per_episode": 5}, "at most one partner for each of the 4 kitchens"),
    ("pretrained-partners", {"per_episode": 0}, "per_episode=0"),
    ("pretrained-partners", {"agents": 0}, "agents=0"),
    ("pretrained-partners", {"agent_steps": UPDATE - 1}, f"agent_steps={UPDATE - 1}: .* at least two updates"),
    ("pbt", {"rounds": 4, "agents": 2}, f"two updates, {2 * UPDATE} joint steps"),
    ("pbt", {"rounds": 0, "agents": 2}, "rounds=0"),
    ("pbt", {"agents": 5}, "each agent a kitchen"),
    ("pbt", {"agents": 2, "rounds": 1, "check_share": 0.5}, "check_share=0.5.* leave both out"),
    ("pbt", {"agents": 2, "rounds": 1, "snapshots": (0.5,)}, "leave both out"),
    ("stock-ppo", {"network": "cnn", "observation": "stack_states"}, "'stack_states' is no single grid"),
    ("population", {"per_episode": 5, "chosen": 5}, "at most one partner for each of the 4 kitchens"),
    ("population", {"candidate_steps": UPDATE - 1}, f"candidate_steps={UPDATE - 1}: .* at least two updates"),
    ("population", {"final_factor": 0.5}, "final_factor=0.5; give a factor from 1"),
    ("population", {"reward_coefficient": 0.1}, "reward_coefficient=0.1 with reward_clip=0.0"),
    ("population", {"loss_clip": 0.1}, "loss_coefficient=0.0 with loss_clip=0.1"),
    ("population", {"loss_coefficient": -0.1, "loss_clip": 0.1}, "loss_coefficient=-0.1"),
]


@pytest.mark.parametrize(
    ("method", "others", "told"),
    WRONG,
    ids=[f"{method}-{'-'.join(others)}-{i}" for i, (method, others, _) in enumerate(WRONG)],
)
def test_what_no_run_can_be_made_with_is_refused_before_any_training(method, others, told):
    assert method in METHODS
    with pytest.raises(ValueError, match=told):
        config_class(method)(**SETTINGS | others)


@pytest.mark.parametrize(
    "kind",
    [SelfPlay, partial(Leg, begun=0, whole=SETTINGS["steps"])],
    ids=["a run", "a leg of population-based training"],
)
def test_a_share_of_0_means_from_the_start(kind):
    config = kind(**SETTINGS, shaping_share=0.0, entropy_share=0.0, entropy_start=0.3, entropy_end=0.1)
    assert [config.shaping_at(done) for done in (0, 1, UPDATE)] == [0, 0, 0]
    assert [config.entropy_at(done) for done in (0, 1, UPDATE)] == [0.1, 0.1, 0.1]


def test_the_schedules_of_a_leg_are_those_of_the_whole_run():
    whole = SelfPlay(**SETTINGS | {"steps": 20 * UPDATE})
    leg = Leg(**SETTINGS | {"steps": 5 * UPDATE}, begun=5 * UPDATE, whole=20 * UPDATE)
    for done in (0, UPDATE, 5 * UPDATE):
        assert leg.shaping_at(done) == whole.shaping_at(5 * UPDATE + done)
        assert leg.entropy_at(done) == whole.entropy_at(5 * UPDATE + done)
        left = 1 - done / leg.steps
        assert leg.learning_rate_at(left) == pytest.approx(whole.learning_rate_at(0.5 + left / 4))


def test_habits_are_paid_for_once_half_of_the_partial_rewards_has_faded():
    config = config_class("biased-self-play")(**SETTINGS | {"shaping_share": 0.5})
    shares = [config.event_share_at(round(part * config.steps)) for part in (0, 0.2, 0.25, 0.375, 0.5, 1)]
    assert shares == pytest.approx([0, 0, 0, 0.5, 1, 1])
    assert config_class("self-play")(**SETTINGS).event_share_at(0) == 1


def test_what_a_copy_mutates_stays_mutated_to_the_end_of_its_schedule():
    config = config_class("pbt")(
        **SETTINGS | {"agents": 2, "rounds": 1, "learning_rate_end": 1e-4, "entropy_end": 0.02}
    )
    hyper = {"learning_rate": 2 * config.learning_rate, "entropy_start": config.entropy_start / 2, "clip": 0.1}
    ends = {"learning_rate_end": 2e-4, "entropy_end": 0.01}
    assert scheduled(hyper, config) == pytest.approx(hyper | ends)
    still = replace(config, entropy_start=0.0)
    assert scheduled({"learning_rate": still.learning_rate, "entropy_start": 0.0}, still) == pytest.approx(
        {"learning_rate": still.learning_rate, "entropy_start": 0.0, "learning_rate_end": 1e-4}
    )


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
@pytest.mark.parametrize("method", METHODS)
def test_no_setting_is_infinite_or_no_number(method, value):
    kind = config_class(method)
    for name, hint in get_type_hints(kind).items():
        if hint in (float, tuple[float, ...]):
            with pytest.raises(SettingsError, match=name):
                kind(**SETTINGS | {name: value if hint is float else (value,)})

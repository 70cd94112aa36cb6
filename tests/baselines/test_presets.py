import pytest

from overcooked_bench.baselines import presets
from overcooked_bench.baselines.methods import METHODS
from overcooked_bench.baselines.presets import PresetError, config_names, load_config
from overcooked_bench.envs.spaces import observation_space
from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import layout_names

EVERY = [(method, name) for method in METHODS for name in config_names(method)]


@pytest.mark.parametrize(("method", "name"), EVERY, ids=[f"{method}-{name}" for method, name in EVERY])
def test_every_shipped_configuration_can_be_made(method, name):
    for layout in layout_names():  # they may differ by layout
        config = load_config(method, name, layout=layout, seed=3)
        assert (config.layout, config.seed) == (layout, 3)
        assert observation_space(Kitchens(layout, 1, history=3), config.observation).shape


@pytest.mark.parametrize("method", METHODS)
def test_what_is_set_apart_for_a_layout_is_for_one_that_there_is(method):
    for settings in presets._read(method).values():
        assert set((settings or {}).get("by_layout", {})) <= set(layout_names())


def test_the_applied_column_of_table_6_1():
    config = load_config("self-play", "thesis", layout="forced_coordination")
    assert (config.gamma, config.gae_lambda, config.clip, config.max_grad_norm) == (0.98, 0.95, 0.1, 0.3)
    assert (config.epochs, config.num_kitchens, config.steps, config.value_coefficient) == (8, 30, 5_500_000, 0.1)
    assert 2 * config.num_kitchens * config.rollout / config.minibatches == 2000
    assert {config.learning_rate_at(left) for left in (1.0, 0.5, 0.0)} == {4e-4}
    assert config.entropy_at(0) == pytest.approx(0.1)
    assert config.entropy_at(750_000) == pytest.approx(0.065)
    assert config.entropy_at(1_500_000) == config.entropy_at(5_000_000) == pytest.approx(0.03)
    assert config.shaping_at(1_250_000) == pytest.approx(0.5)
    assert config.shaping_at(2_500_000) == pytest.approx(0)
    assert config.check_share * config.steps == pytest.approx(3e6)
    assert config.start == "random"


@pytest.mark.parametrize("method", [method for method in METHODS if "thesis" in config_names(method)])
def test_the_value_coefficient_of_the_thesis_differs_on_cramped_room(method):
    assert load_config(method, "thesis", layout="cramped_room").value_coefficient == 0.01
    assert load_config(method, "thesis", layout="cramped_room-mirrored").value_coefficient == 0.01
    assert load_config(method, "thesis,stack_states", layout="counter_circuit").value_coefficient == 0.1
    assert load_config(method, "thesis", layout="cramped_room", value_coefficient=0.5).value_coefficient == 0.5


def test_the_originally_proposed_column():
    config = load_config("self-play", "carroll", layout="cramped_room")
    assert (config.gamma, config.gae_lambda, config.clip, config.max_grad_norm) == (0.99, 0.98, 0.05, 0.1)
    assert (config.steps, config.value_coefficient, config.start, config.check_share) == (6e6, 0.5, "standard", 0)
    assert config.learning_rate_at(0.3) == pytest.approx(1e-3)
    assert {config.entropy_at(done) for done in (0, 3_000_000, 6_000_000)} == {0.1}


def test_configurations_are_joined_and_later_ones_win():
    config = load_config("population", "thesis,L0,stack_channels", layout="cramped_room", steps=1_000_000)
    assert (config.network, config.loss_coefficient, config.loss_clip) == ("cnn", 0.08, 0.03)
    assert (config.observation, config.steps, config.candidate_steps) == ("stack_channels", 1_000_000, 5_500_000)
    assert load_config("population", "L0,L1", layout="cramped_room").loss_clip == 0.07


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"layout": "cramped_room", "epoch": 3}, "unknown setting 'epoch'; did you mean 'epochs'"),
        ({"layout": "cramped_room", "epochs": 2.5}, "epochs: 2.5 does not fit"),
        ({"layout": "cramped_room", "epochs": True}, "epochs: True does not fit"),
        ({"layout": "cramped_room", "network": "transformer"}, "network: 'transformer' does not fit"),
        ({"layout": "cramped_room", "hidden": [64, "a"]}, "hidden: .* does not fit .*Expected `int`"),
        ({}, "the setting 'layout' is missing"),
    ],
)
def test_a_wrong_setting_is_named(settings, told):
    with pytest.raises(PresetError, match=told):
        load_config("self-play", "fast", **settings)


def test_a_file_that_is_no_mapping_is_refused(monkeypatch, tmp_path):
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "self-play.yaml").write_text("- fast\n")
    monkeypatch.setattr(presets, "files", lambda _: tmp_path)
    with pytest.raises(PresetError, match="not a mapping"):
        config_names("self-play")
    with pytest.raises(WrongUse, match="no training method named 'self-pley'"):
        config_names("self-pley")

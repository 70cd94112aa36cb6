import json

import pytest

from overcooked_bench import load_agent
from overcooked_bench.agents.pool import Pool
from overcooked_bench.baselines import dev_pool
from overcooked_bench.baselines.seeds import derive_seed
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.baselines.test_checkpoint import press_ctrl_c
from tests.baselines.tiny import STEPS, tiny

LAYOUT = "cramped_room"


def test_a_pool_is_built_in_several_goes_and_written(tmp_path, monkeypatch):
    monkeypatch.setattr(dev_pool, "CONFIGS", {LAYOUT: tiny()})
    runs, home = tmp_path / "runs", tmp_path / "pool"
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 100)  # while the second agent is trained
        assert not dev_pool.build(runs, (LAYOUT,), (0, 1))
    assert dev_pool.build(runs, (LAYOUT,), (0, 1))
    with monkeypatch.context() as patch:
        patch.setattr(dev_pool, "train", lambda *_, **__: pytest.fail("a finished agent was trained again"))
        assert dev_pool.build(runs, (LAYOUT,), (0, 1))
    monkeypatch.setattr(dev_pool, "CONFIGS", {LAYOUT: tiny(epochs=9)})
    dev_pool.write(runs, home)
    pool = Pool.load(home)
    assert [agent.name for agent in pool.agents(LAYOUT)] == ["sp-0", "sp-1"]
    records = list(pool.agents(LAYOUT))
    assert [record.seed for record in records] == [derive_seed("dev-v0", LAYOUT, "self-play", k) for k in (0, 1)]
    assert {record.steps for record in records} == {STEPS}
    assert records[0].training["epochs"] == 2  # as it was trained, not as one would train it today
    assert not {"seed", "layout", "training_seed"} & records[0].training.keys()
    assert records[0].self_play.episodes == 100
    assert load_agent(f"{home}/{LAYOUT}/sp-1", LAYOUT).observation == "lossless"


def test_the_shipped_agents_can_be_trained_again_from_what_the_manifest_tells():
    pool = Pool.load("dev-v0")
    assert set(pool.layouts) == set(dev_pool.CONFIGS)
    for layout in pool.layouts:
        for index, record in enumerate(pool.agents(layout)):
            assert record.name == f"sp-{index}"
            assert record.seed == derive_seed(record.namespace, layout, record.method, index)
            config = dev_pool.SelfPlay(layout, steps=record.steps, **as_settings(record.training))
            assert config.num_kitchens * config.rollout * (record.steps // (64 * 200)) == record.steps


def as_settings(training):
    return {key: tuple(value) if isinstance(value, list) else value for key, value in training.items()}


def test_an_unknown_layout_is_answered_with_those_there_are(capsys, tmp_path):
    assert dev_pool.main(["--runs", str(tmp_path), "--layouts", "cramped_rom"]) == 2
    assert "cramped_room" in capsys.readouterr().err
    assert json.dumps([*tmp_path.iterdir()]) == "[]"

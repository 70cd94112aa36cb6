import numpy as np
import pytest

from overcooked_bench.agents.policies.policy import Policy, load_policy, save_policy
from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.pools.profile import measure
from overcooked_bench.evaluation.pools.verify import verify_pool
from tests.agents.made import random_weights, record, scripted, small_lstm, small_mlp, write_policy

LAYOUT = "cramped_room"


def pool_of(home, *changes):
    """A pool of random policies; each entry has its own seed unless it says otherwise."""
    entries = []
    for seed, change in enumerate(changes):
        if not (home / LAYOUT / f"sp-{seed}.json").exists():
            write_policy(home / LAYOUT / f"sp-{seed}", seed)
        entries.append(record(f"sp-{seed}", **{"seed": seed, **change}))
    write_manifest(home, "mine", entries)
    return home


def test_a_sound_pool_is_played(tmp_path):
    told = []
    verdict = verify_pool(pool_of(tmp_path, {}, {}), horizon=30, on_progress=lambda *at: told.append(at))
    assert (verdict.sound, verdict.findings, verdict.agents) == (True, (), 2)
    assert verdict.pool.name == "mine"
    assert told == [(LAYOUT, 1, 1)]


def test_a_scripted_partner_of_another_version_is_grave(tmp_path):
    grid = "XXPXX\nO  2O\nX1  X\nXDXSX"
    entries = [scripted("greedy", version=2), scripted("stay"), scripted("random", layout=grid)]
    write_manifest(tmp_path, "mine", entries)
    verdict = verify_pool(tmp_path, horizon=30)
    (finding,) = verdict.findings
    assert (verdict.sound, verdict.agents) == (False, 0)
    assert "means version 2 of the scripted agent 'greedy'" in finding.text


def test_ties_are_grave(tmp_path):
    verdict = verify_pool(pool_of(tmp_path, {"seed": 1}, {"seed": 1}), horizon=30)
    assert not verdict.sound
    assert "have the training seed 1" in verdict.findings[0].text


def test_a_pool_is_held_against_the_shipped_ones(tmp_path):
    shipped = Pool.load("dev-v0").agent(LAYOUT, "sp-0")
    verdict = verify_pool(pool_of(tmp_path, {"seed": shipped.trained.seed}, {}), horizon=30)
    assert [finding.text for finding in verdict.findings] == [
        f"{LAYOUT}/sp-0 shares the training seed with dev-v0/{LAYOUT}/sp-0"
    ]


def test_agents_that_act_alike_are_a_warning(tmp_path):
    architecture = small_mlp()
    weights = random_weights(architecture, 0)
    save_policy(tmp_path / LAYOUT / "sp-0", architecture, weights)
    weights["trunk.0.bias"][0] += 1e-3
    save_policy(tmp_path / LAYOUT / "sp-1", architecture, weights)
    verdict = verify_pool(pool_of(tmp_path, {}, {}, {}), horizon=30)
    assert verdict.sound
    (finding,) = verdict.findings
    assert "sp-0, sp-1 are near-duplicates" in finding.text


def test_damage_is_grave_and_nothing_is_no_pool(tmp_path):
    pool_of(tmp_path, {}, {})
    (tmp_path / LAYOUT / "sp-0.safetensors").write_bytes(b"")
    verdict = verify_pool(tmp_path)
    assert (verdict.pool, verdict.agents, verdict.sound) == (None, 0, False)
    assert "is not the file" in verdict.findings[0].text
    with pytest.raises(PoolError, match="no pool named"):
        verify_pool("nowhere")


@pytest.mark.parametrize("layout", ["asymmetric_advantages", "coordination_ring", "counter_circuit"])
def test_float16_changes_no_mean_by_more_than_its_error(layout):
    """Weights that would have been rounded to the stored ones play the same, up to the error of the mean."""
    stored, rng = Pool.load("dev-v0").policy(layout, "sp-0"), np.random.default_rng(0)
    exact = {}
    for name, weights in stored.weights.items():
        step = np.spacing(np.abs(weights).astype(np.float16)).astype(np.float32)
        exact[name] = weights + rng.uniform(-0.5, 0.5, weights.shape).astype(np.float32) * step
    ours = measure(stored, episodes=40).returns
    theirs = measure(Policy("exact", stored.architecture, exact, ""), episodes=40).returns
    assert any((exact[name] != weights).any() for name, weights in stored.weights.items())
    assert abs(theirs.mean() - ours.mean()) <= ours.std(ddof=1) / len(ours) ** 0.5


def test_policies_are_stored_in_float16(tmp_path):
    files = write_policy(tmp_path / "policy")
    count = sum(weights.size for weights in load_policy(files.weights).weights.values())
    assert 2 * count < files.weights.stat().st_size < 2 * count + 1000


def test_agents_with_memory_are_compared_over_whole_games(tmp_path):
    architecture = small_lstm()
    weights = random_weights(architecture, 0, 0.7)
    for name in ("sp-0", "sp-1"):
        save_policy(tmp_path / LAYOUT / name, architecture, weights)
        weights["lstm.memory.weight"][0, 0] += 1e-3
    weights["lstm.memory.weight"] *= -1
    save_policy(tmp_path / LAYOUT / "sp-2", architecture, weights)
    verdict = verify_pool(pool_of(tmp_path, {}, {}, {}, {}), horizon=30)
    assert (verdict.sound, verdict.agents) == (True, 4)
    (finding,) = verdict.findings
    assert "sp-0, sp-1 are near-duplicates" in finding.text

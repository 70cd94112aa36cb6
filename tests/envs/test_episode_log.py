"""An environment with partners that is saved, made anew and restored plays on as one that never stopped."""

import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Chef, KitchenState
from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import load_policy, save_policy
from overcooked_bench.envs.episode_log import generator_state, set_generator_state
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.agents.made import random_weights, small_cnn, small_mlp
from tests.envs.players import Answers, Wanderer

HORIZON, KITCHENS = 10, 6
EXAMPLES = 6


@pytest.fixture(scope="module")
def policies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("policies")
    kinds = (small_mlp(), small_mlp(), small_cnn("stack_states", shape=(4, 22, 4, 5)), small_mlp(hidden=(4,)))
    found = []
    for i, kind in enumerate(kinds):
        weights = {name: 10 * w for name, w in random_weights(kind, i).items()}
        found.append(load_policy(save_policy(folder / f"policy-{i}", kind, weights).weights))
    return found


def teams(policies):
    return {
        "random": ["random"],
        "greedy": ["greedy"],
        "neural": [NeuralAgent(policy) for policy in policies[:3]],
        "mixed": ["greedy", NeuralAgent(policies[0]), "random", NeuralAgent(policies[2])],
        "sampled": [SampledPartners([policies[0], policies[1], policies[3]], 2)],
    }


def make_env(partners, seed=0, **options):
    env = OvercookedVecEnv("cramped_room", KITCHENS, partners=partners, **{"horizon": HORIZON, **options})
    env.seed(seed)
    return env


def play(env, steps, seed):
    """Plays and gives everything that came out, as arrays."""
    out = []
    for actions in np.random.default_rng(seed).integers(0, 6, (steps, KITCHENS)):
        seen, rewards, dones, infos = env.step(actions)
        told = [(info["episode"]["r"], info["episode_soup_reward"]) for info in infos] if dones[0] else [(0, 0)]
        out += [seen, rewards, dones, np.array(told)]
    return out


def equal(ours, theirs):
    return len(ours) == len(theirs) and all(np.array_equal(a, b) for a, b in zip(ours, theirs, strict=True))


@pytest.mark.parametrize("team", ["random", "greedy", "neural", "mixed", "sampled"])
@settings(max_examples=EXAMPLES, deadline=None)
@given(before=st.integers(0, 2 * HORIZON + 5), after=st.integers(1, 2 * HORIZON), seed=st.integers(0, 2**31))
def test_a_restored_environment_plays_on_as_if_nothing_had_happened(policies, team, before, after, seed):
    options = {"shaping": 0.5, "object_probability": 0.5, "observation": "stack_channels"}
    env = make_env(teams(policies)[team], seed, **options)
    env.reset()
    play(env, before, seed)
    env.set_shaping(0.25)
    saved = env.snapshot()

    def future(env):
        return [*play(env, after, seed + 1), env.reset(), *play(env, 3, seed + 2)]

    expected = future(env)
    fresh = make_env(teams(policies)[team], seed + 1, **options)
    fresh.reset()
    play(fresh, 3, seed)
    for restored in (fresh, env, fresh):
        restored.restore(saved)
        assert equal(list(restored.snapshot().values()), list(saved.values()))
        assert equal(future(restored), expected)


def test_a_snapshot_does_not_change_with_the_game():
    env = make_env(["random"])
    env.reset()
    play(env, 4, 0)
    saved = env.snapshot()
    kept = copy.deepcopy(saved)
    play(env, 12, 1)
    env.restore(saved)
    play(env, 12, 2)
    assert equal(list(saved.values()), list(kept.values()))


def test_a_snapshot_from_before_the_first_reset():
    env, other = make_env(["random"]), make_env(["random"], seed=1)
    saved = env.snapshot()
    other.reset()
    play(other, 13, 0)
    other.restore(saved)
    for one in (env, other):
        one.seed(4)
    assert np.array_equal(env.reset(), other.reset())
    assert equal(play(env, 25, 0), play(other, 25, 0))


def test_snapshots_hold_arrays_of_numbers_alone(policies):
    env = make_env(teams(policies)["mixed"], observation="stack_channels")
    env.reset()
    play(env, 4, 0)
    assert {array.dtype.kind for array in env.snapshot().values()} <= set("iufb")
    assert env.snapshot()["episode.played"].shape == (4, KITCHENS, 2)


def test_other_partners_are_noticed(policies):
    env = make_env([NeuralAgent(policies[0]), "stay"])
    env.reset()
    play(env, 7, 0)
    saved = env.snapshot()
    for others in ([NeuralAgent(policies[1]), "stay"], [NeuralAgent(policies[0]), "random"]):
        with pytest.raises(ValueError, match=r"kitchen \d, step \d of the running episode: the partner plays \d where"):
            make_env(others).restore(saved)


def test_a_partner_that_depends_on_more_than_its_seed_is_noticed():
    class Drifts(Answers):
        def act(self, observations):
            self._answer = (self._answer + 1) % 6
            return self._answer

    env = make_env([Drifts(np.zeros(KITCHENS, np.int64))])
    env.reset()
    play(env, 7, 0)
    with pytest.raises(ValueError, match=r"kitchen 0, step 0 .* plays 2 where it played 1 .* same partners"):
        env.restore(env.snapshot())
    env.reset()
    play(env, 15, 0)


def test_a_state_set_within_the_episode_cannot_be_played_again():
    env = make_env(["stay"])
    env.reset()
    env.step(np.full(KITCHENS, 4))
    env.kitchens.set_state(1, KitchenState((Chef((1, 2), "south"), Chef((3, 2), "north", "onion")), timestep=1))
    with pytest.raises(ValueError, match="set to a state within the episode"):
        env.restore(env.snapshot())


def test_self_play_and_play_with_partners_are_told_apart():
    with_partners = make_env(["stay"])
    alone = OvercookedVecEnv("cramped_room", KITCHENS, self_play=True, horizon=HORIZON)
    with pytest.raises(ValueError, match="made in self-play, and this environment is with partners"):
        with_partners.restore(alone.snapshot())
    with pytest.raises(ValueError, match="made with partners, and this environment is in self-play"):
        alone.restore(with_partners.snapshot())
    for other in (("cramped_room", KITCHENS + 1), ("counter_circuit", KITCHENS)):
        with pytest.raises(ValueError, match="another layout, number of kitchens or history"):
            OvercookedVecEnv(*other).restore(with_partners.snapshot())


def test_partners_change_at_the_next_episode():
    first, second = Wanderer(), Wanderer("features")
    env = make_env([first])
    assert env.partners == (first,)
    env.reset()
    play(env, 4, 0)
    env.set_partners([second, "stay"])
    assert env.partners == (first,)
    play(env, HORIZON - 4, 1)
    assert env.partners == (second, "stay")
    assert (len(first.shown), len(second.shown)) == (HORIZON, 0)
    play(env, 2, 2)
    assert (len(first.shown), len(second.shown)) == (HORIZON, 2)
    assert second.shown[0].shape == (KITCHENS // 2, 96)
    env.set_partners([first])
    env.reset()
    play(env, 1, 0)
    assert (len(first.shown), len(second.shown)) == (HORIZON + 1, 2)


def test_changing_partners_changes_no_random_stream():
    seen = []
    for partners in (["stay"], ["greedy", "random"]):
        env = make_env(["stay"])
        env.reset()
        env.set_partners(partners)
        seen.append((env.reset(), env.reset()))
    assert equal(seen[0], seen[1])


def test_changed_partners_are_restored_when_they_are_set_again(policies):
    env = make_env(["random"])
    env.reset()
    play(env, 5, 0)
    env.set_partners([NeuralAgent(policies[0]), "greedy"])
    play(env, HORIZON, 1)
    saved = env.snapshot()
    expected = play(env, 20, 2)
    other = make_env(["random"])
    other.set_partners([NeuralAgent(policies[0]), "greedy"])
    other.restore(saved)
    assert other.partners[1] == "greedy"
    assert equal(play(other, 20, 2), expected)


def test_partners_that_cannot_play_are_refused_when_they_are_set(policies):
    env = make_env(["stay"])
    for partners, told in (
        ([], "at least one partner"),
        (["gredy"], "greedy"),
        (["stay"] * 7, "7 partners for 6 kitchens"),
        ([NeuralAgent(policies[2])], "needs the past"),
    ):
        with pytest.raises(ValueError, match=told):
            env.set_partners(partners)
    with pytest.raises(ValueError, match="without self_play"):
        OvercookedVecEnv("cramped_room", 2, self_play=True).set_partners(["stay"])
    assert OvercookedVecEnv("cramped_room", 2, self_play=True).partners == ()


@pytest.mark.parametrize("draws", [0, 1, 2, 7])
def test_a_generators_state_is_all_of_it(draws):
    generator, other = np.random.default_rng(3), np.random.default_rng(4)
    generator.integers(2, size=draws, dtype=np.uint32)  # an odd number leaves half a word
    set_generator_state(other, generator_state(generator))
    assert other.bit_generator.state == generator.bit_generator.state

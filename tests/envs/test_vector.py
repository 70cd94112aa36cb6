import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode
from gymnasium.wrappers.vector import RecordEpisodeStatistics

from overcooked_bench.envs.vector import OvercookedVectorEnv
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.envs.players import TOMATO_KITCHEN, Answers, Wanderer

NUM = 4


def make_both(name="Overcooked/CrampedRoom-v0", **options):
    """Our batch, and Gymnasium's loop over single environments."""
    loop = gym.make_vec(
        name,
        NUM,
        vectorization_mode="sync",
        vector_kwargs={"autoreset_mode": AutoresetMode.SAME_STEP},
        **options,
    )
    return gym.make_vec(name, NUM, **options), loop


def assert_equal(ours, theirs):
    assert data_equivalence(ours, theirs, exact=True), f"{ours}\n{theirs}"


@pytest.mark.parametrize(
    "options",
    [
        *({"observation": name} for name in OBSERVATIONS),
        {"seat": 1, "shaping": 0.5},
        {"cooking": "manual", "start": "standard"},
        {"object_probability": 0.8, "shaping": 1.0},
    ],
    ids=str,
)
def test_a_batch_equals_gymnasiums_loop_of_single_environments(options):
    ours, loop = make_both(horizon=7, **options)
    rng = np.random.default_rng(0)
    assert ours.metadata["autoreset_mode"] == AutoresetMode.SAME_STEP
    assert_equal(ours.observation_space, loop.observation_space)
    assert_equal(ours.action_space, loop.action_space)
    for seed in (5, None, [9, 1, 1, 3]):
        assert_equal(ours.reset(seed=seed), loop.reset(seed=seed))
        if seed is not None:
            assert ours.np_random_seed == loop.np_random_seed
        for _ in range(17):
            actions = rng.integers(0, 6, NUM)
            result = ours.step(actions)
            assert_equal(result, loop.step(actions))
            assert result[0] in ours.observation_space


def test_a_batched_partner_equals_a_loop_of_single_partners():
    batch = OvercookedVectorEnv("counter_circuit", NUM, partner=Wanderer("lossless"), horizon=5)
    loop = gym.vector.SyncVectorEnv(
        [lambda: gym.make("Overcooked/CounterCircuit-v0", partner=Wanderer("lossless"), horizon=5)] * NUM,
        autoreset_mode=AutoresetMode.SAME_STEP,
    )
    assert_equal(batch.reset(seed=2), loop.reset(seed=2))
    for _ in range(13):
        assert_equal(batch.step(np.full(NUM, 2)), loop.step(np.full(NUM, 2)))


@pytest.mark.parametrize("observation", [*OBSERVATIONS, "state"])
def test_a_partner_is_shown_the_other_seats(observation):
    partner = Wanderer(observation)
    envs = OvercookedVectorEnv("cramped_room", 8, partner=partner, horizon=3)
    _, infos = envs.reset(seed=1)
    for _ in range(7):
        seats = 1 - infos["seat"]
        assert np.array_equal(partner.resets[-1][1], seats)
        expected = (
            [envs.kitchens.state(i) for i in range(8)]
            if observation == "state"
            else envs.kitchens.observe(observation)[np.arange(8), seats]
        )
        *_, infos = envs.step(np.full(8, 1))
        shown = partner.shown[-1]
        assert shown == expected if observation == "state" else np.array_equal(shown, expected)
    assert len(partner.resets) == 3


def test_the_last_observation_of_an_episode_is_handed_over():
    envs = gym.make_vec("Overcooked/CrampedRoom-v0", 3, max_episode_steps=2, horizon=400, seat=0)
    envs.reset(seed=0)
    _, _, _, truncated, infos = envs.step(np.full(3, 4))
    assert not truncated.any()
    assert set(infos) == {"soup_reward", "_soup_reward", "partial_reward", "_partial_reward", "seat", "_seat"}
    before = envs.kitchens.observe("lossless")[:, 0]
    seen, _, terminated, truncated, infos = envs.step(np.full(3, 4))
    assert truncated.all()
    assert not terminated.any()
    assert infos["_final_obs"].all()
    assert [last.shape for last in infos["final_obs"]] == [(22, 4, 5)] * 3
    assert all(np.array_equal(last, old) for last, old in zip(infos["final_obs"], before, strict=True))
    assert np.array_equal(seen, envs.kitchens.observe("lossless")[:, 0])
    assert infos["final_info"]["_seat"].all()


def test_what_step_returns_is_never_written_again():
    envs = gym.make_vec("Overcooked/CrampedRoom-v0", 2, horizon=5, object_probability=1.0)
    kept = [envs.reset(seed=0)]
    copies = [repr(kept[0])]
    for actions in np.random.default_rng(0).integers(0, 6, (11, 2)):
        kept.append(envs.step(actions))
        copies.append(repr(kept[-1]))
    assert [repr(result) for result in kept] == copies
    for name, value in kept[-1][4].items():
        if name.startswith("_"):
            assert not value.flags.writeable
        else:
            value[...] = 0
    for value in kept[-1][:4]:
        value[...] = 0
    seen, *_ = envs.step(np.full(2, 4))
    assert seen.any()


def test_gymnasium_records_the_statistics_of_episodes():
    envs = RecordEpisodeStatistics(gym.make_vec("Overcooked/CrampedRoom-v0", 3, horizon=5, shaping=1.0))
    envs.reset(seed=0)
    total = np.zeros(3)
    for actions in np.random.default_rng(0).integers(0, 6, (5, 3)):
        _, rewards, _, _, infos = envs.step(actions)
        total += rewards
    assert infos["episode"]["l"].tolist() == [5, 5, 5]
    assert np.allclose(infos["episode"]["r"], total)


def test_random_seats_cover_both_in_one_batch_and_change():
    envs = gym.make_vec("Overcooked/CrampedRoom-v0", 64, horizon=1)
    _, infos = envs.reset(seed=0)
    assert 16 < infos["seat"].sum() < 48
    *_, later = envs.step(np.full(64, 4))
    assert 16 < (later["seat"] != infos["seat"]).sum() < 48


def test_unseeded_kitchens_differ():
    envs = gym.make_vec("Overcooked/CounterCircuit-v0", 16)
    assert len(envs.np_random) == 16
    first, _ = envs.reset()
    assert len({view.tobytes() for view in first}) > 1


def test_a_mask_resets_some_kitchens():
    ours, loop = make_both(horizon=4)
    mask = np.array([True, False, False, True])
    assert_equal(ours.reset(seed=3), loop.reset(seed=3))
    for _ in range(2):
        assert_equal(ours.step(np.full(NUM, 3)), loop.step(np.full(NUM, 3)))
    assert_equal(ours.reset(options={"reset_mask": mask}), loop.reset(options={"reset_mask": mask}))
    for _ in range(9):
        assert_equal(ours.step(np.full(NUM, 0)), loop.step(np.full(NUM, 0)))


@pytest.mark.parametrize("mask", [[True] * 4, np.ones(3, bool), np.ones(4), np.zeros(4, bool)])
def test_a_wrong_mask_is_refused(mask):
    envs = OvercookedVectorEnv("cramped_room", NUM)
    with pytest.raises(ValueError, match=r"give a bool array of the shape \(4,\) with at least one True"):
        envs.reset(options={"reset_mask": mask})


def test_a_mask_is_refused_with_a_seed_or_an_agent_that_plays_all_kitchens_together():
    mask = np.array([True, False, False, True])
    with pytest.raises(ValueError, match=r"either a seed or options\['reset_mask'\]"):
        OvercookedVectorEnv("cramped_room", NUM).reset(seed=0, options={"reset_mask": mask})
    envs = OvercookedVectorEnv("cramped_room", NUM, partner=Wanderer())
    with pytest.raises(ValueError, match="episodes must start together"):
        envs.reset(options={"reset_mask": mask})
    envs.reset(options={"reset_mask": np.ones(NUM, bool)})


def test_kitchens_out_of_step_are_refused_with_an_agent():
    envs = OvercookedVectorEnv("cramped_room", 2, partner=Wanderer(), horizon=5)
    envs.reset(seed=0)
    envs.step([4, 4])
    state = envs.kitchens.state(0)
    envs.reset(seed=0)
    envs.kitchens.set_state(0, state)
    for _ in range(3):
        envs.step([4, 4])
    with pytest.raises(RuntimeError, match="1 of 2 kitchens are over and the others are not"):
        envs.step([4, 4])


@pytest.mark.parametrize(
    "actions", [4, [4] * 3, [[4] * 4], [4.0] * 4, ["stay"] * 4, [4, 4, 6, 4], [4, 4, -1, 4], [True] * 4]
)
def test_actions_that_are_none_are_refused(actions):
    envs = OvercookedVectorEnv("cramped_room", NUM)
    envs.reset(seed=0)
    before = [envs.kitchens.state(i) for i in range(NUM)]
    with pytest.raises(ValueError, match="action"):
        envs.step(actions)
    assert [envs.kitchens.state(i) for i in range(NUM)] == before


def test_a_partners_wrong_answer_is_refused():
    envs = OvercookedVectorEnv("cramped_room", NUM, partner=Answers(np.zeros(3, int)))
    envs.reset(seed=0)
    with pytest.raises(ValueError, match=r"partner Answers, step 0: act returned the shape \(3,\)"):
        envs.step([4] * NUM)


def test_a_step_before_the_first_reset_and_wrong_seeds_are_refused():
    envs = OvercookedVectorEnv("cramped_room", NUM)
    with pytest.raises(gym.error.ResetNeeded, match=r"call reset\(\)"):
        envs.step([4] * NUM)
    with pytest.raises(ValueError, match="3 seeds for 4 kitchens"):
        envs.reset(seed=[1, 2, 3])


def test_a_custom_kitchen_in_a_batch():
    envs = gym.make_vec("Overcooked/Custom-v0", 2, layout=TOMATO_KITCHEN, observation="lossless26", horizon=3)
    envs.reset(seed=0)
    assert envs.step([0, 1])[0].shape == (2, 26, 4, 5)

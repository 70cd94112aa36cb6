import numpy as np
import pytest
import torch
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor

from overcooked_bench import Chef, Kitchens, KitchenState, Soup
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.envs.players import TOMATO_KITCHEN, Answers, Wanderer
from tests.kitchen.strategies import joint_actions

NORTH, STAY, INTERACT = 0, 4, 5
SELF_PLAY = {"self_play": True}
SERVING_AND_FILLING = KitchenState((Chef((3, 2), "south", Soup((3, 0), 20, 20)), Chef((2, 1), "north", "onion")))
"""On cramped_room: chef 0 serves a soup and chef 1 fills the pot, if both interact."""


def make_env(num=3, layout="cramped_room", seed=0, **options):
    env = OvercookedVecEnv(layout, num, **{"horizon": 10, **options})
    env.seed(seed)
    return env


def play(env, steps, seed=0):
    """Random play after a reset or in mid-game: lists of observations, rewards, dones and infos."""
    actions = np.random.default_rng(seed).integers(0, 6, (steps, env.num_envs))
    return tuple(zip(*(env.step(row) for row in actions), strict=True))


def same_game(ours, theirs):
    return all(np.array_equal(np.stack(a), np.stack(b)) for a, b in zip(ours[:3], theirs[:3], strict=True))


def twin_of(env, history=0):
    """A second game in the same state, without autoreset."""
    kitchens = env.kitchens
    twin = Kitchens(kitchens.layout, kitchens.num_kitchens, horizon=kitchens.horizon, history=history)
    twin.autoreset = False
    twin.restore(kitchens.snapshot())
    return twin


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_in_self_play_rows_2k_and_2k_plus_1_are_the_chefs_of_kitchen_k(observation):
    env = make_env(3, self_play=True, observation=observation)
    assert env.num_envs == 6
    seen = env.reset()
    for step in range(13):
        assert seen.shape == (6, *env.observation_space.shape)
        assert seen.dtype == env.observation_space.dtype
        assert np.array_equal(seen.reshape(3, 2, *seen.shape[1:]), env.kitchens.observe(observation))
        assert all(env.observation_space.contains(row) for row in seen)
        row = step % 6
        facing = [[chef.facing for chef in env.kitchens.state(k).chefs] for k in range(3)]
        actions = np.full(6, STAY)
        actions[row] = NORTH
        seen, _, dones, _ = env.step(actions)
        if not dones[0]:
            facing[row // 2][row % 2] = "north"
            assert [[chef.facing for chef in env.kitchens.state(k).chefs] for k in range(3)] == facing


@pytest.mark.parametrize("shaping", [0.0, 0.5, 1.0])
def test_a_rows_reward_is_the_teams_soups_and_its_own_partial_rewards(shaping):
    env = make_env(2, self_play=True, shaping=shaping)
    env.reset()
    env.kitchens.set_state(1, SERVING_AND_FILLING)
    _, rewards, _, _ = env.step(np.array([STAY, STAY, INTERACT, INTERACT]))
    assert rewards.dtype == np.float32
    assert rewards.tolist() == [0, 0, 20, 20 + 3 * shaping]


@pytest.mark.parametrize(("seat", "reward"), [(0, 20), (1, 21.5)])
def test_against_partners_the_reward_is_the_learners(seat, reward):
    env = make_env(1, partners=[Answers(np.array([INTERACT]))], seat=seat, shaping=0.5)
    env.reset()
    env.kitchens.set_state(0, SERVING_AND_FILLING)
    assert env.step(np.array([INTERACT]))[1].tolist() == [reward]


def test_shaping_can_be_changed_at_any_time():
    env = make_env(1, self_play=True)
    env.reset()
    for weight, reward in ((0.0, 20), (1.0, 23), (0.25, 20.75)):
        env.set_shaping(weight)
        env.kitchens.set_state(0, SERVING_AND_FILLING)
        assert env.step(np.array([INTERACT, INTERACT]))[1].tolist() == [20, reward]


@pytest.mark.parametrize("options", [SELF_PLAY, {"partners": None, "seat": 1}], ids=["self-play", "partners"])
@pytest.mark.parametrize("observation", ["lossless", "stack_states"])
def test_the_horizon_ends_an_episode_as_vec_monitor_tells_it(options, observation):
    partners = [Answers(np.full(2, INTERACT)) for _ in range(2)]
    env = make_env(4, shaping=1.0, observation=observation, **{**options, "partners": partners})
    history = 3 if observation == "stack_states" else 0
    views = slice(None) if env.num_envs == 8 else [1, 3, 5, 7]  # of the eight chefs' views
    env.reset()
    for _ in range(2):
        early = [env.step(np.full(env.num_envs, INTERACT)) for _ in range(9)]
        assert not any(dones.any() or any(infos) for *_, dones, infos in early)
        env.kitchens.set_state(2, KitchenState(SERVING_AND_FILLING.chefs, timestep=9))
        twin = twin_of(env, history)
        seen, rewards, dones, infos = env.step(np.full(env.num_envs, INTERACT))
        twin.step(np.full((4, 2), INTERACT))
        ends = twin.observe(observation).reshape(8, *seen.shape[1:])[views]
        totals = sum(step[1] for step in early) + rewards
        assert dones.dtype == np.bool_
        assert dones.all()
        assert len(infos) == env.num_envs
        for row, info in enumerate(infos):
            assert info["TimeLimit.truncated"] is True
            assert np.array_equal(info["terminal_observation"], ends[row])
            assert not np.array_equal(seen[row], ends[row])
            assert info["episode"].keys() == {"r", "l", "t"}
            assert info["episode"]["r"] == pytest.approx(totals[row])
            assert info["episode"]["l"] == 10
            assert 0 <= info["episode"]["t"] < 600
            assert info["episode_soup_reward"] == (20 if row * 4 // env.num_envs == 2 else 0)
        assert totals.max() == 23
        assert [env.kitchens.state(i).timestep for i in range(4)] == [0] * 4


def test_episode_returns_are_the_sums_of_rewards():
    env = make_env(3, self_play=True, shaping=0.5, horizon=100, object_probability=0.9)
    env.reset()
    for actions in joint_actions(0, 200, 3).reshape(2, 100, 6):
        steps = [env.step(row) for row in actions]
        rewards = np.sum([rewards for _, rewards, *_ in steps], 0)
        assert rewards.sum() > 0
        assert [info["episode"]["r"] for info in steps[-1][3]] == pytest.approx(rewards.tolist())


@pytest.mark.parametrize("observation", [*OBSERVATIONS, "state"])
def test_partners_share_out_the_kitchens_and_see_the_other_seats(observation):
    partners = [Wanderer(observation), Wanderer("features")]
    env = make_env(5, partners=partners, horizon=4)
    seen = env.reset()
    assert env.num_envs == 5
    for _ in range(9):
        seats = np.concatenate([partner.resets[-1][1] for partner in partners])
        assert [len(partner.resets[-1][1]) for partner in partners] == [3, 2]
        assert np.array_equal(seen, env.kitchens.observe("lossless")[np.arange(5), 1 - seats])
        states = [env.kitchens.state(i) for i in range(5)]
        first = states[:3] if observation == "state" else env.kitchens.observe(observation)[np.arange(3), seats[:3]]
        second = env.kitchens.observe("features")[[3, 4], seats[3:]]
        seen, _, _, _ = env.step(np.full(5, NORTH))
        assert np.array_equal(partners[0].shown[-1], first)
        assert np.array_equal(partners[1].shown[-1], second)
    assert [layout for layout, *_ in partners[0].resets] == ["cramped_room"] * 3
    assert len({int(seed) for partner in partners for _, _, seeds in partner.resets for seed in seeds}) == 15


def test_the_learners_action_goes_to_the_learners_seat():
    partner = Answers(np.full(8, STAY))
    partner.reset = lambda layout, seats, seeds: setattr(partner, "seats", seats)
    env = make_env(8, partners=[partner], horizon=5)
    env.reset()
    met = set()
    for _ in range(10):
        before = [env.kitchens.state(i).chefs for i in range(8)]
        seats = partner.seats
        if env.step(np.full(8, 2))[2][0]:
            continue
        for i, seat in enumerate(seats):
            after = env.kitchens.state(i).chefs
            assert after[1 - seat].facing == "east"
            assert after[seat] == before[i][seat]
            met.add(int(seat))
    assert met == {0, 1}


@pytest.mark.parametrize("seat", [0, 1])
def test_a_fixed_seat_is_kept(seat):
    partner = Wanderer()
    env = make_env(6, partners=[partner], seat=seat, horizon=2)
    env.reset()
    play(env, 9)
    assert {int(s) for _, seats, _ in partner.resets for s in seats} == {1 - seat}


def test_a_random_seat_is_drawn_for_each_kitchen_and_episode():
    partner = Wanderer()
    env = make_env(40, partners=[partner], horizon=1)
    env.reset()
    play(env, 20)
    seats = np.array([seats for _, seats, _ in partner.resets])
    assert 0.4 < seats.mean() < 0.6
    assert all(0 < part.mean() < 1 for part in (*seats, *seats.T))


def test_partners_by_name():
    env = make_env(4, "asymmetric_advantages", partners=["greedy", "stay"], horizon=200)
    env.reset()
    soups = [info["episode_soup_reward"] for info in [env.step(np.full(4, STAY)) for _ in range(200)][-1][3]]
    assert min(soups[:2]) > 0
    assert soups[2:] == [0, 0]


@pytest.mark.parametrize("options", [SELF_PLAY, {"partners": ["random", "greedy"]}], ids=["self-play", "partners"])
def test_a_seed_fixes_everything_until_the_next_one(options):
    games, others = [], []
    for seed in (3, 3, 4):
        env = make_env(4, seed=seed, **options)
        first, more = env.reset(), play(env, 25)
        again, further = env.reset(), play(env, 25)
        games.append((np.concatenate([first, *more[0], again, *further[0]]), np.stack([more[1], further[1]])))
        others.append(not np.array_equal(first, again))
        env.seed(seed)
        assert np.array_equal(env.reset(), first)
        assert same_game(play(env, 25), more)
    assert all(np.array_equal(a, b) for a, b in zip(games[0], games[1], strict=True))
    assert not np.array_equal(games[0][0], games[2][0])
    assert all(others)


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_a_restored_environment_has_the_same_future(observation):
    options = {"self_play": True, "observation": observation, "object_probability": 0.5}
    env = make_env(2, shaping=0.5, **options)
    env.reset()
    play(env, 16)
    env.kitchens.set_state(1, KitchenState(SERVING_AND_FILLING.chefs, timestep=6))
    env.step(np.full(4, INTERACT))  # there is something to remember of this episode
    saved = env.snapshot()

    def future(env):
        soon, again = play(env, 15, seed=1), env.reset()
        later = play(env, 15, seed=2)
        told = [[info.get("episode", {}).get("r"), info.get("episode_soup_reward")] for i in soon[3] for info in i]
        return told, [again, *(array for game in (soon, later) for part in game[:3] for array in part)]

    told, arrays = future(env)
    assert [21.5, 20] in told
    other = make_env(2, seed=9, **options)
    for restored in (env, other, other):
        restored.restore(saved)
        again = future(restored)
        assert again[0] == told
        assert all(np.array_equal(a, b) for a, b in zip(again[1], arrays, strict=True))


def test_only_the_same_kitchens_can_be_restored():
    saved = make_env(2, self_play=True).snapshot()
    for other in (make_env(3, **SELF_PLAY), make_env(2, "counter_circuit", **SELF_PLAY)):
        with pytest.raises(ValueError, match="another layout, number of kitchens or history"):
            other.restore(saved)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"partners": []}, "at least one partner"),
        ({"partners": "greedy"}, r"give a list .* \['greedy'\]"),
        ({"partners": ["stay"] * 3}, "3 partners for 2 kitchens"),
        ({"partners": ["gredy"]}, "greedy"),
        ({"partners": [Answers(None)] * 2}, "is in the list twice"),
        ({"partners": [Wanderer("pixels")]}, "pixels"),
        ({"layout": TOMATO_KITCHEN, "observation": "features", "partners": [Wanderer("lossless")]}, "use 'lossless26'"),
        ({"layout": TOMATO_KITCHEN}, "use 'lossless26'"),
        ({"seat": 2}, "seat=2"),
        ({"observation": "pixels"}, "pixels"),
        ({"horizon": 0}, "horizon=0"),
        ({"num": 0, **SELF_PLAY}, "num_kitchens=0"),
        ({"layout": "cramped_rom"}, "cramped_room"),
    ],
)
def test_wrong_arguments_are_answered_with_the_right_ones(options, told):
    with pytest.raises(ValueError, match=told):
        make_env(**{"num": 2, **options})


@pytest.mark.parametrize(
    ("actions", "told"),
    [
        (np.full(3, STAY), r"whole numbers of the shape \(4,\)"),
        (np.full((4, 1), STAY), r"whole numbers of the shape \(4,\)"),
        (np.full(4, 4.0), "float64"),
        (np.array([4, 4, 4, 6]), "kitchen 1, chef 1: action 6"),
    ],
)
def test_a_wrong_action_changes_nothing(actions, told):
    env = make_env(2, self_play=True)
    env.reset()
    before = env.snapshot()
    with pytest.raises(ValueError, match=told):
        env.step(actions)
    assert all(np.array_equal(array, before[name]) for name, array in env.snapshot().items())


@pytest.mark.parametrize(("answer", "told"), [([4], r"shape \(1,\)"), ([4, 9], "action 9"), ([0.5, 1.0], "float64")])
def test_a_partners_wrong_answer_is_told(answer, told):
    env = make_env(2, partners=[Answers(np.array(answer))], seat=0)
    env.reset()
    with pytest.raises(ValueError, match=told):
        env.step(np.full(2, STAY))


def test_kitchens_that_do_not_end_together_are_told():
    env = make_env(2, self_play=True)
    env.reset()
    env.kitchens.set_state(1, KitchenState(SERVING_AND_FILLING.chefs, timestep=9))
    with pytest.raises(RuntimeError, match="start and end together"):
        env.step(np.full(4, STAY))


def test_attributes_and_methods_concern_all_rows():
    env = make_env(2, self_play=True)
    assert env.get_attr("kitchens") == [env.kitchens] * 4
    assert env.get_attr("kitchens", indices=[0, 3]) == [env.kitchens] * 2
    env.set_attr("note", "hello")
    assert env.note == "hello"
    assert env.env_method("set_shaping", 1.0) == [None] * 4
    env.reset()
    env.kitchens.set_state(0, SERVING_AND_FILLING)
    assert env.step(np.full(4, INTERACT))[1][:2].tolist() == [20, 23]
    for call in (lambda: env.set_attr("note", "", indices=[1]), lambda: env.env_method("close", indices=0)):
        with pytest.raises(ValueError, match="leave `indices` out"):
            call()
    with pytest.raises(AttributeError, match="nothing_of_the_kind"):
        env.get_attr("nothing_of_the_kind")
    assert env.env_is_wrapped(Monitor) == [True] * 4
    assert env.env_is_wrapped(type("Other", (Monitor,), {}), indices=0) == [False]
    env.close()


def test_every_kitchen_is_drawn():
    env = make_env(2, self_play=True)
    env.reset()
    first, second = env.get_images()
    assert first.dtype == np.uint8
    assert not np.array_equal(first, second)
    assert env.render("rgb_array").shape[:2] != first.shape[:2]


PPO_TINY = {"n_steps": 24, "batch_size": 24, "n_epochs": 1, "policy_kwargs": {"net_arch": [8]}, "device": "cpu"}
DQN_TINY = {"learning_starts": 32, "buffer_size": 200, "policy_kwargs": {"net_arch": [8]}, "device": "cpu"}
LEARNERS = {"ppo": (PPO, PPO_TINY, "action_net.weight"), "dqn": (DQN, DQN_TINY, "q_net.q_net.0.weight")}


@pytest.mark.parametrize("learner", LEARNERS)
@pytest.mark.parametrize("options", [SELF_PLAY, {"partners": ["greedy", "random"]}], ids=["self-play", "partners"])
@pytest.mark.parametrize("observation", ["features", "lossless"])
def test_stable_baselines_learns_and_evaluates(learner, options, observation):
    torch.set_num_threads(1)
    kind, settings, name = LEARNERS[learner]
    env = make_env(2, observation=observation, shaping=1.0, **options)
    model = kind("MlpPolicy", env, seed=0, **settings)
    assert model.get_env() is env
    before = model.policy.state_dict()[name].clone()
    model.learn(192)
    assert not before.equal(model.policy.state_dict()[name])
    assert len(model.ep_info_buffer) == model.num_timesteps // 10 // env.num_envs * env.num_envs
    mean, _ = evaluate_policy(model, env, n_eval_episodes=4)
    assert np.isfinite(mean)

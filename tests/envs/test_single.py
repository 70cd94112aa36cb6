import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.wrappers import RecordEpisodeStatistics

from overcooked_bench import Kitchens, Layout
from overcooked_bench.envs.registration import CUSTOM_ID, env_id
from overcooked_bench.envs.single import OvercookedEnv
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup
from tests.envs.players import TOMATO_KITCHEN, Answers, Wanderer

IDS = [(env_id(name), {}) for name in layout_names()]
CUSTOM = (CUSTOM_ID, {"layout": TOMATO_KITCHEN.replace("T", "X")})


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize(("name", "options"), [*IDS, CUSTOM], ids=lambda value: value if isinstance(value, str) else "")
def test_gymnasium_finds_no_fault(name, options, observation):
    check_env(gym.make(name, observation=observation, **options).unwrapped, skip_render_check=True)


@pytest.mark.parametrize(
    "options", [{"cooking": "manual"}, {"start": "standard"}, {"object_probability": 0.5}, {"seat": 1}]
)
def test_gymnasium_finds_no_fault_with_other_options(options):
    check_env(gym.make("Overcooked/CrampedRoom-v0", shaping=0.5, **options).unwrapped, skip_render_check=True)


SHAPES = {
    "lossless": (22, 4, 5),
    "lossless26": (26, 4, 5),
    "features": (96,),
    "stack_channels": (52, 4, 5),
    "stack_states": (4, 22, 4, 5),
}


@pytest.mark.parametrize("observation", SHAPES)
def test_spaces_are_those_of_the_contract(observation):
    space = gym.make("Overcooked/CrampedRoom-v0", observation=observation).observation_space
    assert space.shape == SHAPES[observation]
    assert space.dtype == (np.float32 if observation == "features" else np.uint8)
    assert np.isfinite(space.low).all()
    assert np.isfinite(space.high).all()
    if observation != "features":
        assert (space.low.max(), space.high.min(), space.high.max()) == (0, 20, 20)


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize("layout", layout_names())
def test_every_observation_of_a_busy_episode_is_in_the_space(layout, observation):
    env = OvercookedEnv(layout, partner=Wanderer(), observation=observation, object_probability=0.7, horizon=60)
    seen, _ = env.reset(seed=1)
    for action in np.random.default_rng(1).integers(0, 6, 60):
        assert seen in env.observation_space
        seen, *_ = env.step(action)
    assert seen in env.observation_space


def test_observations_are_the_kitchens_own():
    env = OvercookedEnv("coordination_ring", observation="stack_states", seat=1, partner=Wanderer())
    env.reset(seed=5)
    twin = Kitchens("coordination_ring", 1, history=3)
    twin.set_state(0, env.kitchens.state(0))
    for action in (0, 5, 2, 5, 3):
        seen, *_ = env.step(action)
        twin.step(env._joint)
        assert np.array_equal(seen, twin.observe("stack_states")[0, 1])


def test_an_episode_is_truncated_at_the_horizon_and_then_over():
    env = gym.make("Overcooked/CrampedRoom-v0", horizon=3)
    env.reset(seed=0)
    ends = [env.step(4)[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    with pytest.raises(ValueError, match=r"over after 3 steps; call reset\(\)"):
        env.step(4)
    env.reset()
    assert env.step(4)[3] is False


def test_the_same_seed_gives_the_same_game_and_the_next_episodes_differ():
    def play(env, seed):
        frames = []
        for episode in range(3):
            seen, info = env.reset(seed=seed if episode == 0 else None)
            frames += [seen, info]
            frames += [env.step(action) for action in (5, 0, 2, 1)]
        return frames

    def same(a, b):
        return repr(a) == repr(b)

    first, second = (OvercookedEnv("counter_circuit", partner=Wanderer()) for _ in range(2))
    game = play(first, 11)
    assert same(game, play(second, 11))
    assert same(game, play(first, 11))
    assert not same(game, play(first, 12))
    assert not same(game[:6], game[6:12])


def test_unseeded_environments_differ():
    states = {str(make.reset()[0]) for make in (OvercookedEnv("counter_circuit") for _ in range(8))}
    assert len(states) > 1


def test_a_random_seat_covers_both_and_a_given_one_stays():
    env = OvercookedEnv("cramped_room")
    env.reset(seed=0)
    seats = [env.reset()[1]["seat"] for _ in range(60)]
    assert 15 < sum(seats) < 45
    for seat in (0, 1):
        env = OvercookedEnv("cramped_room", seat=seat)
        assert {env.reset()[1]["seat"] for _ in range(10)} == {seat}


@pytest.mark.parametrize("observation", [*OBSERVATIONS, "state"])
def test_a_partner_is_shown_its_own_view_and_told_its_seat(observation):
    partner = Wanderer(observation)
    env = OvercookedEnv("cramped_room", partner=partner, horizon=2)
    for episode in range(4):
        _, info = env.reset(seed=3 if episode == 0 else None)
        layout, seats, seeds = partner.resets[-1]
        assert (layout, seats.tolist(), seeds.dtype) == ("cramped_room", [1 - info["seat"]], np.uint64)
        before = env.kitchens.state(0)
        expected = None if observation == "state" else env.kitchens.observe(observation)[0, 1 - info["seat"]]
        env.step(0)
        shown = partner.shown[-1]
        assert len(shown) == 1
        assert shown[0] == before if observation == "state" else np.array_equal(shown[0], expected)
    assert len({int(seeds[0]) for _, _, seeds in partner.resets}) == 4


def test_a_partner_moves_the_other_chef():
    env = OvercookedEnv("cramped_room", partner=Answers(np.array([3])), seat=0)
    env.reset(seed=0)
    env.step(2)
    assert [chef.facing for chef in env.kitchens.state(0).chefs] == ["east", "west"]


SERVING = KitchenState((Chef((3, 2), "south", Soup((3, 0), 20, 20)), Chef((1, 1), "west", "onion")), {})
FILLING = KitchenState((Chef((2, 1), "north", "onion"), Chef((1, 1), "west")), {})


@pytest.mark.parametrize(("seat", "partial"), [(0, 0.0), (1, 0.0)])
def test_a_delivery_rewards_the_team_whoever_delivers(seat, partial):
    env = OvercookedEnv("cramped_room", partner=Answers(np.array([5])), seat=seat, shaping=1.0)
    env.reset(seed=0)
    env.kitchens.set_state(0, SERVING)
    _, reward, _, _, info = env.step(5)
    assert (reward, info) == (20.0, {"soup_reward": 20.0, "partial_reward": partial, "seat": seat})
    assert type(reward) is float


@pytest.mark.parametrize("shaping", [0.0, 0.5, 1.0])
@pytest.mark.parametrize(("seat", "partial"), [(0, 3.0), (1, 0.0)])
def test_shaping_weighs_the_egos_own_partial_reward_alone(seat, partial, shaping):
    env = OvercookedEnv("cramped_room", partner=Answers(np.array([5])), seat=seat, shaping=shaping)
    env.reset(seed=0)
    env.kitchens.set_state(0, FILLING)
    _, reward, _, _, info = env.step(5)
    assert reward == shaping * partial
    assert info == {"soup_reward": 0.0, "partial_reward": partial, "seat": seat}


def test_gymnasium_records_the_statistics_of_an_episode():
    env = RecordEpisodeStatistics(gym.make("Overcooked/CrampedRoom-v0", horizon=5))
    _, info = env.reset(seed=0)
    for _ in range(5):
        assert "episode" not in info
        *_, info = env.step(4)
    assert info["episode"]["l"] == 5


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seat": 2}, r"seat=2; give 0, 1, or 'random'"),
        ({"observation": "pixels"}, "no observation named 'pixels'; choose one of blind,"),
        ({"cooking": "raw"}, "cooking"),
        ({"start": "here"}, "start='here'; give 'random' or 'standard'"),
        ({"horizon": 0}, "horizon=0; give a whole number of steps from 1"),
        ({"object_probability": 2}, "object_probability=2; give a probability"),
        ({"render_mode": "video"}, "render_mode='video'; give 'rgb_array', 'ansi' or None"),
        ({"render_mode": "human"}, "gymnasium.make"),
        ({"layout": "crampd_room"}, "did you mean 'cramped_room'"),
        (
            {"partner": Wanderer("pixels")},
            "partner Wanderer.*observation is 'pixels'; choose one of blind",
        ),
        ({"layout": TOMATO_KITCHEN}, "'lossless' has no tomato channels.*use 'lossless26'"),
        (
            {"layout": TOMATO_KITCHEN, "observation": "lossless26", "partner": Wanderer("lossless")},
            "'lossless' has no tomato channels",
        ),
    ],
)
def test_wrong_options_are_refused_with_what_to_write_instead(options, message):
    with pytest.raises(ValueError, match=message):
        OvercookedEnv(**{"layout": "cramped_room", **options})


def test_a_partner_that_is_no_agent_is_refused():
    with pytest.raises(TypeError, match="give a catalogue name, the path of a submission, or an object with"):
        OvercookedEnv("cramped_room", partner=4)


def test_a_layout_object_keeps_its_menu():
    layout = Layout.from_text(TOMATO_KITCHEN, orders=[["tomato", "onion", "tomato"]])
    assert OvercookedEnv(layout, observation="lossless26").kitchens.layout is layout


def test_a_step_before_the_first_reset_is_refused():
    with pytest.raises(gym.error.ResetNeeded, match=r"call reset\(\)"):
        OvercookedEnv("cramped_room").step(0)


@pytest.mark.parametrize(
    ("action", "error"),
    [(6, ValueError), (-1, ValueError), (1.0, TypeError), ("north", TypeError), (np.array([1]), TypeError)],
)
def test_actions_that_are_none_are_refused(action, error):
    env = OvercookedEnv("cramped_room")
    env.reset(seed=0)
    before = env.kitchens.state(0)
    with pytest.raises(error, match="action"):
        env.step(action)
    assert env.kitchens.state(0) == before


@pytest.mark.parametrize("action", [3, np.int64(3), np.uint8(3), np.array(3)])
def test_any_whole_number_is_an_action(action):
    env = OvercookedEnv("cramped_room", seat=0)
    env.reset(seed=0)
    env.step(action)
    assert env.kitchens.state(0).chefs[0].facing == "west"


@pytest.mark.parametrize("answer", [5, [4, 4], [4.0], [[4]], ["north"]])
def test_a_partners_wrong_answer_names_the_partner(answer):
    env = OvercookedEnv("cramped_room", partner=Answers(answer))
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"^partner Answers, step 0: act returned .* return 1 whole numbers"):
        env.step(4)

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from overcooked_bench.agents import Agent, UnknownLayout, one_game_at_a_time, sample_actions, uniforms
from overcooked_bench.agents.agent import GameError
from overcooked_bench.agents.draws import ActionSampler

SEEDS = hnp.arrays(np.uint64, st.integers(1, 20))


@st.composite
def draws(draw):
    seeds = draw(SEEDS)
    weights = draw(hnp.arrays(np.float64, (len(seeds), 6), elements=st.sampled_from([0.0, 1e-9, 0.1, 1.0, 7.0])))
    weights[:, draw(st.integers(0, 5))] += 0.5
    return weights / weights.sum(axis=1, keepdims=True), seeds, draw(st.integers(0, 2**40))


@settings(deadline=None)
@given(draws(), st.randoms())
def test_a_rows_draw_depends_on_its_own_seed_probabilities_and_step_alone(drawn, random):
    probabilities, seeds, step = drawn
    together = sample_actions(probabilities, seeds, step)
    order = list(range(len(seeds)))
    random.shuffle(order)
    assert (sample_actions(probabilities[order], seeds[order], step) == together[order]).all()
    for i in range(len(seeds)):
        assert sample_actions(probabilities[i : i + 1], seeds[i : i + 1], step)[0] == together[i]


@settings(deadline=None)
@given(draws(), st.integers(1, 200))
def test_a_sampler_draws_step_by_step_what_is_drawn_one_by_one(drawn, steps):
    probabilities, seeds, _ = drawn
    sampler = ActionSampler(seeds)
    for step in range(steps):
        assert (sampler.draw(probabilities) == sample_actions(probabilities, seeds, step)).all()


@pytest.mark.parametrize("rows", [1, 1500, 100_000])
def test_a_sampler_of_many_rows_looks_less_far_ahead(rows):
    seeds = np.arange(rows, dtype=np.uint64)
    probabilities = np.full((rows, 6), 1 / 6)
    sampler = ActionSampler(seeds)
    for step in range(3):
        assert (sampler.draw(probabilities) == sample_actions(probabilities, seeds, step)).all()


@settings(deadline=None)
@given(draws())
def test_only_actions_of_positive_probability_are_drawn(drawn):
    probabilities, seeds, step = drawn
    actions = sample_actions(probabilities, seeds, step)
    assert actions.dtype == np.int64
    assert (probabilities[np.arange(len(seeds)), actions] > 0).all()


@settings(deadline=None)
@given(SEEDS, st.integers(0, 2**62))
def test_uniforms_lie_in_the_unit_interval(seeds, step):
    numbers = uniforms(seeds, step)
    assert ((numbers >= 0) & (numbers < 1)).all()


def test_a_sum_below_one_ends_in_the_last_possible_action():
    seeds = np.arange(200_000, dtype=np.uint64)
    short = np.tile([0.0, 0.5, 0.4995, 0.0, 0.0, 0.0], (len(seeds), 1))
    assert (uniforms(seeds, 0) > 0.9995).any()
    assert set(sample_actions(short, seeds, 0).tolist()) == {1, 2}


def test_frequencies_match_the_probabilities_over_rows_and_over_steps():
    probabilities = np.array([0.05, 0.3, 0.0, 0.15, 0.4, 0.1])
    seeds = np.arange(50_000, dtype=np.uint64)
    over_rows = sample_actions(np.tile(probabilities, (len(seeds), 1)), seeds, 7)
    over_steps = np.concatenate([sample_actions(probabilities[None], seeds[:1], step) for step in range(5_000)])
    for drawn in (over_rows, over_steps):
        error = np.sqrt(probabilities * (1 - probabilities) / len(drawn))
        assert (np.abs(np.bincount(drawn, minlength=6) / len(drawn) - probabilities) <= 4.5 * error).all()


def test_neighbouring_seeds_and_steps_are_uncorrelated():
    seeds = np.arange(20_000, dtype=np.uint64)
    table = np.stack([uniforms(seeds, step) for step in range(3)])
    correlations = [np.corrcoef(table[0], table[1])[0, 1], np.corrcoef(table[0, :-1], table[0, 1:])[0, 1]]
    correlations.append(np.corrcoef(table[1, :-1], table[0, 1:])[0, 1])
    assert max(map(abs, correlations)) < 0.03


@pytest.mark.parametrize(
    ("probabilities", "message"),
    [
        (np.full((2, 5), 0.2), r"shape \(2, 5\)"),
        (np.full((3, 6), 1 / 6), r"2 seeds need \(2, 6\)"),
        (np.array([[1 / 6] * 6, [1.5, -0.5, 0, 0, 0, 0]]), "row 1"),
        (np.array([[np.nan] + [0.2] * 5, [1 / 6] * 6]), "row 0"),
        (np.array([[1 / 6] * 6, [1.0] * 6]), "row 1.*sum to 1"),
    ],
)
def test_what_is_no_distribution_is_refused(probabilities, message):
    with pytest.raises(ValueError, match=message):
        sample_actions(probabilities, np.zeros(2, np.uint64), 0)


class Counts:
    observation = "features"

    def __init__(self):
        self.given = []

    def reset(self, layout, seat, seed):
        self.given = [layout, seat, seed]

    def act(self, observation):
        self.given.append(observation)
        return (self.given[2] + len(self.given)) % 6


def test_one_game_at_a_time_gives_each_row_its_own_player():
    players = []

    def make():
        players.append(Counts())
        return players[-1]

    agent = one_game_at_a_time(make, observation="lossless26")
    assert isinstance(agent, Agent)
    assert agent.observation == "lossless26"
    agent.reset("cramped_room", np.array([0, 1]), np.array([3, 2**64 - 1], np.uint64))
    assert agent.act(np.array([[10], [20]])).tolist() == [(3 + 4) % 6, (2**64 - 1 + 4) % 6]
    assert agent.act(["a", "b"]).tolist() == [(3 + 5) % 6, (2**64 - 1 + 5) % 6]
    assert players[-2].given == ["cramped_room", 0, 3, 10, "a"]
    assert players[-1].given == ["cramped_room", 1, 2**64 - 1, 20, "b"]
    agent.reset("cramped_room", np.array([0]), np.zeros(1, np.uint64))
    assert players[-1].given == ["cramped_room", 0, 0]


def test_one_game_at_a_time_finds_what_is_observed():
    assert one_game_at_a_time(Counts).observation == "features"
    assert one_game_at_a_time(lambda: Counts()).observation == "features"
    with pytest.raises(ValueError, match="observation='lossless26'"):
        one_game_at_a_time(lambda: type("Blind", (), {"act": lambda self, seen: 4})())


def test_one_game_at_a_time_says_what_is_wrong():
    with pytest.raises(TypeError, match="give a class or function"):
        one_game_at_a_time(Counts())
    with pytest.raises(TypeError, match="method act"):
        one_game_at_a_time(dict)
    agent = one_game_at_a_time(type("Floats", (), {"act": lambda self, seen: 2.0}), observation="features")
    agent.reset("cramped_room", np.zeros(2, int), np.zeros(2, np.uint64))
    with pytest.raises(GameError, match=r"row 0: Floats's act returned 2\.0"):
        agent.act(np.zeros((2, 96)))
    with pytest.raises(ValueError, match="3 observations for the 2 games"):
        agent.act(np.zeros((3, 96)))


@pytest.mark.parametrize("error", [KeyError("salt"), SystemExit(0)])
def test_one_game_at_a_time_names_the_row_that_fails(error):
    class Fails:
        def reset(self, layout, seat, seed):
            self.seat = seat
            if seed == 1:
                raise error

        def act(self, seen):
            if self.seat:
                raise error
            return 4

    agent = one_game_at_a_time(Fails, observation="features")
    agent.reset("cramped_room", np.array([0, 0, 1]), np.zeros(3, np.uint64))
    with pytest.raises(GameError, match=f"row 2: Fails's act raised {type(error).__name__}") as fault:
        agent.act(np.zeros((3, 96)))
    assert fault.value.row == 2
    with pytest.raises(GameError, match="row 1: Fails's reset raised") as fault:
        agent.reset("cramped_room", np.zeros(2, int), np.array([0, 1], np.uint64))
    assert fault.value.row == 1


def test_an_unknown_layout_is_a_value_error():
    assert issubclass(UnknownLayout, ValueError)

import json

import pytest

from overcooked_bench.agents.policy import load_policy
from overcooked_bench.baselines.learning.parts import half_trained
from overcooked_bench.baselines.learning.run import RESTARTS
from overcooked_bench.baselines.learning.seeds import part_of, restarted
from overcooked_bench.baselines.self_play import train
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.baselines.learning.test_checkpoint import press_ctrl_c
from tests.baselines.tiny import SEED, STEPS, UPDATE, tiny

HOPELESS = {"check_share": 0.5, "check_soups": 30.0, "restarts": 2}


@pytest.fixture(scope="module")
def given_up(tmp_path_factory):
    """A run that the divergence check gives up until no restart is left."""
    folder = tmp_path_factory.mktemp("given-up")
    return folder, train(tiny(**HOPELESS), folder, SEED)


def test_a_run_that_does_not_deliver_begins_anew_with_a_derived_seed(given_up):
    folder, outcome = given_up
    assert outcome.restarts == 2
    assert outcome.steps == STEPS  # the last attempt goes on whatever the check says
    attempts = json.loads((folder / RESTARTS).read_text())
    assert [attempt["seed"] for attempt in attempts] == [SEED, restarted(SEED, 1)]
    assert all(STEPS / 2 <= attempt["joint_steps"] < STEPS / 2 + UPDATE for attempt in attempts)
    assert all(0 <= attempt["soups"] < 30 for attempt in attempts)
    assert len({SEED, restarted(SEED, 1), restarted(SEED, 2), part_of(SEED, "1")}) == 4
    assert json.loads((folder / "config.json").read_text())["training_seed"] == SEED


def test_the_last_attempt_is_a_run_of_its_seed(given_up, tmp_path):
    plain = train(tiny(), tmp_path, restarted(SEED, 2))
    assert plain.files.weights.read_bytes() == given_up[1].files.weights.read_bytes()


def test_an_interrupted_run_counts_its_restarts_and_comes_to_the_same_end(given_up, tmp_path, monkeypatch):
    outcome, goes = None, 0
    while outcome is None:
        with monkeypatch.context() as patch:
            press_ctrl_c(patch, OvercookedVecEnv, "step_wait", 20)
            outcome = train(tiny(**HOPELESS), tmp_path, SEED, resume=goes > 0)
        goes += 1
    assert goes > 2
    assert outcome.restarts == 2
    assert outcome.files.weights.read_bytes() == given_up[1].files.weights.read_bytes()


def test_a_run_that_delivers_enough_is_left_alone(tmp_path):
    outcome = train(tiny(check_share=0.5, check_soups=0.0), tmp_path, SEED)
    assert outcome.restarts == 0
    assert not (tmp_path / RESTARTS).exists()


def test_policies_saved_on_the_way(tmp_path, whole_run):
    shares = (0.0, 0.4, 0.9)
    outcome = train(tiny(snapshots=shares), tmp_path, SEED)
    assert tuple(outcome.snapshots) == shares
    hashes = [load_policy(files.weights).sha256 for files in outcome.snapshots.values()]
    assert len({*hashes, load_policy(outcome.files.weights).sha256}) == 3  # no rollout begins after the last share
    assert outcome.files.weights.read_bytes() == whole_run[1].files.weights.read_bytes()
    share, files = half_trained(outcome, tiny(), episodes=2)
    assert share in shares
    assert files == outcome.snapshots[share]


def test_a_finished_run_is_not_trained_again(tmp_path, monkeypatch):
    outcome = train(tiny(), tmp_path, SEED)
    monkeypatch.setattr("overcooked_bench.baselines.learning.learner.Learner.learn", lambda *_: pytest.fail("trained"))
    again = train(tiny(), tmp_path, SEED, resume=True)
    assert again.files == outcome.files
    assert again.returns.tolist() == outcome.returns.tolist()
    assert (again.steps, again.restarts) == (outcome.steps, 0)


def soups_by_episode(monkeypatch, soups):
    """Lets every kitchen report these soups, one number an episode, and nothing afterwards."""
    left, finish = list(soups), OvercookedVecEnv._finish

    def told(env, dones):
        points = 20.0 * (left.pop(0) if left else 0)
        return [{**info, "episode_soup_reward": points} for info in finish(env, dones)]

    monkeypatch.setattr(OvercookedVecEnv, "_finish", told)


@pytest.mark.parametrize("stopped_in", [3, 4])
def test_the_check_of_a_run_that_goes_on_is_that_of_an_uninterrupted_one(stopped_in, tmp_path, monkeypatch):
    episode = UPDATE // 4
    config = tiny(steps=6 * UPDATE, horizon=episode, check_share=0.5, check_soups=3.0)
    soups_by_episode(monkeypatch, [5, 5, 0])  # 3.3 on average at the check, and less ever after
    with monkeypatch.context() as patch:
        press_ctrl_c(patch, OvercookedVecEnv, "step_wait", (stopped_in - 1) * episode + 5)
        assert train(config, tmp_path, SEED) is None
    assert train(config, tmp_path, SEED, resume=True).restarts == 0

"""Human proxies: trained from a games file, both stages, resumed, and refused where the games do not fit."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.numpy import load_file

from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines import human_proxy
from overcooked_bench.baselines.cloning.bootstrap import bootstrap
from overcooked_bench.baselines.cloning.clone import nats_per_step
from overcooked_bench.baselines.cloning.examples import examples
from overcooked_bench.baselines.cloning.lesson import Lesson
from overcooked_bench.baselines.cloning.likelihood import foretell, frequencies, last_action, uniform
from overcooked_bench.baselines.learning.algorithms import make_learner
from overcooked_bench.baselines.learning.settings import SettingsError
from overcooked_bench.baselines.running.place import Place
from overcooked_bench.baselines.running.run import make_env
from overcooked_bench.errors import WrongUse
from overcooked_bench.human.games import read_games
from tests.baselines.tiny import MADE

SMALL = {"num_kitchens": 4, "rollout": 50, "horizon": 50, "minibatches": 4, "epochs": 1, "steps": 400}
CLONING = {"clone_epochs": 3, "clone_patience": 3, "hidden": (16,)}


@pytest.fixture
def games():
    """Games of six pairs who walk in circles: what they do next follows from where they are."""
    return MADE


def config(games, **more):
    return human_proxy.Config(layout="cramped_room", games=str(games), **{**SMALL, **CLONING, **more})


@pytest.mark.parametrize("observation", ["features", "lossless"])
def test_both_stages_are_kept_and_foretell_more_than_frequencies(games, tmp_path, observation):
    settings = config(games, observation=observation, clone_epochs=30)
    outcome = human_proxy.train(settings, Place(tmp_path, 1))
    record = json.loads((tmp_path / "config.json").read_text())
    assert not set(record["drawn"]) & set(record["held_out"])
    assert len(record["games_sha256"]) == 64
    rows = human_proxy.people_of(settings)
    drawn, held_out = rows.of(record["drawn"]), rows.of(record["held_out"])
    clone, regularised = load_policy(outcome.snapshots[0.0].files.weights), load_policy(outcome.files.weights)
    assert clone.sha256 != regularised.sha256
    assert foretell(clone, held_out).nats == pytest.approx(record["clone_nats"], abs=2e-3)
    assert foretell(clone, held_out).nats < frequencies(drawn, held_out).nats < uniform(held_out).nats
    assert outcome.snapshots[0.0].steps < outcome.steps == outcome.snapshots[0.0].steps + 400


def test_the_clone_alone_and_with_other_clones(games, tmp_path):
    alone = human_proxy.train(config(games, stage="clone"), Place(tmp_path / "alone", 1))
    assert alone.files == alone.snapshots[0.0].files
    others = human_proxy.train(config(games, partners="clones", agents=2, per_episode=2), Place(tmp_path / "others", 1))
    assert len(others.with_partners) == 200
    ours = (others.snapshots[0.0].files, alone.files)
    weights = [load_file(files.weights) for files in ours]
    assert all(np.array_equal(weights[0][name], weights[1][name]) for name in weights[0])
    samples = [json.loads((tmp_path / "others" / f"partner-{k}" / "clone.json").read_text())["drawn"] for k in range(2)]
    assert samples[0] != samples[1]


def test_a_finished_run_is_read_back_and_other_games_are_refused(games, tmp_path):
    settings = config(games)
    first = human_proxy.train(settings, Place(tmp_path / "run", 3))
    again = human_proxy.train(settings, Place(tmp_path / "run", 3, resume=True))
    assert (first.files, first.steps, first.returns.tolist()) == (again.files, again.steps, again.returns.tolist())
    other = tmp_path / "other.games.jsonl"
    other.write_bytes(Path(games).read_bytes() * 2)
    with pytest.raises(WrongUse, match="games"):
        human_proxy.train(config(other), Place(tmp_path / "run", 3, resume=True))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"coefficient": -1.0}, "coefficient=-1.0"),
        ({"lesson_batch": 0}, "lesson_batch=0"),
        ({"clone_learning_rate": 0.0}, "clone_learning_rate"),
        ({"agents": 0}, "agents=0"),
        ({"snapshots": (0.5,)}, "leave them out"),
        ({"pairs": "17"}, "is no pair"),
    ],
)
def test_wrong_settings(games, wrong, message):
    with pytest.raises(WrongUse, match=message):
        config(games, **wrong)


def test_people_who_did_not_play_here(games, tmp_path):
    with pytest.raises(WrongUse, match="no game of"):
        human_proxy.train(config(games, pairs="B"), Place(tmp_path, 0))
    settings = human_proxy.Config(layout="coordination_ring", games=str(games), **SMALL, **CLONING)
    with pytest.raises(WrongUse, match="no game of the pairs A on 'coordination_ring'"):
        human_proxy.train(settings, Place(tmp_path, 0))
    with pytest.raises(WrongUse, match="games of 2 pairs"):
        human_proxy.train(config(games, pairs="0,2"), Place(tmp_path, 0))


def test_a_bootstrap_draws_pairs_and_leaves_some_out():
    pairs = [f"2019-{pair:02d}" for pair in range(5)]
    samples = [bootstrap(pairs, seed) for seed in range(200)]
    assert samples[0] == bootstrap(list(reversed(pairs)), 0)
    for sample in samples:
        assert len(sample.drawn) == 5
        assert len(sample.held_out) >= 2
        assert set(sample.drawn) | set(sample.held_out) == set(pairs)
        assert not set(sample.drawn) & set(sample.held_out)
    assert len({sample.drawn for sample in samples}) > 20


def test_rows_are_what_each_chef_saw_and_did(games):
    settings = config(games)
    rows = human_proxy.people_of(settings)
    assert (len(rows), rows.firsts.sum(), len(rows.people)) == (6 * 120 * 2, 12, 6)
    twice = rows.of(["2019-02", "2019-02", "2019-04"])
    assert (len(twice), twice.people) == (3 * 240, ("2019-02", "2019-04"))
    assert rows.actions[rows.firsts].tolist()[1::2] != [4] * 6


def test_returns_are_discounted_points():
    games = read_games(Path(__file__).parents[1] / "data" / "upgrades" / "games-1" / "some.games.jsonl")
    game = next(game for game in games if game.soups and game.kitchen.soup_points)
    rows = examples([game], game.layout, "lossless", 0.5)
    delivered, _ = game.soups[-1]
    ahead = rows.returns[: game.steps].tolist()
    assert ahead[delivered - 1] == pytest.approx(ahead[delivered] / 2)
    assert ahead[delivered] == game.kitchen.soup_points
    assert not any(ahead[delivered + 1 :])


def test_last_actions_foretell_repeated_ones(games):
    rows = human_proxy.people_of(config(games))
    assert uniform(rows).nats == pytest.approx(np.log(6))
    assert last_action(rows, rows).nats < frequencies(rows, rows).nats


def test_the_lesson_is_zero_for_the_clone_and_grows_with_the_distance(games):
    settings = config(games)
    rows = human_proxy.people_of(settings)
    model, other = (make_learner(settings, make_env(settings, self_play=True), seed) for seed in (0, 1))
    lesson = Lesson(model.policy, rows, 2.0, 64)
    assert lesson(model.policy).item() == pytest.approx(0, abs=1e-6)
    assert lesson(other.policy).item() > 0
    logs = torch.log_softmax(torch.zeros(len(rows), 6), 1)
    assert nats_per_step(logs, rows) == pytest.approx(np.log(6))


def test_settings_say_whose_play_it_is(games):
    assert config(games).people == tuple(f"2019-{pair:02d}" for pair in range(0, 17, 2))
    assert (config(games).learning_seats, config(games, partners="clones").learning_seats) == (2, 1)
    with pytest.raises(SettingsError):
        config(games, partners="clones", per_episode=4)

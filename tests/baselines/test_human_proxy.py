"""Human proxies: trained from a games file, both stages, resumed, and refused where the games do not fit."""

import json
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import torch
from safetensors.numpy import load_file

from overcooked_bench.agents.mirror import mirror_actions, mirror_state
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines import human_proxy
from overcooked_bench.baselines.cloning import stage
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
from overcooked_bench.human.game import Player
from overcooked_bench.human.games import read_games, record, write_games
from tests.baselines.tiny import MADE

SMALL = {"num_kitchens": 4, "rollout": 50, "horizon": 50, "minibatches": 4, "epochs": 1, "steps": 400}
SYMMETRIC = "XXPXX\nO1 2O\nX   X\nXDSDX"
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


def test_with_others_that_learned_alone_first(games, tmp_path):
    settings = config(games, partners="others", agents=2, alone_steps=400)
    outcome = human_proxy.train(settings, Place(tmp_path, 1))
    clone, (alone, *others) = outcome.snapshots[0.0].files, outcome.parts
    assert clone.weights.parent == tmp_path / "alone" / "clone"
    assert len({files.weights.read_bytes() for files in (clone, alone.files, outcome.files)}) == 3
    assert [part.files.weights.parent.name for part in others] == ["other-0", "other-1"]
    assert outcome.total_steps == outcome.steps + sum(part.steps for part in outcome.parts)
    record = json.loads((tmp_path / "config.json").read_text())
    held_out = human_proxy.people_of(settings).of(record["held_out"])
    assert foretell(load_policy(clone.weights), held_out).nats == pytest.approx(record["clone_nats"], abs=2e-3)
    again = human_proxy.train(settings, Place(tmp_path, 1, resume=True))
    assert again.with_partners.tolist() == outcome.with_partners.tolist()


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
        ({"partners": "clones", "agents": 2}, "per_episode=3; draw at most the 2 other clones"),
        ({"snapshots": (0.5,)}, "leave them out"),
        ({"pairs": "17"}, "is no pair"),
    ],
)
def test_wrong_settings(games, wrong, message):
    with pytest.raises(WrongUse, match=message):
        config(games, **wrong)


def test_a_clone_that_was_killed_before_its_last_file_is_trained_again(games, tmp_path, monkeypatch):
    settings = config(games, stage="clone")
    whole = human_proxy.train(settings, Place(tmp_path / "whole", 1))
    with monkeypatch.context() as patch:
        patch.setattr(stage, "write_record", lambda *_: pytest.fail("killed"))
        with pytest.raises(pytest.fail.Exception, match="killed"):
            human_proxy.train(settings, Place(tmp_path / "run", 1))
    (tmp_path / "run" / "clone" / "policy.safetensors").write_bytes(b"half of it")
    again = human_proxy.train(settings, Place(tmp_path / "run", 1, resume=True))
    assert again.files.weights.read_bytes() == whole.files.weights.read_bytes()


@pytest.mark.parametrize(
    ("change", "others", "message"),
    [
        ({}, {"pairs": "0,2,4,6"}, "a clone of 2019-.*, not of 2019-"),
        ({}, {"hidden": (8,)}, "of another network .*; choose another --output"),
        ({"learner.safetensors": b"not weights"}, {}, "learner.safetensors: missing, damaged, or"),
        ({"policy.safetensors": b"not weights"}, {}, "policy.safetensors: not a safetensors file"),
    ],
    ids=["people", "network", "learner", "policy"],
)
def test_a_finished_clone_that_does_not_fit_is_refused(games, tmp_path, change, others, message):
    """The run was killed before it wrote its own configuration."""
    human_proxy.train(config(games, stage="clone"), Place(tmp_path, 1))
    (tmp_path / "config.json").unlink()
    for name, content in change.items():
        (tmp_path / "clone" / name).write_bytes(content)
    with pytest.raises(WrongUse, match=message):
        human_proxy.train(config(games, **others), Place(tmp_path, 1, resume=True))


def test_people_who_did_not_play_here(games, tmp_path):
    with pytest.raises(WrongUse, match="no game of"):
        human_proxy.train(config(games, pairs="B"), Place(tmp_path, 0))
    settings = human_proxy.Config(layout="coordination_ring", games=str(games), **SMALL, **CLONING)
    with pytest.raises(WrongUse, match="no game of the pairs A on 'coordination_ring'; they played 'cramped_room'"):
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


def symmetric_games(steps=60):
    """Games of three pairs on a grid that is its own mirror image, and the mirror images of these games."""
    rng = np.random.default_rng(5)
    people = Player("human", "one"), Player("human", "another")
    some = []
    for pair in range(3):
        about = {"seats": people, "source": "made for tests", "group": f"ours-{pair}"}
        actions = rng.integers(6, size=(steps, 2))
        game = record(SYMMETRIC, actions, **about)
        start = mirror_state(game.first_state(), 5)
        some.append((game, record(SYMMETRIC, mirror_actions(actions), start=start, **about)))
    return [list(each) for each in zip(*some, strict=True)]


@pytest.mark.parametrize("observation", ["lossless", "stack_channels", "stack_states"])
def test_games_on_a_symmetric_layout_count_mirrored(observation):
    plain, mirrored = (examples(each, SYMMETRIC, observation, 0.9) for each in symmetric_games())
    assert len(plain) == 3 * 2 * 2 * 60

    def views(rows):
        parts = rows.seen.view(3, 2, 120, -1), rows.actions.view(3, 2, 120), rows.returns.view(3, 2, 120)
        return [[part[:, k] for part in parts] for k in range(2)]

    as_played, as_mirrored = views(plain)
    assert not as_played[0].equal(as_mirrored[0])
    for ours, theirs in zip(views(mirrored), (as_mirrored, as_played), strict=True):
        assert all(mine.equal(other) for mine, other in zip(ours, theirs, strict=True))


def test_features_do_not_count_mirrored():
    assert len(examples(symmetric_games()[0], SYMMETRIC, "features", 0.9)) == 3 * 2 * 60


def test_stacked_rows_are_the_rows_of_the_steps_before(games):
    some = [msgspec.structs.replace(game, horizon=game.steps + 7 * k) for k, game in enumerate(read_games(games))]
    now, stacked = (examples(some, "cramped_room", name, 0.9).seen for name in ("lossless", "stack_states"))
    rows, before = stacked.view(12, 120, 4, -1), now.view(12, 120, -1)
    for age in range(4):
        earlier = [max(step - age, 0) for step in range(120)]
        assert rows[:, :, age].equal(before[:, earlier])


def test_proxies_of_people_on_a_grid_of_ones_own(tmp_path):
    plain, _ = symmetric_games()
    write_games(tmp_path / "ours.games.jsonl", plain)
    settings = replace(
        config(tmp_path / "ours.games.jsonl", pairs="ours-0,ours-1,ours-2", observation="stack_states"),
        layout=SYMMETRIC + "\n",
        **{"network": "cnn", "filters": 2, "previous": 2},
    )
    outcome = human_proxy.train(settings, Place(tmp_path / "run", 1))
    assert load_policy(outcome.files.weights).architecture.layout == SYMMETRIC
    resolved = json.loads((tmp_path / "run" / "config.json").read_text())
    assert resolved["people"] == ["ours-0", "ours-1", "ours-2"]


def test_what_an_agent_did_is_not_cloned(games):
    game = read_games(games)[0]
    mixed = msgspec.structs.replace(game, seats=(Player("agent", "greedy"), Player("human", "one")))
    both, one = (examples([each], "cramped_room", "lossless", 0.9) for each in (game, mixed))
    assert one.seen.equal(both.seen[game.steps :])
    assert one.actions.equal(both.actions[game.steps :])


@pytest.mark.skipif(not torch.cuda.is_available(), reason="torch finds no GPU")
def test_both_stages_on_a_gpu(games, tmp_path):
    outcome = human_proxy.train(config(games, device="cuda"), Place(tmp_path, 1))
    assert load_policy(outcome.files.weights).weights


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

import numpy as np
import pytest

from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines import with_people
from overcooked_bench.baselines.with_people import agents_of, main, play_study
from overcooked_bench.baselines.with_people_tables import ENTRANTS, Games, answer, difference, report
from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import welch_interval
from overcooked_bench.evaluation.score import score
from tests.baselines.studied import protocols, write_study

LAYOUTS = "cramped_room", "counter_circuit"


def games(*means):
    """Two layouts, two kinds of starts, 3, 4, 3 and 1 runs with two partners; means by entrant."""
    rng = np.random.default_rng(0)
    sizes = dict(zip(ENTRANTS, (3, 4, 3, 1), strict=True))
    returns = {
        (start, layout, entrant): rng.normal(mean, 5, (sizes[entrant], 2, 6, 2))
        for start in ("random", "standard")
        for layout in LAYOUTS
        for entrant, mean in zip(ENTRANTS, means, strict=True)
    }
    return Games(returns, {layout: ["clone-0", "regularised-0"] for layout in LAYOUTS})


@pytest.mark.parametrize(
    ("means", "said"),
    [
        ((100, 50, 70, 90), "The finding of Carroll et al. 2019 holds here"),
        ((50, 100, 70, 90), "The opposite of what"),
        ((50, 50, 70, 90), "This study does not decide"),
    ],
)
def test_the_interval_of_one_difference_decides(means, said):
    told = report(games(*means))
    assert told.startswith(said)
    assert "with people 3, self-play 4, with a population 3" in told


def test_what_varies_is_a_training_run():
    one = games(100, 50, 70, 90)
    people, own = (one.values("cramped_room", entrant) for entrant in ENTRANTS[:2])
    assert (people.shape, own.shape, one.values("cramped_room", "greedy").shape) == ((3,), (4,), (6,))
    assert difference(one, ["cramped_room"]) == welch_interval(people, own)
    both = np.mean([one.values("cramped_room", ENTRANTS[0], start) for start in ("random", "standard")], axis=0)
    assert both == pytest.approx(people)
    assert "points per episode more" in answer(one)


def test_every_run_plays_with_every_partner_that_counts(tmp_path, monkeypatch):
    study = Pool.load(write_study(tmp_path / "study"))
    monkeypatch.setattr(with_people, "agents_of", lambda *where: list(agents_of(*where))[2:6])
    found = play_study(study, protocols())
    assert found.starts == ["random", "standard"]
    floors = {"random", "stay"}
    expected = [entry.name for entry in Pool.load("dev-v0").partners("cramped_room") if entry.name not in floors]
    assert found.partners == {"cramped_room": expected}
    sizes = {entrant: found.of("cramped_room", entrant).shape for entrant in ("with a population", "self-play")}
    assert set(sizes.values()) == {(2, len(expected), 2, 2)}
    in_order = with_people.map_tasks
    monkeypatch.setattr(with_people, "map_tasks", lambda *given: reversed(list(in_order(*given))))
    again = play_study(study, protocols())
    for entrant in sizes:
        assert np.array_equal(again.of("cramped_room", entrant), found.of("cramped_room", entrant))


def test_the_games_begin_as_those_of_a_score(tmp_path, monkeypatch):
    """An agent that acts by the state alone, with partners of one policy: the same episodes, to the point."""
    rules = protocols(horizon=100, mode="sample")[0]
    monkeypatch.setattr(NeuralAgent, "act", lambda self, views: np.full(len(views), 5))
    monkeypatch.setattr(with_people, "agents_of", lambda *where: [("greedy", "greedy")])
    study = Pool.load(write_study(tmp_path / "study"))
    ours = play_study(study, [rules]).of("cramped_room", "greedy").mean()
    scored = score("greedy", rules, output=tmp_path / "score", scenarios=False).scores
    assert scored.find("mean", layout="cramped_room").value == pytest.approx(ours)


def test_mistakes_end_in_one_message(tmp_path, capsys, monkeypatch):
    assert main([str(tmp_path / "none")]) == 2
    assert "no pool named" in capsys.readouterr().err
    study = Pool.load(write_study(tmp_path / "study"))
    with pytest.raises(WrongUse, match=r"no agents with-people-\* on counter_circuit"):
        list(agents_of(study, "counter_circuit"))

"""The whole page, from made-up episodes of small pools: nothing is played."""

import json

import numpy as np
import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines import v1_report
from overcooked_bench.baselines.by_hand import KEPT
from overcooked_bench.baselines.evidence import played
from overcooked_bench.baselines.evidence.played import PlayedPairs
from overcooked_bench.baselines.evidence.scores import TWIN, WHOLE
from overcooked_bench.evaluation.pools.players import Player
from tests.baselines.evidence.made import EPISODES, LAYOUT, pretend, write_pools

POOLS = "tiny", "twin", "human-test", "human-train", "others"


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    home = write_pools(tmp_path_factory.mktemp("pools"))
    skill = pretend([Pool.load(home / name) for name in POOLS], home / "played")
    return home, skill


@pytest.fixture
def report(home, tmp_path, monkeypatch):
    """Writes the page and returns its text and its numbers."""
    folder, _ = home
    monkeypatch.setattr(v1_report, "OTHERS", (str(folder / "human-test"), str(folder / "human-train")))
    monkeypatch.setattr(v1_report, "SOURCES", (str(folder / "others"), str(folder / "human-train")))

    def nothing(*arguments, **others):
        raise AssertionError("all pairs were played before")

    monkeypatch.setattr(played, "play_pairs", nothing)

    def write(*arguments):
        given = ["--pool", str(folder / "tiny"), "--played", str(folder / "played"), "--episodes", str(EPISODES)]
        assert v1_report.main([*given, "--entries", "--output", str(tmp_path / "out"), *arguments]) == 0
        return (tmp_path / "out" / "tiny.md").read_text(), json.loads((tmp_path / "out" / "tiny.json").read_text())

    return write


def test_the_page_says_what_the_episodes_say(home, report, tmp_path):
    text, numbers = report("--twin", str(home[0] / "twin"))
    layout = numbers["layouts"][0]
    rho = {(one["first"], one["second"]): one for one in layout["correlations"]}
    assert rho[WHOLE, TWIN]["rho"]["value"] > 0.95  # an agent's skill decides, whoever the partner is
    assert rho[WHOLE, TWIN]["entrants"] < rho["N without human", "mean with human-test"]["entrants"]
    assert layout["effective"]["all"] <= 3
    assert layout["values"] == {"dishes=left": 2, "onions=middle": 1, "onions=top": 1}
    assert sum(partner["share"] for partner in layout["partners"]) == pytest.approx(1)
    assert sum(share for share in layout["variance"].values() if share) == pytest.approx(1)
    assert layout["variance"]["side"] is None
    for name in ("crossplay", "people", "predictors"):
        assert f"](tiny-{name}.png)" in text
        assert (tmp_path / "out" / f"tiny-{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "reached on 1 of 1 layouts" in text
    for letter in "ac":
        assert f"({letter}) has fewer than 40 entrants or 8 families on cramped_room" in text
    twins = rho[WHOLE, TWIN]
    (row,) = [line for line in text.splitlines() if line.startswith("| entrants of (a), of families")]
    assert row.split("|")[2].strip() == f"{twins['entrants']} of {twins['families']}"


def test_scores_are_those_of_the_manifests_bounds_and_weights(home, report):
    folder, _ = home
    numbers = report()[1]["layouts"][0]
    kept = np.load(folder / "played" / f"{LAYOUT}-{EPISODES}-episodes-seed-0-horizon-400.npz")
    mean = dict(zip(kept["pairs"].tolist(), kept["returns"].mean(axis=(1, 2)).tolist(), strict=True))
    entry = Pool.load(folder / "others").agent(LAYOUT, "fast-0")
    with_ = {e.name: (mean[f"{entry.sha256} {e.sha256}"] - 20) / 200 for e in Pool.load(folder / "tiny").agents(LAYOUT)}
    found = next(one for one in numbers["entrants"] if one["reference"].endswith("fast-0"))["scores"]
    own = 0.6 * with_["sp-0"] + 0.4 * with_["sp-1"]
    assert found["N without human"] == pytest.approx(own, abs=1e-3)
    assert found["N"] == pytest.approx((own + with_["person-0"]) / 2, abs=1e-3)
    proxy = next(one for one in numbers["entrants"] if one["reference"].startswith("human-train"))["scores"]
    assert "N" not in proxy  # it knows the people whom a partner was made from
    assert {"N without human", "mean with human-test"} <= set(proxy)


def test_what_is_missing_is_said_and_what_was_written_by_hand_stays(home, report, tmp_path):
    text, numbers = report()
    for missing in ("no twin was given", "no entries were given", "the oracle"):
        assert f"Missing: {missing}" in text
    assert numbers["twin"] is None
    page = tmp_path / "out" / "tiny.md"
    page.write_text(f"old\n{KEPT}\n\nMine.\n")
    assert report()[0] == text[: text.index(KEPT)] + f"{KEPT}\n\nMine.\n"


def test_what_cannot_be_shown_is_refused(home, report, capsys):
    folder, _ = home
    assert v1_report.main(["--pool", str(folder / "others"), "--played", str(folder / "played")]) == 2
    assert "cramped_room/deep-0 has no floor and ceiling" in capsys.readouterr().err
    assert v1_report.main(["--pool", str(folder / "tiny"), "--layouts", "nowhere"]) == 2
    assert "has no layout 'nowhere'" in capsys.readouterr().err


def test_a_pair_is_played_once(tmp_path, monkeypatch):
    stay, greedy = (Player.scripted(name, LAYOUT) for name in ("stay", "greedy"))
    first = PlayedPairs(tmp_path, 2, horizon=60).matrix(LAYOUT, [greedy], [greedy, stay])
    real, asked = played.play_pairs, []
    monkeypatch.setattr(played, "play_pairs", lambda *given: (asked.append(given[2]), real(*given))[1])
    again = PlayedPairs(tmp_path, 2, horizon=60)
    second = again.matrix(LAYOUT, [stay, greedy], [greedy, stay])
    assert [len(pairs) for pairs in asked] == [2]
    assert (second.returns[1] == first.returns[0]).all()
    assert second.returns.shape == second.sides.shape == (2, 2, 2, 2)
    assert (PlayedPairs(tmp_path, 2, horizon=60).matrix(LAYOUT, [stay], [greedy]).returns == second.returns[0, 0]).all()

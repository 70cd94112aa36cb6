"""The thesis's table: an example worked by hand, what is omitted, and what reporting alone does."""

import json
from itertools import combinations

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.cli import main
from overcooked_bench.evaluation.ordered.curves import Row, as_few, curve
from overcooked_bench.evaluation.ordered.entrants import Entrant, find_entrants, tied
from overcooked_bench.evaluation.ordered.strangers import _pairs
from overcooked_bench.evaluation.ordered.table import make_figures, ordered_cross_play
from overcooked_bench.evaluation.pools import pairs
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.evaluation.protocol import ProtocolError, load_protocol
from overcooked_bench.evaluation.shown.ordered_tables import ordered_tables
from tests.agents.made import record, scripted, write_policy
from tests.evaluation.made import changed

LAYOUT = "cramped_room"
THESIS = load_protocol("thesis")
RULE = THESIS.report.ordered


def entrant(name, agents):
    return Entrant(name, {LAYOUT: tuple(Player(agent, None, scripted("greedy")) for agent in agents)})


def both_ways(**means):
    """`ab=100` is what the agents a and b reach together."""
    return {pair: float(mean) for names, mean in means.items() for pair in (tuple(names), tuple(names[::-1]))}


@pytest.fixture(scope="module")
def by_hand():
    """Self-play agents a to d, a population of p and q, and one of r; p and a, and p and r, are of one lineage."""
    means = both_ways(ab=100, ac=20, ad=0, bc=40, bd=60, cd=80)
    means |= both_ways(pb=60, pc=50, pd=10, qa=0, qb=40, qc=80, qd=90, ra=30, rb=30, rc=30, rd=30)
    means |= both_ways(pq=70, qr=30)
    return list(
        make_figures(LAYOUT, entrant("self-play", "abcd"), [entrant("P", "pq"), entrant("R", "r")], means, RULE)
    )


def lines(figure):
    return {one.entrant: one for one in figure.lines if not one.drawn}


def test_self_play_worked_by_hand(by_hand):
    """Rows 0 20 100, 40 60 100, 20 40 80 and 0 60 80, of which 50 % is the second number and 70 % the third.

    The 0.15 quantile of 20 40 60 60 is 20 + 0.45 x 20, that of 80 80 100 100 is 80; the best pair reaches 100.
    """
    figure = by_hand[0]
    assert figure.maximum == 100
    assert [row.means for row in figure.curves[0].rows] == [(0, 20, 100), (40, 60, 100), (20, 40, 80), (0, 60, 80)]
    assert figure.curves[0].rows[1].partners == ("c", "d", "a")
    assert lines(figure)["self-play"].values == (0.29, 0.29, 0.8, 0.8, 0.8, 0.8)
    assert lines(figure)["self-play"].average == pytest.approx(0.63, abs=1e-4)


def test_the_mean_with_its_band_and_the_quantile_with_its_own_worked_by_hand(by_hand):
    """At half of the partners: 20 40 60 60."""
    own, half = by_hand[0].curves[0], 49
    assert own.mean[half] == 45
    assert (own.band[0][half], own.band[1][half]) == (35, 60)  # 20 + 0.75 x 20, and 60
    assert own.quantile[half] == 29
    assert (own.quantile_band[0][half], own.quantile_band[1][half]) == (20, 38)  # the minimum, and 20 + 0.9 x 20


def test_a_row_that_lacks_its_own_lineage_is_read_at_the_same_share_of_its_partners(by_hand):
    """P is 10 50 60 and 0 40 80 90: at 50 % 50 and 40, at 60 % 50 and 80, at 70 % 60 and 80, then 60 and 90."""
    assert lines(by_hand[0])["P"].values == (0.415, 0.545, 0.63, 0.645, 0.645, 0.645)
    assert lines(by_hand[0])["R"].values == (0.3,) * 6


def test_populations_with_one_another_worked_by_hand(by_hand):
    """P is 70 and 30 70, R is 30: pairs of one lineage are omitted, others of the same population are not."""
    figure = by_hand[1]
    assert figure.partners == "one another"
    assert lines(figure)["P"].values == (0.36, 0.7, 0.7, 0.7, 0.7, 0.7)
    assert lines(figure)["R"].values == (0.3,) * 6
    assert lines(figure)["self-play"] == lines(by_hand[0])["self-play"]


def test_a_single_entrant_has_nobody_to_be_compared_with():
    found = make_figures(LAYOUT, entrant("self-play", "ab"), [entrant("R", "r")], both_ways(ab=9, ra=1, rb=2), RULE)
    assert [figure.partners for figure in found] == ["self-play"]


def rows(means):
    return [Row(str(i), ("x",) * len(some), tuple(map(float, sorted(some)))) for i, some in enumerate(means)]


def test_few_rows_that_are_the_better_of_two_are_what_all_choices_give_on_average():
    """One row of five, the better of two: against a count of all ten pairs."""
    numbers = np.random.default_rng(0).uniform(0, 100, (5, 8))
    five = rows(numbers)
    better = [max(pair, key=lambda row: np.mean(row.means)) for pair in combinations(five, 2)]
    expected = np.mean([row.at(RULE.positions) for row in better], axis=0) / 100
    found = as_few("self-play", five, RULE, 100, few=1, of=2)
    assert found.values == pytest.approx(expected, abs=0.02)
    assert (found.rows, found.drawn, found.chosen) == (1, True, True)
    assert as_few("self-play", five, RULE, 100, few=3, of=2) is None  # six of five


@given(st.integers(0, 1000))
def test_reporting_alone_makes_identical_agents_look_better(seed):
    """Thirty agents of one kind, reported as three that are the better of two: never worse, and often much better."""
    rng = np.random.default_rng(seed)
    thirty = rows(np.where(rng.random((30, 1)) < 0.5, 20, 90) + rng.normal(0, 15, (30, 20)))
    plain = curve("self-play", thirty, RULE).quantile
    assert as_few("self-play", thirty, RULE, 1, few=3, of=2).average > np.mean([plain[49 + 10 * i] for i in range(6)])


@given(st.lists(st.integers(0, 300), min_size=1, max_size=30), st.sampled_from([0.5, 0.6, 0.7, 0.8, 0.9, 1.0]))
def test_a_share_of_the_partners_is_what_the_agent_does_not_exceed_with_so_many(means, share):
    (row,) = rows([means])
    (value,) = row.at([share])
    assert sum(mean <= value for mean in means) >= share * len(means) - 1e-9
    assert sum(mean < value for mean in means) < share * len(means)


def test_agents_that_are_tied_are_no_strangers():
    a, b = (msgspec.structs.replace(record(name), reference=scripted(name).reference) for name in ("greedy", "stay"))
    assert not tied(a, b)
    assert tied(a, a)
    assert tied(a, msgspec.structs.replace(b, lineage=a.lineage))
    taught = msgspec.structs.replace(b, training=record(settings={"partner_hashes": [a.sha256]}).training)
    assert tied(a, taught)
    assert tied(taught, a)


def test_a_pair_is_played_the_same_way_round_whoever_else_plays():
    entries = [scripted(name) for name in ("greedy", "hesitant", "waiter", "clockwise")]
    players = [Player(entry.name, None, entry) for entry in entries]
    named = [
        {frozenset((some[a].reference, some[b].reference)): some[a].reference for a, b in _pairs(some, own)}
        for some, own in ((players, 2), ([players[1], players[0], *players[:1:-1]], 2))
    ]
    assert named[0] == named[1]
    assert len(named[0]) == 6
    assert named[0][frozenset(("greedy", "waiter"))] == "waiter"  # start states are the self-play agent's


SHORT = changed(THESIS, layouts=("coordination_ring",), episodes=2, horizon=200)


@pytest.fixture(scope="module")
def played():
    return ordered_cross_play(["dev-v0", "greedy", "hesitant"], SHORT)


def test_entrants_meet_the_self_play_agents_and_one_another(played):
    assert [figure.partners for figure in played.figures] == ["self-play", "one another"]
    with_own, among = played.figures
    assert [len(one.rows) for one in with_own.curves] == [4, 1, 1]
    assert all(len(row.partners) == 3 for row in with_own.curves[0].rows)
    assert len(with_own.curves[1].rows[0].partners) == 4
    assert among.curves[1].rows[0].partners == ("hesitant",)
    assert among.curves[1].rows[0].means == among.curves[2].rows[0].means
    assert with_own.maximum == max(row.means[-1] for row in with_own.curves[0].rows) > 0
    (overall,) = [one for one in played.lines if one.entrant == "greedy"]
    both = [lines(figure)["greedy"].values for figure in played.figures]
    assert overall.values == pytest.approx(np.mean(both, axis=0), abs=1e-4)


def test_numbers_depend_on_the_start_but_not_on_other_entrants_and_blocks(played, monkeypatch):
    monkeypatch.setattr(pairs, "MOST_ROWS", 16)
    alone = ordered_cross_play(["dev-v0", "hesitant"], SHORT)
    assert [figure.partners for figure in alone.figures] == ["self-play"]
    assert alone.figures[0].curves == (played.figures[0].curves[0], played.figures[0].curves[2])
    other = ordered_cross_play(["dev-v0", "hesitant"], changed(SHORT, start="standard"))
    assert other.figures[0].curves[0].mean != alone.figures[0].curves[0].mean


def test_the_table_fits_the_terminal_and_says_what_it_is(played, capsys):
    from rich.console import Console

    Console(width=100).print(ordered_tables(played))
    said = capsys.readouterr().out
    assert max(map(len, said.splitlines())) <= 100
    for words in ("with 4 self-play agents; 1 =", "self-play, any 3", "50 %", "average", "needs 19", "mean of these 2"):
        assert words in said


def test_the_command_writes_curves_and_pictures(tmp_path, capsys):
    file = tmp_path / "short.yaml"
    file.write_bytes(msgspec.json.encode(SHORT))
    out = str(tmp_path / "out")
    assert (
        main(["crossplay", "dev-v0", "greedy", "--protocol", str(file), "--output", out, "--workers", "1", "--json"])
        == 0
    )
    told = json.loads(capsys.readouterr().out)
    assert told == json.loads((tmp_path / "out" / "ordered.json").read_text())
    assert told["rule"]["positions"] == [0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    heads, *table = (tmp_path / "out" / "curves.csv").read_text().splitlines()
    assert heads == "layout,partners,entrant,rows,share,mean,q0.25,q0.75,q0.15,minimum,q0.3,maximum"
    assert len(table) == 200
    assert (tmp_path / "out" / "coordination_ring-self-play.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["dev-v0", "greedy"], "2 pools given; the matrix is of one pool"),
        (["dev-v0", "--protocol", "thesis", "--episodes", "5"], "do not go with --protocol"),
        (["dev-v0", "--protocol", "dev"], "the protocol dev says nothing about ordered curves"),
        (["dev-v0", "--protocol", "thesis", "--layouts", "bottleneck"], "does not play 'bottleneck'; its layouts are"),
        (["dev-v0", "greedyy", "--protocol", "thesis"], "'greedyy' is no pool, entry or scripted agent"),
        (["dev-v0", "greedy", "greedy", "--protocol", "thesis"], "greedy is given twice"),
        (["human-train", "--protocol", "thesis"], "human-train has 0 self-play agents on forced_coordination"),
    ],
)
def test_what_cannot_be_played_is_answered_with_what_to_write(arguments, words, capsys):
    assert main(["crossplay", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_one_seat_alone_is_refused():
    with pytest.raises(ProtocolError, match=r"seats is \[0\]; cross-play is from both"):
        ordered_cross_play(["dev-v0"], changed(SHORT, seats=(0,)))


def test_final_agents_are_grouped_by_method_and_configuration(tmp_path):
    entries = []
    for seed, (name, more) in enumerate(
        [
            *((f"sp-{i}", {}) for i in range(3)),
            ("sp-0-half", {"lineage": f"{LAYOUT}/sp-0", "checkpoint": 0.5}),
            ("r0-0", {"method": "population", "configuration": "R0"}),
            ("r0-1", {"method": "population", "configuration": "R0"}),
            ("r0-1-second", {"method": "population", "configuration": "R0", "lineage": f"{LAYOUT}/r0-1"}),
            ("l0-0", {"method": "population", "configuration": "L0"}),
        ]
    ):
        write_policy(tmp_path / "mine" / LAYOUT / name, seed)
        entries.append(record(name, seed=seed, **more))
    write_manifest(tmp_path / "mine", "mine", entries)
    own, found = find_entrants([tmp_path / "mine"], [LAYOUT])
    assert [player.entry.name for player in own.agents[LAYOUT]] == ["sp-0", "sp-1", "sp-2"]
    assert {one.name: [player.entry.name for player in one.agents[LAYOUT]] for one in found} == {
        "mine: population L0": ["l0-0"],
        "mine: population R0": ["r0-0", "r0-1"],
    }
    (only,) = find_entrants([tmp_path / "mine", "stay"], [LAYOUT])[1][2:]
    assert only.name == "stay"
    with pytest.raises(PoolError, match="mine has 0 self-play agents on coordination_ring"):
        find_entrants([tmp_path / "mine"], ["coordination_ring"])

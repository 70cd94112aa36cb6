import csv
import json

import msgspec
import numpy as np
import pytest
from PIL import Image

from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.pools import crossplay
from overcooked_bench.evaluation.pools.crossplay import choose, cross_play
from overcooked_bench.evaluation.shown.heatmap import draw_heat_map
from overcooked_bench.evaluation.shown.pool_tables import crossplay_tables
from tests.agents.made import record, write_policy

LAYOUT = "cramped_room"


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    """Two runs of one architecture, one of them with a checkpoint, and a third run of another architecture."""
    home = tmp_path_factory.mktemp("pools") / "tiny"
    entries = []
    for seed, (name, lineage, share, settings) in enumerate(
        [
            ("sp-0", "a", 1.0, {}),
            ("sp-0-half", "a", 0.5, {}),
            ("sp-1", "b", 1.0, {}),
            ("wide-0", "c", 0.5, {"hidden": (4,), "observation": "stack_channels", "shape": (52, 4, 5)}),
        ]
    ):
        write_policy(home / LAYOUT / name, seed, **settings)
        entries.append(record(name, lineage=lineage, checkpoint=share, seed=ord(lineage)))
    write_manifest(home, "tiny", entries)
    return Pool.load(home)


@pytest.fixture(scope="module")
def found(pool):
    return cross_play(pool, LAYOUT, episodes=3, horizon=40)


def names(agents):
    return [agent.name for agent in agents]


def test_the_last_agent_of_each_lineage_is_chosen(pool):
    assert names(choose(pool, LAYOUT)) == ["sp-0", "sp-1", "wide-0"]
    assert names(choose(pool, LAYOUT, checkpoints=True)) == ["sp-0", "sp-0-half", "sp-1", "wide-0"]
    assert names(choose(pool, LAYOUT, ["sp-*"])) == ["sp-0", "sp-1"]
    assert names(choose(pool, LAYOUT, ["*-half", "wide-0"])) == ["sp-0-half", "wide-0"]


@pytest.mark.parametrize(
    ("layout", "patterns", "message"),
    [
        ("coordination_ring", [], "it has cramped_room"),
        (LAYOUT, ["sp-*", "bc-*"], "no agent is named 'bc-.'; there are sp-0"),
        (LAYOUT, ["sp-0*"], "two lineages"),
    ],
    ids=["layout", "pattern", "lineage"],
)
def test_what_cannot_be_chosen_is_told(pool, layout, patterns, message):
    with pytest.raises(PoolError, match=message):
        choose(pool, layout, patterns)


def test_every_pair_is_played_from_both_seats(found):
    assert [player.name for player in found.agents] == ["sp-0", "sp-1", "wide-0"]
    assert [player.checkpoint for player in found.agents] == [1, 1, 0.5]
    means = np.array(found.means)
    assert means.shape == np.array(found.errors).shape == (3, 3)
    assert found.self_play.value == pytest.approx(means.trace() / 3)
    assert found.cross_play.value == pytest.approx((means.sum() - means.trace()) / 6)


PLAY_ROW = crossplay._play_row


def test_a_cell_is_the_same_whoever_else_is_played(monkeypatch):
    pool, layout, rows = Pool.load("dev-v0"), "coordination_ring", {}

    def play_row(row):
        index, returns = PLAY_ROW(row)
        rows[row.agents[index], row.episodes] = returns
        return index, returns

    monkeypatch.setattr(crossplay, "_play_row", play_row)
    agents = pool.agents(layout)
    cross_play(pool, layout, agents[1:3], episodes=2)
    cross_play(pool, layout, agents, episodes=3)
    for agent in agents[1:3]:
        few, many = rows[agent.name, 2], rows[agent.name, 3]
        assert (few == many[1:3, :2]).all()
    assert len(np.unique(np.stack([returns for (_, episodes), returns in rows.items() if episodes == 3]))) > 3


@pytest.mark.slow
def test_a_cluster_plays_the_same(pool, found):
    assert cross_play(pool, LAYOUT, episodes=3, horizon=40, workers=2, engine="ray") == found


def test_good_agents_reach_in_the_matrix_what_their_pool_says():
    pool = Pool.load("dev-v0")
    agents = [pool.agent("forced_coordination", name) for name in ("sp-0", "sp-2")]
    found = cross_play(pool, "forced_coordination", agents, episodes=5)
    for i, agent in enumerate(agents):
        assert found.means[i][i] == pytest.approx(agent.trained.self_play.mean, abs=10)
    assert found.worst[2] < 40  # they have conventions of their own
    assert found.ratio.value < 0.3


def test_the_same_seed_plays_the_same_games_and_another_does_not():
    pool = Pool.load("dev-v0")
    first, again, other = (cross_play(pool, "coordination_ring", episodes=2, seed=seed).means for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_one_episode_has_no_error(pool):
    with pytest.raises(ValueError, match="two at least"):
        cross_play(pool, LAYOUT, episodes=1)


def test_progress_is_told_row_by_row(pool):
    told = []
    cross_play(pool, LAYOUT, choose(pool, LAYOUT), 2, horizon=10, on_progress=lambda *at: told.append(at))
    assert told == [(1, 3), (2, 3), (3, 3)]


def test_files_hold_the_matrix(found, tmp_path):
    found.write(tmp_path / "new" / LAYOUT)
    rows = list(csv.reader((tmp_path / "new" / f"{LAYOUT}.csv").read_text().splitlines()))
    assert rows[0] == ["seat 0 \\ seat 1", "sp-0", "sp-1", "wide-0"]
    assert [float(cell) for cell in rows[2][1:]] == list(found.means[1])
    told = json.loads((tmp_path / "new" / f"{LAYOUT}.json").read_text())
    assert told["schema"] == 1
    assert told["pool"]["name"] == "tiny"
    assert set(told["cross_play"]) == {"value", "low", "high"}


def test_the_heat_map_is_a_picture_of_the_means(found, tmp_path):
    draw_heat_map(
        msgspec.structs.replace(found, means=((200.0, 0.0, 0.0), (0.0,) * 3, (0.0, 0.0, 100.0))), tmp_path / "map.png"
    )
    red, green, blue = np.moveaxis(np.asarray(Image.open(tmp_path / "map.png").convert("RGB"), np.int64), 2, 0)
    height, width = red.shape
    cells = np.s_[:, : int(0.75 * width)]  # without the colour bar
    y, x = np.nonzero((red > 230) & (green > 200) & (blue < 120) & (np.arange(width) < 0.75 * width))
    assert len(y) > 0.02 * height * width  # the greatest value, bright, top left
    assert max(y.max() / height, x.max() / width) < 0.5
    dark = (red < 40) & (blue > 50)
    assert dark[cells].sum() > 6 * len(y)


def test_the_table_has_a_row_a_layout(found, capsys):
    from rich.console import Console

    Console(width=100).print(crossplay_tables([found, found]))
    said = capsys.readouterr().out
    assert said.count(LAYOUT) == 2
    assert f"{found.worst[0]}, {found.worst[1]}:" in said

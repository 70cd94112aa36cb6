"""What the games depend on, what they do not, and what a scored agent can find out about its partners."""

import json

import numpy as np
import pytest

from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.evaluation.games import block as module
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.streams import Streams, draw_salt, stream_key
from overcooked_bench.evaluation.protocol import read_protocol
from tests.agents.made import scripted
from tests.evaluation.made import block, changed, protocol_text, score

STREAMS = Streams("0" * 64, "pepper", 0, "cramped_room", 3)


def test_the_streams_are_frozen():
    """A change here changes every published game: say so in the changelog, and print the tables again."""
    assert stream_key("a", 1) == 5635535206041787705
    assert STREAMS.start("1" * 64) == 2298634310296071648
    assert STREAMS.order(8) == [1, 2, 7, 0, 4, 5, 3, 6]
    assert STREAMS.seeds(["1" * 64, "2" * 64], np.array([0, 1])).tolist() == [
        [3159037401557729606, 12460466062916732517],
        [8074321763707464120, 186123787986245350],
    ]
    assert STREAMS.of_process(1) == 11212884911560249046


def test_a_start_state_is_frozen(protocol):
    episode = play_block(block(changed(protocol, pool="scripted"), "stay")).episodes[0]
    chefs = [(chef["position"], chef["orientation"]) for chef in json.loads(episode.start)["players"]]
    assert (episode.partner, episode.seat, chefs) == ("greedy", 0, [([3, 1], [0, -1]), ([1, 2], [0, -1])])


def test_nothing_that_the_agent_is_given_depends_on_its_partners():
    seats = np.array([0, 1, 1, 0])
    mine = [STREAMS.seeds([name * 64 for name in names], seats)[np.arange(4), seats] for names in ("1234", "5566")]
    assert mine[0].tolist() == mine[1].tolist()
    assert len(set(mine[0].tolist())) == 4
    assert sorted(STREAMS.order(4)) == [0, 1, 2, 3]
    orders = {tuple(STREAMS._replace(salt=draw_salt()).order(6)) for _ in range(40)}
    assert len(orders) > 30


@pytest.fixture
def three(tmp_path):
    """A pool of three scripted partners; `write` writes it again with other versions."""

    def write(**versions):
        entries = [scripted(name, version=versions.get(name, 1)) for name in ("greedy", "onion_courier", "stay")]
        write_manifest(tmp_path / "three", "three", entries)
        return tmp_path / "three"

    write()
    return write


def test_a_scripted_agents_version_changes_its_own_games_alone(protocol, three, monkeypatch):
    before = play_block(block(protocol, "random", pool=three()))
    pool = three(greedy=2)
    module.pool_as_hashed.cache_clear()
    after = play_block(block(protocol, "random", pool=pool))
    same = [(old.partner, old == new) for old, new in zip(before.episodes, after.episodes, strict=True)]
    assert same == [(name, name != "greedy") for name in ("greedy", "onion_courier", "stay") for _ in (0, 1)]
    with pytest.raises(PoolError, match="means version 2 of the scripted agent 'greedy'"):
        score("random", protocol, pool=pool, output=pool.parent / "out")


SPY = """
import json
from pathlib import Path

import numpy as np
from overcooked_bench import load_agent
from overcooked_bench.agents import sample_actions
from overcooked_bench.evaluation.games.streams import Streams, stream_key

GAMES, ROWS = {games!r}, {rows}
HERE = Path(__file__).parent


class Spy:
    observation = "lossless26"

    def reset(self, layout, seats, seeds):
        self.seeds, self.step, known = seeds, 0, {{}}
        for play, salt, partners, layout, episode in GAMES:
            streams, belongs = Streams(play, salt, 0, layout, episode), (play, 0, layout, episode)
            hands = [(name, seat) for name in sorted(partners) for seat in (0, 1)]
            for row, (seat, seed) in enumerate(zip(seats.tolist(), seeds.tolist())):
                for name, sha256 in partners.items():
                    keys = [(*belongs, sha256, seat, "ego"), (*streams, sha256, seat, "ego")]
                    keys += [(*streams, "ego", sha256, seat), (*streams, "partner", sha256, seat)]
                    if seed in [stream_key(*key) for key in keys]:
                        known[row] = name
                if ROWS and seed == stream_key(*streams, "ego", row):
                    known[row] = hands[streams.order(len(hands))[row]][0]
        with open(HERE / "known", "a") as file:
            print(json.dumps(known), file=file)
        self.twins = []
        for name in set(known.values()):
            rows = np.array([row for row in known if known[row] == name])
            twin = load_agent(name, layout)
            twin.reset(layout, seats[rows], seeds[rows])
            self.twins.append((rows, twin))

    def act(self, observations):
        self.step += 1
        actions = sample_actions(np.full((len(observations), 6), 1 / 6), self.seeds, self.step)
        for rows, twin in self.twins:
            actions[rows] = twin.act(observations[rows])
        return actions


def make_agent(layout, training_seed):
    return Spy()
"""


@pytest.mark.parametrize(("salt", "rows"), [(None, False), ("nobody knows this one", True)])
def test_a_submission_that_recomputes_the_dealing_gains_nothing(salt, rows, tmp_path):
    """It knows this code, the protocol, its public salt and the pool, and plays the twin of whom it recognises.

    By its seeds it recognises nobody. By its rows it would under the public salt, and does not under another.
    """
    protocol = read_protocol(protocol_text(episodes=3, horizon=100), "tiny.yaml")
    partners = {name: scripted(name).sha256 for name in ("greedy", "random")}
    games = [(protocol.sha256, protocol.play.salt, partners, "cramped_room", episode) for episode in range(3)]
    points = []
    for name, knows in (("spy", games), ("honest", [])):
        (tmp_path / name).mkdir()
        (tmp_path / name / "agent.py").write_text(SPY.format(games=knows, rows=rows))
        scores, *_ = score(tmp_path / name, protocol, output=tmp_path / f"{name}-out", salt=salt)
        points.append(scores.find(layout="cramped_room"))
        assert set((tmp_path / name / "known").read_text().split()) == {"{}"}
    assert points[0] == points[1]

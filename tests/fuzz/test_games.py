"""Games files: their bytes, and what their records say."""

import json
from pathlib import Path

from overcooked_bench.human.games import GamesError, check_games, read_games, write_games
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, trees_of

FILE = Path(__file__).parents[1] / "data" / "upgrades" / "games-1" / "some.games.jsonl"


@TRIES
def test_games(tries, tmp_path):
    file = tmp_path / "x.games.jsonl"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        found = check_games(file)
        write_games(tmp_path / "again.games.jsonl", found.games)
        assert read_games(tmp_path / "again.games.jsonl") == found.games
        if found.faults:
            raise GamesError(found.faults[0])

    whole = FILE.read_bytes()
    lines, rng = whole.splitlines(), seeded("games")
    inputs = mixed(rng, bytes_of([whole], rng), as_json(trees_of([json.loads(line) for line in lines], rng)))
    attack("games files", [whole, *lines], inputs, read, GamesError, tries).check()

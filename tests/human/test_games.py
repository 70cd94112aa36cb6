"""Games files are read as they were written, and nothing that did not happen is read from them."""

import json
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as some

from overcooked_bench import KitchenState
from overcooked_bench.errors import WrongUse
from overcooked_bench.human.game import MOST_STEPS, GamesError, Player, letters_of
from overcooked_bench.human.games import check_games, deliveries, read_games, record, write_games
from overcooked_bench.kitchen.kitchens import Kitchens
from tests.human.made import PEOPLE, agents_games, random_game, start_of

LAYOUTS = ("cramped_room", "forced_coordination-mirrored", "bottleneck", "XPOX\nX  D\nXXSX")


@given(
    layout=some.sampled_from(LAYOUTS),
    cooking=some.sampled_from(("auto", "manual")),
    actions=some.lists(some.tuples(some.integers(0, 5), some.integers(0, 5)), min_size=1, max_size=40),
    seed=some.integers(0, 5),
    more=some.fixed_dictionaries(
        {}, optional={"notes": some.text(max_size=20), "group": some.sampled_from(("2019-03", "we.1"))}
    ),
)
def test_a_game_is_read_as_it_was_written(tmp_path_factory, layout, cooking, actions, seed, more):
    file = tmp_path_factory.mktemp("games") / "x.games.jsonl"
    start = start_of(layout, seed, cooking)
    game = record(layout, actions, seats=PEOPLE, source="made up", start=start, cooking=cooking, **more)
    write_games(file, [game, game])
    assert read_games(file) == [game, game]
    assert game.joint_actions().tolist() == [list(joint) for joint in actions]
    assert game.first_state() == start
    assert letters_of(game.joint_actions()) == game.actions


def test_the_soups_are_those_of_the_game():
    (game,) = agents_games(horizon=120)
    kitchens = Kitchens("cramped_room", 1, horizon=120, start="standard", autoreset=False)
    found = []
    for step, joint in enumerate(game.joint_actions()):
        paid = kitchens.step(joint[None]).soup_reward[0]
        found += [(step, seat) for seat in (0, 1) if paid[seat]]
    assert game.soups == tuple(found)
    assert len(found) >= 2
    assert game.start is None


def test_a_games_file_of_nothing_holds_no_games(tmp_path):
    write_games(tmp_path / "x.games.jsonl", [])
    assert read_games(tmp_path / "x.games.jsonl") == []


GOOD = msgspec.to_builtins(agents_games(horizon=60)[0])
ACTIONS, SOUPS = GOOD["actions"], GOOD["soups"]
FAR = {**start_of("cramped_room", 0).to_dict(), "timestep": 3}
OTHER = KitchenState(start_of("counter_circuit", 3).chefs).to_dict()
HOSTILE = {
    "a key that nobody knows": ({"workers_number": 5}, "workers_number"),
    "another format": ({"format": 2}, "a game of format 2; this version reads format 1"),
    "a format that is none": ({"format": "[[[["}, r"a game of format \[\[\[\["),
    "no such layout": ({"layout": "cramped_rom"}, "cannot be played: no layout named 'cramped_rom'"),
    "a path as layout": ({"layout": "/etc/passwd"}, "no layout named '/etc/passwd'"),
    "a layout that is none": ({"layout": "XX\nXX"}, "cannot be played"),
    "a long layout": ({"layout": "X" * 70_000}, "length <= 65536"),
    "another cooking mode": ({"cooking": "raw"}, "cooking"),
    "a horizon of nothing": ({"horizon": 0}, "horizon"),
    "a horizon without end": ({"horizon": 10**9}, "horizon"),
    "a horizon that is too short": ({"horizon": 59}, "60 steps in a kitchen with a horizon of 59"),
    "a wrong letter": ({"actions": [ACTIONS[0][:7] + "X" + ACTIONS[0][8:], ACTIONS[1]]}, "step 7: the action 'X'"),
    "a letter of elsewhere": ({"actions": [ACTIONS[0], "Ü" + ACTIONS[1][1:]]}, "step 0: the action '.xdc' of chef 1"),
    "a small letter": ({"actions": [ACTIONS[0].lower(), ACTIONS[1]]}, "step 0: the action"),
    "unequal lengths": ({"actions": [ACTIONS[0], ACTIONS[1][:-1]]}, "chef 0 has 60 actions and chef 1 has 59"),
    "no steps": ({"actions": ["", ""], "soups": []}, "0 steps"),
    "three chefs": ({"actions": [*ACTIONS, ACTIONS[0]]}, "actions"),
    "endless steps": ({"actions": ["S" * (MOST_STEPS + 1)] * 2, "horizon": MOST_STEPS}, "length <= 10000"),
    "a soup that was not delivered": ({"soups": [[3, 1], *SOUPS]}, "step 3, chef 1: the listed soup is not delivered"),
    "a soup that was left out": ({"soups": []}, f"step {SOUPS[0][0]}, chef .: an unlisted soup is delivered"),
    "a soup after the end": ({"soups": [[60, 0]]}, "step 60: the soup"),
    "a soup twice": ({"soups": [SOUPS[0], SOUPS[0]]}, "out of order"),
    "a soup of a third chef": ({"soups": [[3, 2]]}, "soups"),
    "a start in a wall": ({"start": OTHER}, "cannot be played: .*not floor"),
    "a start later on": ({"start": FAR}, "the start state is that of step 3"),
    "a start that is none": ({"start": {"players": 5}}, "cannot be played"),
    "a start that is a list": ({"start": []}, "start"),
    "a deep start": ({"start": json.loads("[" * 70 + "]" * 70)}, "inside each other"),
    "a player of another kind": ({"seats": [{"kind": "god", "name": "x"}, GOOD["seats"][1]]}, "kind"),
    "a player's number": ({"seats": [{"kind": "human", "name": "x", "id": 5}, GOOD["seats"][1]]}, "id"),
    "a hash that is none": ({"seats": [{"kind": "agent", "name": "x", "sha256": "../x"}, GOOD["seats"][1]]}, "sha256"),
    "a group that is a path": ({"group": "../../x"}, "group"),
    "endless notes": ({"notes": "x" * 5000}, "length <= 2000"),
}  # fmt: skip


@pytest.mark.parametrize(("change", "message"), HOSTILE.values(), ids=HOSTILE.keys())
def test_what_is_no_game_is_refused_with_its_line(change, message, tmp_path):
    file = tmp_path / "x.games.jsonl"
    file.write_text(f"{json.dumps(GOOD)}\n\n{json.dumps({**GOOD, **change})}\n{json.dumps(GOOD)}\n")
    with pytest.raises(GamesError, match=rf"^{file}:3(:1)?: .*{message}"):
        read_games(file)
    games, faults = check_games(file)
    assert len(games) == 2
    assert len(faults) == 1


def test_a_format_may_be_left_out_of_what_is_wrong_elsewhere(tmp_path):
    (tmp_path / "x.games.jsonl").write_text(json.dumps({"layout": "cramped_room"}))
    with pytest.raises(GamesError, match="missing required field `cooking`"):
        read_games(tmp_path / "x.games.jsonl")


@pytest.mark.parametrize(
    "content", [json.dumps(GOOD, indent=2).encode(), json.dumps([GOOD]).encode(), json.dumps(GOOD).encode("utf-16")]
)
def test_a_file_of_another_form_is_told_what_form_it_should_have(content, tmp_path):
    (tmp_path / "x.games.jsonl").write_bytes(content)
    with pytest.raises(GamesError, match="one JSON object, one game, per line"):
        read_games(tmp_path / "x.games.jsonl")


@pytest.mark.parametrize("line", [b"{", b"\xff", b"5", b"[]", b"null", b"[" * 5000, b'"' + b"x" * (2 << 20) + b'"'])
def test_a_line_that_is_no_record_is_refused(line, tmp_path):
    file = tmp_path / "x.games.jsonl"
    file.write_bytes(json.dumps(GOOD).encode() + b"\n" + line)
    with pytest.raises(GamesError, match=rf"^{file}:2"):
        read_games(file)


def test_a_file_of_rubbish_is_left_soon(tmp_path):
    file = tmp_path / "x.games.jsonl"
    file.write_bytes(b"x\n" * 100_000)
    assert len(check_games(file).faults) == 100


def test_a_missing_file_and_a_folder_are_named(tmp_path):
    for path in (tmp_path / "none.games.jsonl", tmp_path):
        with pytest.raises(GamesError, match=str(path)):
            read_games(path)


@pytest.mark.parametrize("key", sorted(set(GOOD) - {"format", "start", "group", "consent", "licence", "notes"}))
def test_a_missing_key_is_named(key, tmp_path):
    (tmp_path / "x.games.jsonl").write_text(json.dumps({k: v for k, v in GOOD.items() if k != key}))
    with pytest.raises(GamesError, match=f":1: .*{key}"):
        read_games(tmp_path / "x.games.jsonl")


@pytest.mark.parametrize(
    "wrong",
    [
        {"actions": [[0, 6]]},
        {"actions": [0, 1]},
        {"actions": [[0, 1]], "horizon": 0},
        {"actions": [[0, 1]], "cooking": "raw"},
        {"actions": [[0, 1]], "group": "a/b"},
        {"actions": [[0, 1]], "layout": "nowhere"},
        {"actions": [[0, 1]], "start": start_of("counter_circuit", 3)},
        {"actions": [[0, 1]], "layout": LAYOUTS[3]},
    ],
    ids=str,
)
def test_no_game_is_made_that_could_not_be_read(wrong):
    with pytest.raises(GamesError):
        record(**{"layout": "cramped_room", "seats": PEOPLE, "source": "made up", **wrong})


def test_what_a_start_state_says_besides_is_dropped(tmp_path):
    start = start_of("cramped_room", 1).to_dict()
    start["worker"] = 1234
    (tmp_path / "x.games.jsonl").write_text(
        json.dumps({**GOOD, "start": start, "actions": ["S", "S"], "soups": [], "horizon": 1})
    )
    (game,) = read_games(tmp_path / "x.games.jsonl")
    assert game.start is not None
    assert "worker" not in game.start


def test_games_of_all_lengths_are_checked_together():
    games = [random_game(LAYOUTS[seed % 3], steps=5 + 7 * seed, seed=seed) for seed in range(6)]
    assert deliveries(games) == [game.soups for game in games]


GOLDEN = Path(__file__).parents[1] / "data" / "upgrades" / "games-1" / "some.games.jsonl"


def test_files_of_format_1_are_read_forever(tmp_path):
    first, second, third = read_games(GOLDEN)
    assert (first.layout, first.steps, first.soups, first.start) == ("cramped_room", 60, ((34, 0),), None)
    assert (first.group, first.licence, first.notes) == ("2019-03", "MIT", "two lines\nof ünicode")
    assert first.seats == (Player("human", "first"), Player("human", "second"))
    assert (second.layout, second.steps, second.horizon) == ("forced_coordination-mirrored", 90, 400)
    assert second.seats[0] == Player("agent", "greedy", "a" * 64)
    assert (third.layout.count("\n"), third.cooking, third.first_state().chefs[0].holding) == (3, "manual", "onion")
    write_games(tmp_path / "x.games.jsonl", [first, second, third])
    assert (tmp_path / "x.games.jsonl").read_bytes() == GOLDEN.read_bytes()


def test_a_player_is_known_by_what_it_is():
    with pytest.raises(WrongUse, match="not a game"):
        record("cramped_room", [[0, 1]], seats=(Player("ghost", "x"), PEOPLE[1]), source="made up")  # type: ignore[arg-type]

"""Tables of recorded games become games that replay; what does not replay is named."""

import json
import pickle
import re

import pytest

from overcooked_bench.cli import main
from overcooked_bench.human.games import read_games
from overcooked_bench.human.original_2019 import distribution
from overcooked_bench.human.original_2019.dataframe import TableError, read_columns
from overcooked_bench.human.original_2019.importing import Difference, import_games
from overcooked_bench.human.original_2019.inert import PickleError, read_pickle
from overcooked_bench.human.original_2019.states import RecordingError
from overcooked_bench.human.original_2019.summary import count, leak
from tests.human.made import agents_games, random_game
from tests.human.original_2019.pickled import dumped, joined, rows, table
from tests.human.original_2019.test_distribution import sdist


@pytest.fixture(scope="module")
def played():
    (cramped,) = agents_games(horizon=100)
    return {
        "cramped": rows(cramped, 7),
        "other": rows(random_game("cramped_room", start=None), 31),
        "forced": rows(random_game("forced_coordination", start=None), 7, "random0"),
        "circuit": rows(random_game("counter_circuit", seed=3), 5, "random3"),
    }


@pytest.fixture
def pickles(played):
    return {
        "train": table(joined(played["circuit"], played["cramped"])),
        "test": table(joined(played["other"], played["forced"])),
    }


def test_every_step_of_every_game_is_read(pickles, played):
    ticks = []
    imported = import_games(pickles, on_progress=lambda *done: ticks.append(done))
    assert [(game.layout, game.group) for game in imported.games] == [
        ("cramped_room", "2019-01"),
        ("cramped_room", "2019-02"),
        ("forced_coordination", "2019-01"),
        ("counter_circuit", "2019-00"),
    ]
    assert imported.sets == ["train", "test", "test", "train"]
    assert [game.steps for game in imported.games] == [100, 30, 30, 30]
    assert ticks[-1] == (190, 190)
    first, *_, last = imported.games
    assert len(first.soups) == sum(played["cramped"]["reward"]) / 5 > 0
    assert first.start is None
    assert last.start is not None
    assert (first.cooking, first.horizon, first.licence) == ("auto", 100, "MIT")


def test_no_number_of_a_worker_and_no_time_is_kept(pickles):
    kept = " ".join(map(repr, import_games(pickles).games))
    assert "31" not in re.sub(r"2019-\d\d", "", kept)
    assert "time" not in kept.replace("timestep", "").replace("cook_time", "")


def test_it_is_counted_who_is_in_both_of_the_publishers_sets(pickles):
    counts = count(import_games(pickles))
    assert [(c.layout, c.games, c.pairs, c.train, c.test, c.also_in_train) for c in counts] == [
        ("cramped_room", 2, 2, 1, 1, 0),
        ("forced_coordination", 1, 1, 0, 1, 1),
        ("counter_circuit", 1, 1, 1, 0, 0),
        ("all", 4, 3, 2, 2, 1),
    ]
    assert leak(counts).startswith("1 of 3 pairs are in both of the publishers' sets (0 on the same layout)")


def changed(columns, name, step, old, new):
    before = columns[name][step]
    after = before.replace(old, new) if isinstance(before, str) else new
    assert after != before
    column = [*columns[name][:step], after, *columns[name][step + 1 :]]
    return {**columns, name: column}


def changed_state(columns, step, old, new):
    """Changes the state before a step, which is that after the step before."""
    return changed(changed(columns, "state", step, old, new), "next_state", step - 1, old, new)


def imported_with(columns):
    return import_games({"train": table(columns)})


def test_a_state_that_is_not_reached_is_named_by_game_and_step(played):
    cramped = played["cramped"]
    step = next(i for i, text in enumerate(cramped["state"]) if "'onion', 3, 5]" in text)
    where = rf"set train, cramped_room, rows 0 to 99, step {step}: recorded is "
    with pytest.raises(Difference, match=rf"{where}Soup\(recipe=\(3, 0\), tick=6.* at \(2, 0\), replayed Soup.*tick=5"):
        imported_with(changed_state(cramped, step, "'onion', 3, 5]", "'onion', 3, 6]"))
    facing = re.search(r"'orientation': \[.*?\]", cramped["state"][step])[0]
    other = "'orientation': [0, 1]" if "[0, 1]" not in facing else "'orientation': [1, 0]"
    with pytest.raises(Difference, match=rf"{where}Chef\(.* on seat [01], replayed Chef"):
        imported_with(changed_state(cramped, step, facing, other))
    with pytest.raises(Difference, match=r"step 100: recorded is Chef\("):
        imported_with(changed(cramped, "next_state", 99, "'name': 'onion'", "'name': 'dish'"))


def test_a_reward_that_is_not_earned_is_named(played):
    step = played["cramped"]["reward"].index(5.0)
    with pytest.raises(Difference, match=rf"step {step}: recorded is 0 points, replayed 5"):
        imported_with(changed(played["cramped"], "reward", step, None, 0.0))


def test_another_action_shows_in_the_next_state(played):
    step = next(i for i, text in enumerate(played["cramped"]["joint_action"]) if text == "['INTERACT', 'INTERACT']")
    with pytest.raises(Difference, match=rf"step {step + 1}: "):
        imported_with(changed(played["cramped"], "joint_action", step, "'INTERACT'", "[0, 0]"))


WRONG = {
    "actions": ("joint_action", 3, None, "[[0, 2], [0, 0]]", "step 3: .* is not a joint action"),
    "three actions": ("joint_action", 3, None, "[[0, 1], [0, 0], [0, 0]]", "step 3: Expected `array` of length 2"),
    "code": ("joint_action", 3, None, "__import__('os').system('x')", "step 3:1: not JSON"),
    "no action": ("joint_action", 3, None, "['JUMP', [0, 0]]", "step 3: Invalid enum value"),
    "another layout": ("layout_name", 0, None, "random1", "row 0: a game on random1"),
    "another grid": ("layout", 5, "P", "X", "not the grid of cramped_room"),
    "a gap": ("cur_gameloop", 5, None, 6.0, "rows 0 to 99: the steps are not numbered"),
    "a break": ("next_state", 5, "'players'", "'players' ", "step 6 does not begin where step 5 ended"),
    "a long text": ("joint_action", 3, None, "[" * 5001, "5,001 characters"),
    "a deep text": ("joint_action", 3, None, "[" * 500, "inside each other"),
}


@pytest.mark.parametrize(("name", "step", "old", "new", "message"), WRONG.values(), ids=WRONG.keys())
def test_rows_that_are_no_game_are_refused(played, name, step, old, new, message):
    columns = played["cramped"]
    with pytest.raises(RecordingError, match=message):
        imported_with(changed(columns, name, step, old or columns[name][step], new))


STATES = {
    "under other rules": ("'pot_explosion': False", "'pot_explosion': True", "soups that burn"),
    "of other orders": ("['onion']", "['tomato']", "Invalid enum value"),
    "of huge soups": ("'onion', 3, 5]", "'onion', 300000000, 5]", "a soup that cannot be"),
    "with an object elsewhere": ("'2,0'", "'2,1'", "an object that is elsewhere"),
    "with more in it": ("'players'", "'clock': 3, 'players'", "unknown field"),
    "that is code": ("{'players'", "open('x') or {'players'", "not JSON"),
}


@pytest.mark.parametrize(("old", "new", "message"), STATES.values(), ids=STATES.keys())
def test_a_state_that_is_none_of_2019_is_refused(played, old, new, message):
    step = next(i for i, text in enumerate(played["cramped"]["state"]) if "'onion', 3, 5]" in text)
    with pytest.raises(RecordingError, match=rf"step {step}.*{message}"):
        imported_with(changed_state(played["cramped"], step, old, new))


def test_two_games_of_a_pair_on_a_layout_are_refused(played):
    both = {"train": table(played["cramped"]), "test": table(played["cramped"])}
    with pytest.raises(RecordingError, match="games of the same people on the same layout"):
        import_games(both)


def test_a_table_must_have_the_columns(played):
    few = {name: column for name, column in played["other"].items() if name != "reward"}
    with pytest.raises(TableError, match="no column 'reward'"):
        imported_with(few)
    with pytest.raises(TableError, match="'cur_gameloop' holds something else than float"):
        imported_with({**few, "cur_gameloop": list(range(30)), "reward": [0.0] * 30})
    with pytest.raises(TableError, match="not a pandas table"):
        import_games({"train": dumped([1, 2])})
    for text in ("a column", "O8"):  # a name, and the type of an array
        short = pickle.SHORT_BINUNICODE + bytes([len(text)]) + text.encode()
        hostile = table({"a column": ["x"]}).replace(short, b"N" + pickle.TUPLE1 * 300_000)
        with pytest.raises(TableError, match=r"no column|not a pandas table"):
            import_games({"train": hostile})
    with pytest.raises(PickleError, match="train_trials"):
        import_games({"train": b"cos\nsystem\n."})
    assert read_columns(read_pickle(table(few), "x"), {"is_leader": bool}, "x") == {"is_leader": [True] * 30}


def test_the_command_writes_a_games_file_and_says_what_it_holds(pickles, tmp_path, monkeypatch, capsys):
    file, output = tmp_path / "x.tar.gz", tmp_path / "new" / "2019.games.jsonl"
    file.write_bytes(sdist(pickles))
    wanted = ["games", "import-2019", "--file", str(file), "--output", str(output.parent)]
    assert main(wanted) == 2
    assert "and the source distribution of overcooked-ai 1.1.0 has 478bf319" in capsys.readouterr().err
    assert not output.parent.exists()

    monkeypatch.setattr(distribution, "SHA256", distribution.digest_of(file.read_bytes()))
    assert main(wanted) == 0
    said = capsys.readouterr().out
    assert "4 games, 190 joint steps, 0 differences" in said
    assert distribution.digest_of(output.read_bytes()) in said
    first = output.read_bytes()
    assert read_games(output) == import_games(pickles).games
    assert main([*wanted, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["counts"][-1]["steps"] == 190
    assert output.read_bytes() == first


def test_the_command_exits_with_1_if_a_game_differs(played, tmp_path, monkeypatch, capsys):
    wrong = table(changed(played["cramped"], "reward", 2, None, 5.0))
    file = tmp_path / "x.tar.gz"
    file.write_bytes(sdist({"train": wrong, "test": table(played["other"])}))
    monkeypatch.setattr(distribution, "SHA256", distribution.digest_of(file.read_bytes()))
    assert main(["games", "import-2019", "--file", str(file), "--output", str(tmp_path / "new")]) == 1
    assert "cramped_room, rows 0 to 99, step 2: recorded is 5 points, replayed 0" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()

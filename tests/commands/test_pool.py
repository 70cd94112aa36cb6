import json
import re

import pytest

from overcooked_bench.agents.pools.manifest import read_manifest, write_manifest
from overcooked_bench.cli import main
from tests.agents.made import record, write_policy

LAYOUT = "cramped_room"


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A working directory with a pool of three agents in `mine`."""
    monkeypatch.chdir(tmp_path)
    for seed in range(3):
        write_policy(tmp_path / "mine" / LAYOUT / f"sp-{seed}", seed)
    write_manifest(tmp_path / "mine", "mine", [record(f"sp-{seed}", seed=seed) for seed in range(3)])
    return tmp_path


def said(capsys):
    return capsys.readouterr().out


def test_show_prints_a_row_an_agent(home, capsys):
    assert main(["pool", "show", "mine"]) == 0
    told = said(capsys)
    for words in ("mine (", "3 trained agents", LAYOUT, "self-play fast", "200 [190, 210]", "100 100", "0.50", "15.0"):
        assert words in told, told


def test_the_shipped_pool_fits_100_columns_with_whole_numbers(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "100")
    assert main(["pool", "show", "v1", "--layouts", LAYOUT]) == 0
    lines = said(capsys).splitlines()
    assert max(map(len, lines)) <= 100
    (line,) = (line for line in lines if line.startswith("biased-random-0"))
    assert re.fullmatch(
        r"\S+ +biased-self-play +100 +235 \[233, 237\] +118 117 +0\.20 +37\.6 +11\.7 +157\.9 +156\.9", line
    )


def test_show_prints_the_entries_as_json(home, capsys):
    assert main(["pool", "show", "mine", "--layouts", LAYOUT, "--json"]) == 0
    entries = json.loads(capsys.readouterr().out)
    assert [entry["name"] for entry in entries] == ["sp-0", "sp-1", "sp-2"]
    assert entries[0]["training"]["profile"]["seats"][1]["pots"] == 7.5


def test_a_pool_of_format_1_is_shown_without_profile(capsys):
    assert main(["pool", "show", "dev-v0", "--layouts", LAYOUT]) == 0
    told = said(capsys)
    assert "239 [239, 240]" in told
    assert "drops  picks" not in told


def test_verify_says_whether_a_pool_is_sound(home, capsys):
    assert main(["pool", "verify", "mine"]) == 0
    assert said(capsys).endswith("sound, 3 agents played\n")
    (home / "mine" / LAYOUT / "sp-1.json").write_text("{}")
    assert main(["pool", "verify", "mine"]) == 1
    told = said(capsys)
    assert told.startswith("wrong: pool 'mine', agent cramped_room/sp-1")
    assert "not sound" in told
    assert main(["pool", "verify", "mine", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["sound"] is False


def test_a_release_candidate_is_called_one(home, capsys):
    manifest = read_manifest(home / "mine")
    write_manifest(home / "mine", "mine", manifest.entries, frozen=False)
    assert main(["pool", "verify", "mine"]) == 0
    assert said(capsys).endswith("sound, 3 agents played; a release candidate, which may still change\n")
    assert main(["pool", "show", "mine"]) == 0
    assert said(capsys).startswith(f"mine ({manifest.hash[:8]}, release candidate)")


def test_crossplay_prints_a_table_and_writes_the_matrix(home, capsys):
    arguments = ["crossplay", "mine", "--layouts", LAYOUT, "--episodes", "2", "--workers", "1"]
    assert main([*arguments, "--agents", "sp-0,sp-2"]) == 0
    told = said(capsys)
    for words in ("with strangers", "worst pair", LAYOUT, f"crossplay/mine/{LAYOUT}.png"):
        assert words in told, told
    assert {file.name for file in (home / "crossplay" / "mine").iterdir()} == {
        f"{LAYOUT}.{suffix}" for suffix in ("png", "csv", "json")
    }
    assert main([*arguments, "--output", "there", "--json"]) == 0
    (one,) = json.loads(capsys.readouterr().out)
    assert json.loads((home / "there" / f"{LAYOUT}.json").read_text()) == one
    assert len(one["means"]) == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["show", "nowhere"], "no pool named 'nowhere'"),
        (["verify", "dev-v00"], "did you mean 'dev-v0'"),
        (["show", "mine", "--layouts", "forced_coordination"], "it has cramped_room"),
        (["crossplay", "mine", "--layouts", "cramped_rom"], "it has cramped_room"),
        (["crossplay", "mine", "--agents", "x"], "no agent is named 'x'"),
        (["crossplay", "mine", "--episodes", "1"], "give a whole number from 2"),
        (["crossplay", "mine", "--workers", "many"], "give a whole number from 1"),
        ([], "COMMAND"),
    ],
    ids=["show", "verify", "show-layout", "layout", "agents", "episodes", "workers", "nothing"],
)
def test_mistakes_end_in_one_message(home, arguments, words, capsys):
    assert main(arguments if arguments[:1] == ["crossplay"] else ["pool", *arguments]) == 2
    assert words in capsys.readouterr().err


def test_verify_says_with_whom_a_pool_shares_no_person(home, capsys):
    def write(name, seed, *people):
        write_policy(home / name / LAYOUT / "sp-0", seed)
        own = {"seed": seed, "namespace": name, "lineage": name, "people": people or None}
        write_manifest(home / name, name, [record("sp-0", **own)])

    write("a", 5, "2030-00")
    write("b", 6, "2030-01")
    assert main(["pool", "verify", "a", "--against", "b", "mine"]) == 0
    assert "shares no person with b\na (" in said(capsys)
    assert main(["pool", "verify", "mine", "--against", "a"]) == 0
    assert "person" not in said(capsys), "a pool without people has none to share"
    write("c", 7, "2030-00")
    assert main(["pool", "verify", "c", "--against", "a", "b", "--json"]) == 1
    found = json.loads(said(capsys))
    assert "b" in found["shares_no_person_with"]
    assert "a" not in found["shares_no_person_with"]
    assert found["findings"][0]["grave"]
    assert main(["pool", "show", "c"]) == 0
    assert "made from games of 2030-00" in said(capsys)

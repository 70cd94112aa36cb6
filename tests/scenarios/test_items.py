import pytest

from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import items, load_items, load_scenarios, shipped_folder
from tests.scenarios.writing import POT, YIELD, edited, scenario


def ids(chosen):
    return [item.id for item in chosen]


def test_a_scenario_is_four_items():
    four = items([scenario(POT, tags="[sanity]")])
    assert ids(four) == ["T02-pot-seat0", "T02-pot-seat0-mirrored", "T02-pot-seat1", "T02-pot-seat1-mirrored"]
    assert [(item.seat, item.mirrored, item.is_pair) for item in four[:2]] == [(0, False, False), (0, True, False)]
    assert {(item.category, item.family, item.tags) for item in four} == {("state", "T02", ("sanity",))}


def test_a_pair_is_one_item():
    halves = [scenario(POT, id=f"T04-{name}", pair="T04-both", tags=f"[{name}]") for name in ("b", "a")]
    (pair,) = items(halves)
    assert (pair.id, pair.family, pair.is_pair, pair.seat, pair.tags) == (
        "T04-both-pair",
        "T04",
        True,
        None,
        ("a", "b"),
    )
    assert ids(pair.situations) == ["T04-a-seat0", "T04-a-seat1", "T04-b-seat0", "T04-b-seat1"]
    assert [s.id for s in pair.scenarios] == ["T04-a", "T04-b"]
    with pytest.raises(ScenarioError, match=r"has 1 scenarios \(T04-b\)"):
        items(halves[:1])
    for key, value in (("category", "memory"), ("family", "yield")):
        with pytest.raises(ScenarioError, match=f"differ in `{key}`"):
            items([halves[0], scenario(POT, id="T04-c", pair="T04-both", **{key: value})])


def test_an_id_is_taken_once():
    with pytest.raises(ScenarioError, match=r"the id T02-pot is taken by test\.yaml"):
        items([scenario(POT), scenario(POT)])


def test_words_choose_among_what_ships():
    everything = load_items()
    assert ids(everything) == sorted(ids(everything))
    assert ids(load_items("S01")) == ids(load_items("S01-drop-dish-for-onion")) == ids(load_items("S01-*"))
    assert len(load_items("S01")) == 4
    assert ids(load_items("S01-*seat1")) == ids(load_items(["S01-drop-dish-for-onion-seat1"]))
    assert {item.category for item in load_items(["convention", "S01"])} == {"convention", "state"}
    assert [s.id for s in load_scenarios(["S01", "C04"])] == ["C04-yield-pot-cell", "S01-drop-dish-for-onion"]
    with pytest.raises(ScenarioError, match="did you mean 'S01-drop-dish-for-onion'"):
        load_items("S01-drop-dish-for-onoin")
    with pytest.raises(ScenarioError, match="no scenario fits 'S0'"):
        load_items(["S01", "S0"])


def test_paths_are_read(tmp_path):
    (tmp_path / "T02-pot.scenario.yaml").write_text(POT)
    (tmp_path / "T01-yield.scenario.yaml").write_text(YIELD)
    assert len(load_items(tmp_path)) == len(load_items(f"{tmp_path}/")) == 8
    assert ids(load_items(str(tmp_path / "T02-pot.scenario.yaml"))) == ids(items([scenario(POT)]))
    assert len(load_items([tmp_path / "T02-pot.scenario.yaml", tmp_path, "S01"])) == 12
    with pytest.raises(ScenarioError, match="cannot be read"):
        load_items("none.scenario.yaml")
    with pytest.raises(ScenarioError, match="no scenarios in this folder"):
        load_items(tmp_path.parent)


def test_the_other_half_of_a_pair_is_found_beside_it(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"T04-{name}.scenario.yaml").write_text(edited(POT, id=f"T04-{name}", pair="T04-both"))
    assert ids(load_items(tmp_path / "T04-b.scenario.yaml")) == ["T04-both-pair"]


def test_the_shipped_folder_is_a_package_with_a_schema():
    assert (shipped_folder() / "__init__.py").is_file()
    assert (shipped_folder() / "schema.json").is_file()

import subprocess
import sys

import pytest

from overcooked_bench import Chef, KitchenState, Soup
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import shipped_folder
from overcooked_bench.scenarios.language.loading import load_scenario, read_scenario
from overcooked_bench.scenarios.language.writing import scenario_text
from overcooked_bench.scenarios.solving.lock import definition
from tests.scenarios.writing import POT, YIELD, edited, scenario


def test_a_file_becomes_a_scenario():
    read = scenario(YIELD, tags="[sanity]", never="pot(2).n > 0")
    assert (read.id, read.category, read.family, read.tags) == ("T01-yield", "convention", "T01", ("sanity",))
    assert (read.layout.name, read.cooking, read.budget, read.pair) == ("coordination_ring", "auto", 15, None)
    assert (str(read.accept), str(read.never)) == ("B.pot >= 1 and A.holds(dish)", "pot(2).n > 0")
    chefs = Chef((3, 1)), Chef((2, 1), "east", "onion")
    assert read.state == KitchenState(chefs, {(3, 0): Soup((2, 0))})


def test_what_lies_and_cooks_is_read():
    kitchen = "|\n  XoPsX\n  O A O\n  d  BX\n  XDXSX"
    text = POT.replace("|\n  XXPXX\n  O A O\n  X  BX\n  XDXSX", kitchen).replace("holds: onion", "holds: soup")
    read = scenario(text, pots="{1: cooking 8 left}")
    soup = Soup((3, 0), 20, 20)
    assert read.state.objects == {(1, 0): "onion", (2, 0): Soup((3, 0), 12, 20), (3, 0): soup, (0, 2): "dish"}
    assert read.state.chefs[0].holding == soup
    assert scenario(pots="{1: ready}").state.objects == {(2, 0): soup}


def test_both_seats_and_mirrors():
    read = scenario(YIELD, before="{A: [left, up], B: [right, stay]}", accept="A.x <= 1 and A.pot(at=1) >= 1")
    plain, mirrored = read.seated(1), read.seated(1, mirrored=True)
    assert (plain.id, mirrored.id) == ("T01-yield-seat1", "T01-yield-seat1-mirrored")
    assert plain.before == ((2, 3), (4, 0))
    assert mirrored.before == ((3, 2), (4, 0))
    assert mirrored.layout.name == "coordination_ring-mirrored"
    assert mirrored.state.chefs == (Chef((2, 1), "west", "onion"), Chef((1, 1)))
    assert mirrored.state.objects == {(1, 0): Soup((2, 0))}
    assert str(mirrored.accept) == "A.x >= 3 and A.pot(at=1) >= 1"


def test_a_pair_of_pots_in_one_row_changes_numbers_in_the_mirror():
    text = YIELD.replace("coordination_ring", "counter_circuit").replace(
        "  XXXPX\n  X BAP\n  D X X\n  O   X\n  XOSXX\n",
        "  XXXPPXXX\n  X  BA  X\n  D XXXX S\n  X      X\n  XXXOOXXX\n",
    )
    read = scenario(text, accept="pot(1).n == 3 and A.at(4, 1)", never="pot(2).ready")
    mirrored = read.seated(0, mirrored=True)
    assert (str(mirrored.accept), str(mirrored.never)) == ("pot(2).n == 3 and A.at(3, 1)", "pot(1).ready")


WRONG = {
    "unknown_key": (dict(acept="A.pot >= 1"), 14, "unknown key `acept`; did you mean 'accept'"),
    "missing_key": (dict(why=""), 1, "`why` is missing"),
    "category": (dict(category="states"), 2, "choose one of state, partner"),
    "id": (dict(id="a/b"), 1, "letters, digits"),
    "tags": (dict(tags="sanity"), 14, "list of words"),
    "layout": (dict(layout="cramped_roon"), 3, "did you mean 'cramped_room'"),
    "layout_file": (dict(layout="../secret.layout"), 3, "Shipped are cramped_room"),
    "cooking": (dict(cooking="slow"), 14, "auto, manual"),
    "facing": (dict(A="{facing: north}"), 9, "up or down or right or left"),
    "facing_list": (dict(A="{facing: [up]}"), 9, r"`facing` is \['up'\]; write up or down"),
    "facing_mapping": (dict(B="{facing: {up: 1}, does: frozen}"), 10, "`facing` is"),
    "holds_list": (dict(A="{facing: up, holds: [dish]}"), 9, "`holds` is"),
    "null_character": (dict(why="a\0b"), 13, "the character"),
    "escape": (dict(why='"\\e[31m"'), 13, "the character"),
    "no_integer": (dict(budget="!!int ''"), 12, "the tag"),
    "no_truth": (dict(why="!!bool x"), 13, "the tag"),
    "infinite": (dict(budget=".inf"), 12, "not a finite number"),
    "no_facing": (dict(A="{holds: dish}"), 9, "no `facing`"),
    "holds": (dict(A="{facing: up, holds: pan}"), 9, "onion or tomato or dish or soup"),
    "chef_key": (dict(A="{facing: up, hold: dish}"), 9, "did you mean 'holds'"),
    "chef_is_text": (dict(A="up"), 9, "write a mapping"),
    "behaviour": (dict(B="{facing: up, does: frozn}"), 10, "did you mean 'frozen'"),
    "behaviour_key": (dict(B="{facing: up, does: carry, insit: true}"), 10, "did you mean 'insist'"),
    "no_counter": (dict(B="{facing: up, does: dumper, counters: [[1, 1]]}"), 10, r"\[1, 1\] is no counter"),
    "outside": (dict(B="{facing: up, does: goto, cell: [9, 9]}"), 10, "outside the layout"),
    "then": (dict(B="{facing: up, does: carry, then: {does: goto, cell: [0, 0]}}"), 10, "no floor"),
    "pot_number": (dict(pots="{2: ready}"), 14, "no pot 2"),
    "pot_content": (dict(pots="{1: 4 onions}"), 14, "pot 1 is '4 onions'"),
    "pot_full": (dict(pots="{1: 3 onions}"), 14, "cooking 20 left"),
    "pot_long": (dict(pots="{1: cooking 21 left}"), 14, "cooks 20 steps"),
    "accept": (dict(accept="A.pot > = 1"), 11, "no condition"),
    "accept_list": (dict(accept="[]"), 11, "a condition, or a list"),
    "never": (dict(never="A.pots >= 1"), 14, "did you mean 'pot'"),
    "budget": (dict(budget="0"), 12, "1 to 200"),
    "before_length": (dict(before="{A: [up], B: [up, up]}"), 14, "1 of A and 2 of B"),
    "before_action": (dict(before="{A: [upp]}"), 14, "did you mean 'up'"),
    "before_chef": (dict(before="{C: [up]}"), 14, "unknown key `C`"),
    "before_empty": (dict(before="{}"), 14, "has none"),
    "twice": (dict(why="x\nwhy: y"), 14, "written twice"),
    "tag": (dict(why="!!python/object/apply:os.getcwd []"), 13, "not allowed"),
    "date": (dict(why="2020-01-01"), 13, "is a timestamp in YAML"),
    "reference": (dict(why="&a x\nfamily: *a"), 13, "references"),
    "unclosed": (dict(why="[x"), 14, "not YAML"),
    "deep": (dict(pots="{1: " + "[" * 20 + "]" * 20 + "}"), 14, "inside each other"),
    "bottomless": (dict(pots="[" * 3000), 14, "inside each other"),
}


@pytest.mark.parametrize(("changes", "line", "message"), WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_is_told_with_its_line(changes, line, message):
    with pytest.raises(ScenarioError, match=message) as caught:
        scenario(**changes)
    assert str(caught.value).startswith(f"test.yaml:{line}: ")


PICTURES = {
    "tile": ("  O A O", "  O A X", 6, r"column 4 \(from 0\) is 'X', but the layout has 'O'"),
    "chef_in_wall": ("  O A O", "  A   O", 6, "chefs stand on the floor"),
    "thing_on_floor": ("  O A O", "  Oo AO", 6, "is for an object on a counter"),
    "two_chefs": ("  X  BX", "  X AAX", 7, "second time"),
    "no_chef": ("  O A O", "  O   O", 5, "no chef A"),
    "too_wide": ("  O A O", "  O A OX", 6, "the layout is 5 wide"),
    "too_narrow": ("  O A O", "  O A", 6, "the layout is 5 wide"),
    "too_high": ("  XDXSX", "  XDXSX\n  XXXXX", 9, "5 rows, the layout 4"),
    "too_low": ("  XDXSX\n", "", 7, "3 rows, the layout 4"),
}


@pytest.mark.parametrize(("old", "new", "line", "message"), PICTURES.values(), ids=PICTURES.keys())
def test_a_picture_that_disagrees_is_told_with_its_line(old, new, line, message):
    with pytest.raises(ScenarioError, match=message) as caught:
        read_scenario(POT.replace(old, new), "test.yaml")
    assert str(caught.value).startswith(f"test.yaml:{line}: ")


def test_files_that_are_none(tmp_path):
    with pytest.raises(ScenarioError, match="cannot be read"):
        load_scenario(tmp_path / "none.scenario.yaml")
    (tmp_path / "latin.scenario.yaml").write_bytes("why: Käse".encode("latin-1"))
    with pytest.raises(ScenarioError, match="UTF-8"):
        load_scenario(tmp_path / "latin.scenario.yaml")
    (tmp_path / "other.scenario.yaml").write_text(POT)
    with pytest.raises(ScenarioError, match="'T02-pot' and the file is named 'other'"):
        load_scenario(tmp_path / "other.scenario.yaml")
    (tmp_path / "T02-pot.scenario.yaml").write_text(POT)
    assert load_scenario(tmp_path / "T02-pot.scenario.yaml").id == "T02-pot"
    for text in ("", "- 1", "x" * 70_000):
        with pytest.raises(ScenarioError, match=":1: "):
            read_scenario(text, "x.yaml")


RICH = edited(
    YIELD,
    B="{facing: right, holds: onion, does: script, actions: [up, stay*2], then: {does: goto, cell: [1, 1]}}",
    pots="{1: 2 onions, 2: cooking 7 left}",
    accept="[A.holds(dish), not (B.x < 2 or score >= 20)]",
    never="counter(2, 2) == onion",
    before="{A: [left, stay], B: [up, interact]}",
    family="other",
    tags="[sanity, new]",
    pair="P1",
    why="'It says: \"yes\" # no'",
)


@pytest.mark.parametrize("text", [YIELD, POT, RICH], ids=["yield", "pot", "rich"])
def test_what_is_written_reads_back_the_same(text):
    read = read_scenario(text, "x.yaml")
    again = read_scenario(scenario_text(read), "x.yaml")
    assert definition(again) == definition(read)
    for name in ("id", "category", "family", "tags", "layout", "state", "accept", "never", "before", "pair", "why"):
        assert getattr(again, name) == getattr(read, name)


def test_a_grid_of_ones_own_reads_back_the_same():
    own = edited().replace("layout: cramped_room", "layout: |\n  XXPXX\n  O   O\n  X   X\n  XDXSX")
    read = read_scenario(own, "x.yaml")
    assert read.layout.name == "XXPXX\nO   O\nX   X\nXDXSX"
    assert read_scenario(scenario_text(read), "x.yaml").layout == read.layout


def test_what_ships_is_read_without_anything_heavy():
    code = (
        "import sys\nfrom overcooked_bench.scenarios.items import load_items\n"
        "print(len(load_items()), *({'numba', 'torch', 'scipy', 'matplotlib'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert int(done.stdout) >= 4 * 3


def test_every_shipped_file_says_why():
    for file in sorted(shipped_folder().glob("*.scenario.yaml")):
        assert len(load_scenario(file).why) > 20

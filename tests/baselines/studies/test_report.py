"""The report counts what the plan says, and refuses what it must not count."""

import json

import msgspec
import pytest

from overcooked_bench.baselines.studies.thesis_claim.command import main
from overcooked_bench.baselines.studies.thesis_claim.power import power_table
from overcooked_bench.baselines.studies.thesis_claim.records import joined, read_record, write_record
from overcooked_bench.baselines.studies.thesis_claim.registered import check_registered, present
from overcooked_bench.baselines.studies.thesis_claim.report import make_result
from overcooked_bench.baselines.studies.thesis_claim.study import HOME, MAIN, RECIPE, StudyError, load_study
from tests.baselines.studies.made import copied_study, write_blocks

EQUAL = {"l0": (0.3, 0.3), "sp-long": (0.3, 0.3)}
BETTER = {"l0": (0.5, 0.5), "sp-long": (0.3, 0.3)}


def result_of(home, study, ended=False):
    return make_result(study, home, *check_registered(home), ended)


def test_the_shipped_study_is_what_was_registered_and_its_plan_has_the_figures_of_power():
    study = load_study(HOME)
    known, _ = check_registered(HOME)
    assert known.hashes == present(HOME).hashes
    plan = (HOME / "plan.md").read_text()
    assert power_table(study.part(MAIN).blocks) in plan
    for text in (study.play_sha256, study.pool_sha256):
        assert text in plan


@pytest.mark.parametrize(
    ("means", "spread", "said"),
    [(BETTER, 0.05, "Supported: the population"), (EQUAL, 0.02, "Refuted: a difference"), (EQUAL, 0.6, "Undecided")],
)
def test_the_page_says_what_the_blocks_say(tmp_path, means, spread, said):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, means, spread)
    write_blocks(home, study, {"r0": (0.3, 0.3)}, spread, part="rows", seed=1)
    assert main(["--study", str(home), "report"]) == 0
    page = (home / "results" / "result.md").read_text()
    assert page.count(said) == 2
    known, _ = check_registered(home)
    for sha256 in (known.plan, known.recipe, known.code_sha256):
        assert sha256[:16] in page
    assert "40 of 40 planned on forced_coordination, 20 of 20 planned on counter_circuit" in page
    assert "| forced_coordination | home    | sp - sp-2" in page
    assert "r0 - sp-long" in page
    content = json.loads((home / "results" / "result.json").read_text())
    assert [test["layout"] for test in content["primary"]] == ["forced_coordination"] * 2
    assert {path.name for path in (home / "results").glob("*.png")} == {"differences.png", "blocks.png"}


def test_a_run_that_failed_counts_as_0(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, 0.0, failed=["l0"])
    result = result_of(home, study)
    found = result.primary[0]
    assert found.means == pytest.approx((0.5 * 39 / 40, 0.3))
    (arm,) = (one for one in result.arms if (one.layout, one.arm) == ("forced_coordination", "l0"))
    assert (arm.blocks, arm.failed) == (40, 1)
    assert arm.n == pytest.approx(dict.fromkeys(arm.n, 0.5 * 39 / 40))


def test_nothing_is_looked_at_before_all_blocks_are_there(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, counts={"forced_coordination": 39})
    with pytest.raises(StudyError, match="39 of 40 blocks are there, and nothing is looked at before all are"):
        result_of(home, study)
    assert result_of(home, study, ended=True).blocks["forced_coordination"] == (39, 40)


def test_blocks_after_a_missing_one_do_not_count(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    (home / "results" / "main-forced_coordination-07.json").unlink()
    assert result_of(home, study, ended=True).primary[0].found.blocks == 7
    for index in range(20):
        (home / "results" / f"main-counter_circuit-{index:02}.json").unlink()
    result = result_of(home, study, ended=True)
    assert result.blocks == {"forced_coordination": (7, 40), "counter_circuit": (0, 20)}
    assert {test.layout for test in (*result.secondary, *result.null)} == {"forced_coordination"}
    for index in range(2, 40):
        (home / "results" / f"main-forced_coordination-{index:02}.json").unlink(missing_ok=True)
    (home / "results" / "main-forced_coordination-01.json").unlink()
    with pytest.raises(StudyError, match="1 blocks are there; two are the least"):
        result_of(home, study, ended=True)


def test_the_pilot_enters_nothing_but_the_cost(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    before = result_of(home, study)
    write_blocks(home, study, {"l0": (9.0, 9.0)}, part="pilot")
    after = result_of(home, study)
    assert after.hours["pilot"] > before.hours["pilot"] == 0
    assert msgspec.structs.replace(after, hours={}) == msgspec.structs.replace(before, hours={})


def changed(home, name, change):
    file = home / "results" / name
    write_record(change(read_record(file)), file)


def test_a_block_that_lacks_an_arm_is_refused(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    name = "main-counter_circuit-03.json"
    changed(home, name, lambda one: msgspec.structs.replace(one, arms=one.arms[:-1]))
    with pytest.raises(StudyError, match=r"03\.json lacks the arm l0.*run main --layouts counter_circuit --blocks 3-3"):
        result_of(home, study)


def test_a_block_of_another_plan_is_refused(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    changed(home, "main-forced_coordination-00.json", lambda one: msgspec.structs.replace(one, plan="0" * 64))
    with pytest.raises(StudyError, match="was made under another plan or recipe"):
        result_of(home, study)


def test_a_block_that_was_not_scored_as_registered_is_refused(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)

    def unscored(one):
        arms = [msgspec.structs.replace(arm, scores={"1" * 64: arm.scores[study.play_sha256]}) for arm in one.arms]
        return msgspec.structs.replace(one, arms=tuple(arms))

    changed(home, "main-forced_coordination-00.json", unscored)
    with pytest.raises(StudyError, match=f"has no score under the protocol {study.play_sha256[:8]}"):
        result_of(home, study)


@pytest.mark.parametrize("file", ["plan.md", RECIPE])
def test_a_changed_plan_or_recipe_is_noticed(tmp_path, capsys, file):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    (home / file).write_text((home / file).read_text() + "# One word more.\n")
    for command in (["report"], ["run"], ["costs"]):
        assert main(["--study", str(home), *command]) == 2
        assert f"{file} is not what was registered" in capsys.readouterr().err


def test_changed_code_is_named_on_the_page(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER)
    known = json.loads((home / "registered.json").read_text())
    known["code"]["analysis.py"] = "0" * 64
    (home / "registered.json").write_text(json.dumps(known))
    (home / "deviations.md").write_text("- Block 3 was trained on another machine.\n")
    assert main(["--study", str(home), "report"]) == 0
    page = " ".join((home / "results" / "result.md").read_text().split())
    assert "Changed since: `analysis.py`." in page
    assert "- Block 3 was trained on another machine." in page


def test_what_was_run_cannot_be_registered(tmp_path, capsys):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, counts={"forced_coordination": 1, "counter_circuit": 0})
    assert main(["--study", str(home), "register"]) == 2
    assert "what has been run cannot be registered" in capsys.readouterr().err


def test_scores_with_a_later_pool_stand_beside_and_decide_nothing(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, 0.05)
    before = result_of(home, study)
    for file in (home / "results").glob("main-*.json"):
        record = read_record(file)
        arms = []
        for arm in record.arms:
            score = msgspec.structs.replace(
                arm.scores[study.play_sha256], pool="later", n=dict.fromkeys(("own", "a"), 0.1)
            )
            arms.append(msgspec.structs.replace(arm, scores={"2" * 64: score}))
        write_record(joined(record, msgspec.structs.replace(record, arms=tuple(arms))), file)
    after = result_of(home, study)
    assert after.primary == before.primary
    (other,) = after.others
    assert (other.play, other.pool) == ("2" * 64, "later")
    assert [test.found.value for test in other.primary] == [0.0, 0.0]


def test_other_agents_do_not_take_the_place_of_a_record(tmp_path):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, counts={"forced_coordination": 1})
    record = read_record(home / "results" / "main-forced_coordination-00.json")
    arms = tuple(msgspec.structs.replace(arm, weights="another") for arm in record.arms)
    with pytest.raises(StudyError, match="give the --runs that the record was made from"):
        joined(record, msgspec.structs.replace(record, arms=arms))


def test_costs_and_power_show_no_score(tmp_path, capsys):
    home, study = copied_study(tmp_path)
    write_blocks(home, study, BETTER, part="pilot")
    assert main(["--study", str(home), "costs"]) == 0
    said = capsys.readouterr().out
    assert "| pilot, forced_coordination | 2 of 2 | sp 3, sp-2 3" in said
    assert "0.5" not in said
    assert main(["--study", str(home), "power"]) == 0
    assert "forced_coordination, home" in capsys.readouterr().out

"""Blocks are trained, scored and recorded; agents of a block share what the recipe says."""

import json
import shutil

import pytest

from overcooked_bench.agents.policies.policy import PolicyError, load_policy, policy_files
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines import population
from overcooked_bench.baselines.studies.thesis_claim import training
from overcooked_bench.baselines.studies.thesis_claim.command import main
from overcooked_bench.baselines.studies.thesis_claim.records import ArmRecord, BlockRecord, read_record
from overcooked_bench.baselines.studies.thesis_claim.study import (
    HOME,
    MAIN,
    RECIPE,
    Block,
    StudyError,
    blocks,
    load_study,
)
from overcooked_bench.baselines.studies.thesis_claim.training import policy_of, train_arm
from overcooked_bench.baselines.studies.thesis_claim.view import play_view, read_view
from tests.baselines.studies.made import tiny_study

LAYOUT = "forced_coordination"
NO_HASHES = ("", "")


@pytest.mark.slow
def test_two_blocks_from_the_first_step_to_the_page(tmp_path, capsys):
    home, runs = tiny_study(tmp_path), tmp_path / "runs"
    run = ["--study", str(home), "run", "--runs", str(runs), "--workers", "2"]
    assert main(run) == 0
    said = capsys.readouterr().out
    assert f"main, {LAYOUT}: 2 of 2 blocks are there" in said
    records = [read_record(home / "results" / f"main-{LAYOUT}-{index:02}.json") for index in range(2)]
    for record in records:
        assert [one.arm for one in record.arms] == ["sp", "sp-2", "sp-long", "sa", "pp", "nd", "l0"]
        assert all(set(one.scores[next(iter(record.plays))].n) > {"own", "human"} for one in record.arms)
        arms, folder = record.by_arm, runs / "blocks" / LAYOUT / f"{record.index:02}"
        five = sorted([arms["sp"].weights, arms["sp-2"].weights])
        for arm in ("pp", "nd", "l0"):
            config = json.loads((folder / arm / ("config.json" if arm == "pp" else "agent-0/config.json")).read_text())
            assert sorted(config["partner_hashes"]) == five
        assert not (folder / "nd" / "final-1").exists()
        assert arms["l0"].total_steps == 2 * 128 + 128 + 192
        for arm in arms:
            assert load_policy(policy_of(load_study(home), record, arm, runs)).sha256 == arms[arm].weights
        first = [load_policy(policy_files(folder / arm / "agent-0" / "policy").weights).sha256 for arm in ("nd", "l0")]
        assert first[0] != first[1]  # after so few steps the final agents are the same: their seeds are
    assert len({one.weights for record in records for one in record.arms if one.arm != "nd"}) == 12

    shutil.rmtree(home / "results")
    assert main(run) == 0  # finished runs are neither trained nor scored again
    assert [read_record(home / "results" / f"main-{LAYOUT}-{index:02}.json") for index in range(2)] == records
    assert main(["--study", str(home), "report"]) == 0
    assert (home / "results" / "result.md").read_text().count("l0 - sp-long") >= 4


def test_numbers_that_become_undefined_are_a_failed_run_and_other_errors_are_not(tmp_path, monkeypatch):
    block = Block(load_study(HOME), MAIN, LAYOUT, 0, NO_HASHES)

    def broken(error):
        def train(*_, **__):
            raise error

        return train

    for error, said in (
        (ValueError("Expected parameter logits"), "ValueError: Expected parameter logits"),
        (FloatingPointError("overflow"), "FloatingPointError: overflow"),
        (
            PolicyError("/a/folder/policy.safetensors: w holds undefined numbers"),
            "policy.safetensors: w holds undefined",
        ),
    ):
        monkeypatch.setattr(population, "train", broken(error))
        outcome = train_arm(block, "l0", tmp_path)
        assert isinstance(outcome, str)
        assert outcome.startswith(said)
    for other in (StudyError("wrong use"), OSError("the disk is full")):
        monkeypatch.setattr(population, "train", broken(other))
        with pytest.raises(type(other)):
            train_arm(block, "l0", tmp_path)


def test_seeds_of_blocks_differ_and_arms_of_a_block_have_those_of_the_plan(tmp_path):
    study = load_study(HOME)
    everything = [block for part in ("pilot", "main") for block in blocks(study, part, NO_HASHES)]
    assert len({block.seed for block in everything}) == len(everything) == 64
    first, rows = next(blocks(study, MAIN, NO_HASHES)), next(blocks(study, "rows", NO_HASHES))
    assert (first.seed, first.path) == (rows.seed, rows.path)
    own = {arm: training._place(first, arm, tmp_path).seed for arm in study.part(MAIN).arms}
    assert len(set(own.values())) == 5
    assert own["pp"] == own["nd"] == own["l0"] == first.seed


def test_arms_have_the_steps_of_the_plan():
    study = load_study(HOME)
    for layout in study.part(MAIN).blocks:
        steps = {arm: study.settings(arm, layout).steps for arm in ("sp-long", "sa", "pp")}
        assert set(steps.values()) == {3_000_000}
        assert [one.steps for one in study.self_play(layout)] == [1_000_000] * 5
        for arm in ("nd", "l0"):
            settings = study.settings(arm, layout)
            assert settings.steps * settings.final_factor == 3_000_000


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[sp, sp-2,", "[spp, sp-2,", "part pilot has the arm 'spp'"),
        ("{number: 1}", "{number: 5}", "arm sp-2: number 5; a block has 5"),
        ("agents: 5", "agents: 4", "arm nd: its initial agents are not those of pp"),
        ("config: fast", "config: fats", "arm sp-long: self-play has no configuration 'fats'"),
        ("view: 20", "sight: 20", "unknown key `sight`"),
    ],
)
def test_a_recipe_that_cannot_be_run_is_refused(tmp_path, old, new, said):
    (tmp_path / RECIPE).write_text((HOME / RECIPE).read_text().replace(old, new, 1))
    with pytest.raises(StudyError, match=said):
        load_study(tmp_path)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "maim"], "the study has no part 'maim'; it has pilot, main"),
        (["run", "--layouts", "coordination_ring"], "part main has no blocks on 'coordination_ring'"),
        (["run", "--blocks", "38-40"], "part main has no block 40 on forced_coordination; it has 0 to 39"),
        (["view"], "no main blocks are there on forced_coordination; run them first"),
    ],
)
def test_wrong_use_is_explained(capsys, arguments, said, tmp_path):
    shutil.copytree(HOME, tmp_path / "study", ignore=shutil.ignore_patterns("results"))
    assert main(["--study", str(tmp_path / "study"), *arguments]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.slow
def test_the_thesis_view_omits_pairs_of_one_block(tmp_path):
    study, source, records = load_study(HOME), Pool.load("dev-v1"), []
    agents = [agent for agent in source.agents(LAYOUT) if agent.trained.done == 1][:6]
    for index in range(3):
        arms = []
        for arm, agent in zip(("sp", "l0"), agents[2 * index :], strict=False):
            block = Block(study, MAIN, LAYOUT, index, NO_HASHES)
            place = training._place(block, arm, tmp_path / "runs" / block.path)
            stems = source.folder / LAYOUT / agent.name, place.folder / "policy"
            place.folder.mkdir(parents=True)
            for old, new in zip(*map(policy_files, stems), strict=True):
                shutil.copy(old, new)
            arms.append(ArmRecord(arm=arm, seed=index, weights=agent.sha256))
        record = BlockRecord(
            part=MAIN, layout=LAYOUT, index=index, plan="", recipe="", versions={}, scoring_seconds=0, arms=tuple(arms)
        )
        records.append(record)
    (tmp_path / "results").mkdir()
    view = play_view(study, LAYOUT, records, tmp_path / "runs", tmp_path, 1)
    assert read_view(tmp_path, LAYOUT) == view
    assert [(one.entrant, one.rows) for one in view.figure.lines] == [("self-play", 3), ("l0", 3)]
    assert len(view.figure.curves[1].rows) == 3
    steps = {round(value, 3) for value in view.figure.curves[1].mean}
    assert len(steps) <= 2  # each plays with the self-play agents of the two other blocks

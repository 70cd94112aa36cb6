"""The tables of RESULTS.md say what was measured and whether it is enough; part of the ordinary run."""

import pytest

from tests.benchmarks.results import (
    circumstances,
    kitchen_table,
    millions,
    partner_table,
    shares_table,
    start_table,
    training_table,
    write_section,
)
from tests.benchmarks.score_tables import cost_table, parts_table
from tests.benchmarks.time_to_return import Run, Trainer, times_table


def test_a_section_is_written_between_its_markers_and_the_others_stay(tmp_path):
    path = tmp_path / "RESULTS.md"
    write_section("peers", "theirs\n", path)
    write_section("speed", "old\n", path)
    before = path.read_text()
    write_section("speed", r"new \1" + "\n", path)
    assert before.count("old\n") == 1
    assert path.read_text() == before.replace("old\n", r"new \1" + "\n")
    assert "theirs\n" in path.read_text()
    with pytest.raises(ValueError, match=r"RESULTS\.md has no markers '<!-- memory: begin -->'"):
        write_section("memory", "", path)


def runs(*seconds):
    return {"forced_coordination": [Run(10.0, value, 1_500_000) for value in seconds]}


@pytest.mark.parametrize(
    ("theirs", "told"),
    [
        ((60.0, 70.0, 80.0), "70 s (60 to 80) | 1.50 M (1.50 to 1.50) | we take 0.57 of it, at most 0.8: met |"),
        ((45.0, None, 45.0), "45 s (45 to 45), 1 of 3 not | 1.50 M (1.50 to 1.50), 1 of 3 not | we take 0.89 of it, "),
        (
            (None, 45.0, None),
            "not reached (45 to 45), 2 of 3 not | not reached (1.50 to 1.50), 2 of 3 not | at most 0.8",
        ),
    ],
)
def test_a_time_to_a_return_is_judged_by_the_medians(theirs, told):
    ours = Trainer("ours", "", "", "1, fast", runs(30.0, 40.0, 50.0))
    first, second = times_table([ours, Trainer("theirs", "", "", "2", runs(*theirs))], 160.0).splitlines()[-2:]
    cells = ["10 s (10 to 10)", "30 s (20 to 40)", "40 s (30 to 50)", "1.50 M (1.50 to 1.50)", "-"]
    assert first == f"| forced_coordination: ours 1, fast | {' | '.join(cells)} |"
    assert told in second


def kitchens(what, median, best):
    extra = {"layout": "cramped_room 5x4", "kitchens": 256, "what": what}
    return {"extra_info": extra, "stats": {"median": median, "min": best}}


@pytest.mark.parametrize(
    ("microseconds", "told"),
    [(16.0, "0.18 met, 0.25 met; 15.0 M/s met"), (20.0, "0.18 met, 0.25 **missed**; 15.0 M/s **missed**")],
)
def test_a_ratio_is_that_of_the_times(microseconds, told):
    benches = [
        kitchens("copy by numpy", 8e-6, 8e-6),
        kitchens("compiled copy", 4e-6, 3e-6),
        kitchens("step and observe", microseconds * 1e-6, 15e-6),
    ]
    row = kitchen_table(benches).splitlines()[-1]
    assert f"| {4 / microseconds:.2f} (0.20) | {8 / microseconds:.2f} (0.53) |" in row
    assert told in row


def test_the_first_call_is_judged_by_its_own_time():
    extra = {"what": "import, first reset, step and observe, warm cache", "first_call": [0.8, 0.9, 1.4]}
    row = start_table([{"extra_info": extra, "stats": {"median": 1.5, "min": 1.2}}]).splitlines()[-1]
    assert row.endswith("| 1.50 s (1.20) | 0.90 s (0.80) | under 1 s: met |")


@pytest.mark.parametrize(("ratio", "told"), [(1.2, "1.20 times stay, at most 1.6: met"), (1.7, "1.6: **missed**")])
def test_partners_are_judged_by_their_ratio_to_stay(ratio, told):
    extra = {"what": "against four", "joint_steps": 100, "ratio_to_stay": ratio, "stay_median": 0.01, "stay_min": 5e-3}
    bench = {"group": "an update", "extra_info": extra, "stats": {"median": 0.02, "min": 0.01}}
    stay, four = partner_table([bench]).splitlines()[-2:]
    assert stay == "| an update: against stay | 10.00 ms (5.00) | 10.0 k (20.0 k) | - |"
    assert four.startswith("| an update: against four | 20.00 ms (10.00) | 5.0 k (10.0 k) | ")
    assert four.endswith(f"{told} |")


def learning(median):
    parts = {"all": 2.0, "rollout": 0.8, "network": 0.3, "kitchens": 0.1, "update": 1.0}
    extra = {"configuration": "fast", "grid": "5x5", "threads": 1, "what": "fast 5x5", "joint_steps": 12_800}
    extra |= {"bound_median": 0.5, "bound_min": 0.4, "ratio_to_bound": 1.75}
    extra["parts"] = parts | {"update, networks alone": 0.7, "rollout, networks alone": 0.25}
    return [{"extra_info": extra, "stats": {"median": median, "min": 0.64}}]


@pytest.mark.parametrize(("median", "told"), [(0.8, "15.0 k/s: met"), (1.0, "15.0 k/s: **missed**")])
def test_learning_is_judged_by_its_steps_a_second(median, told):
    row = training_table(learning(median)).splitlines()[-1]
    assert row == f"| fast 5x5 | {12.8 / median:.1f} k (20.0 k) | 25.6 k (32.0 k) | 1.75 | {told} |"


def test_the_shares_of_learning_are_all_of_it():
    row = shares_table(learning(1.0)).splitlines()[-1]
    assert row == "| fast 5x5 | 15% | 5% | 20% | 35% | 15% | 10% |"


def test_rates_are_written_short():
    assert [millions(rate) for rate in (28.44e6, 0.311e6, 12.4e3)] == ["28.4 M", "0.31 M", "12.4 k"]


def test_the_machine_is_told_without_its_name():
    info = {"cpu": {"brand_raw": "A CPU", "count": 2}, "node": "secret", "machine": "x86_64", "system": "Linux"}
    info |= {"python_version": "3.11.7", "libraries": {"numpy": "2.4"}}
    told = circumstances(info, {"id": "0123456789abcdef", "dirty": False}, "2026-11-22T01:02:03")
    assert told == "A CPU, 2 cores, Linux; Python 3.11.7, numpy 2.4. 2026-11-22, commit 0123456789ab."


def test_a_score_is_judged_on_two_cores():
    extra = {"kind": "score", "agent": "mlp", "what": "an agent", "joint_steps": 1_360_000, "ratio_to_networks": 2.25}
    extra |= {"seconds": 34.0, "parts": {"kitchens": 0.2, "partners": 0.45, "agent": 0.125, "scripts": 0.125}}
    one, five = cost_table([{"extra_info": extra}]).splitlines()[-2:]
    assert one == "| an agent | 34.0 s | 40.0 k | 17.0 s, at most 20 s: met | 2.2, at most 4: met |"
    assert five == "| 5 training seeds of it | 170.0 s | 40.0 k | 85.0 s, at most 90 s: met | - |"
    assert parts_table([{"extra_info": extra}]).splitlines()[-1] == "| an agent | 20% | 45% | 12% | 12% | 10% |"

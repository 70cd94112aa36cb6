"""Recorded episodes of the reference kitchen, replayed value by value (tests/data/golden/README.md)."""

from pathlib import Path

import pytest

from overcooked_bench import Layout
from tests.kitchen.replay import read_golden, replay_golden

GOLDEN = Path(__file__).parents[2] / "data" / "golden"
RECORDINGS = sorted(GOLDEN.glob("*/*.npz"))
SHIPPED = {
    "asymmetric_advantages": "asymmetric_advantages",
    "coordination_ring": "coordination_ring",
    "counter_circuit_o_1order": "counter_circuit",
    "cramped_room": "cramped_room",
    "forced_coordination": "forced_coordination",
}


def name(path: Path) -> str:
    return f"{path.parent.name}/{path.stem}"


def test_the_recordings_cover_both_modes_and_all_classic_layouts():
    modes = {
        mode: {path.stem.rpartition("_")[0] for path in RECORDINGS if path.parent.name == mode}
        for mode in ("auto", "manual")
    }
    assert modes == {"auto": set(SHIPPED), "manual": set(SHIPPED)}


@pytest.mark.parametrize("path", RECORDINGS, ids=name)
def test_the_kitchen_replays_the_recording(path):
    assert replay_golden(path) > 400_000


@pytest.mark.parametrize("path", [path for path in RECORDINGS if path.parent.name != "tomato"], ids=name)
def test_the_shipped_layout_is_the_recorded_one(path):
    _, meta = read_golden(path)
    layout = Layout.load(SHIPPED[meta["layout"]])
    assert layout.rows == tuple(meta["terrain"])
    assert layout.start_cells == tuple(map(tuple, meta["start_positions"]))
    assert layout.orders == ((3, 0),)
    assert set(layout.cook_times[1:]) == {meta["cook_time"]}

import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.pools.axes import AXES, MIXED
from overcooked_bench.evaluation.pools.conventions import (
    conventions,
    enough,
    read_convention,
    value_of,
    write_convention,
)
from overcooked_bench.evaluation.pools.players import Player, players_of
from overcooked_bench.kitchen.layout import layout_names


def dev(layout, *names):
    found = {player.entry.name: player for player in players_of(Pool.load("dev-v1"), layout)}
    return [found[name] for name in names]


def test_counters_that_objects_pass_are_seen():
    names = ("sp-0", "sp-1", "sp-4", "stay")
    assert conventions("forced_coordination", dev("forced_coordination", *names), episodes=3) == [
        "onions=bottom, dishes=middle",
        "onions=middle, dishes=middle",
        "onions=top, dishes=top",
        "",
    ]


def test_directions_and_passing_are_seen():
    circuit = dev("counter_circuit", "sp-0", "sp-5")
    train = [p for p in players_of(Pool.load("train-v1"), "counter_circuit") if p.entry.name in ("sp-01", "sp-13")]
    assert conventions("counter_circuit", circuit + train, episodes=3) == [
        "direction=clockwise, transport=carrying",
        "direction=anticlockwise, transport=carrying",
        "direction=anticlockwise, transport=passing",
        "direction=to and fro, transport=carrying",
    ]


def test_who_plates_and_who_serves_is_seen():
    assert conventions("cramped_room", dev("cramped_room", "sp-0", "sp-3"), 4) == ["plates=both", "plates=one"]
    found = conventions("asymmetric_advantages", dev("asymmetric_advantages", "sp-0", "greedy"), 3)
    assert found == ["serves=left", "serves=mixed"]


def test_a_helper_shows_what_copies_cannot():
    """Two copies of a courier reach nothing together."""
    courier = dev("cramped_room", "dish_courier")
    assert conventions("cramped_room", courier, episodes=3) == ["plates=one"]


def test_a_layout_without_axes_has_no_conventions():
    assert conventions("bottleneck", [Player.scripted("greedy", "bottleneck")]) == [""]


def test_axes_are_of_shipped_layouts_and_their_texts_can_be_read():
    assert set(AXES) <= set(layout_names())
    for axes in AXES.values():
        for axis in axes:
            for value in (*axis.values, MIXED):
                said = {axis.name: value, "other": "top"}
                assert read_convention(write_convention(said)) == said
    assert read_convention(None) == read_convention("") == {}
    with pytest.raises(ValueError, match="write it as 'onions=top, dishes=bottom'"):
        read_convention("top, bottom")


@pytest.mark.parametrize(
    ("amounts", "value"),
    [
        ({"top": 20, "middle": 10, "bottom": -50}, "top"),
        ({"top": 20, "middle": 11, "bottom": 0}, MIXED),
        ({"top": 10, "middle": -4, "bottom": 9}, None),
    ],
)
def test_a_value_needs_two_thirds_of_what_speaks_for_any(amounts, value):
    assert (value_of(amounts) if enough(amounts) else None) == value

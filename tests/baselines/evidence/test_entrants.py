"""Who may be an entrant, and of which family it is."""

import msgspec
import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.evidence.entrants import (
    MOST_OF_A_FAMILY,
    choose_entrants,
    family,
    partners_of,
    recipe,
    tied,
)
from tests.agents.made import record
from tests.baselines.evidence.made import LAYOUT, write_pool


def of(pool, layout=LAYOUT):
    return [player.entry for player in partners_of(Pool.load(pool), layout)]


def test_an_entrant_is_tied_by_lineage_weights_training_partners_and_people():
    partner = record("a", lineage="one", people=("2019-01",))
    partner = msgspec.structs.replace(partner, reference=of("dev-v1")[0].reference)
    other = msgspec.structs.replace(record("b", lineage="two"), reference=of("dev-v1")[1].reference)
    assert not tied(other, [partner])
    assert tied(msgspec.structs.replace(other, lineage="one"), [partner])
    assert tied(msgspec.structs.replace(other, reference=partner.reference), [partner])
    people = msgspec.structs.replace(other, people=("2019-01", "2019-03"))
    assert (tied(people, [partner]), tied(people, [partner], people=False)) == (True, False)
    trained = record("c", lineage="three", settings={"partner_hashes": [partner.sha256]})
    assert tied(msgspec.structs.replace(trained, reference=other.reference), [partner])


def test_chosen_entrants_have_no_tie_to_the_pool_and_no_lineage_in_two_families():
    pools = [Pool.load(name) for name in ("train-v1", "dev-v1", "dev-v0", "human-train")]
    partners = [*of("human-test"), *(entry for entry in of("dev-v1") if entry.name == "greedy")]
    chosen = choose_entrants(LAYOUT, pools, partners)
    assert not any(tied(player.entry, partners) for player in chosen)
    families = {}
    for player in chosen:
        assert families.setdefault(player.entry.lineage, family(player)) == family(player)
        assert player.entry.name not in ("stay", "random", "greedy")
        assert not player.entry.name.endswith("-early")
    counts = {name: sum(family(player) == name for player in chosen) for name in families.values()}
    assert counts["self-play fast"] == counts["self-play fast, half-trained"] == MOST_OF_A_FAMILY
    assert counts["self-play of dev-v0"] == 4
    assert {player.pool.name for player in chosen if family(player) == "self-play fast"} == {"train-v1"}
    assert counts["human proxies"] == 6


def test_a_start_divides_recipes_and_no_family(tmp_path):
    settings = {"start": "standard"}
    pool = write_pool(tmp_path, "made", {"sp-0": {}, "sp-1": {"settings": settings}, "sp-2": {"checkpoint": 0.2}})
    one, other, half = partners_of(pool, LAYOUT)
    assert family(one) == family(other) == "self-play fast"
    assert (recipe(one), recipe(other)) == ("self-play fast", "self-play fast standard")
    assert family(half) == "self-play fast, half-trained"


@pytest.mark.parametrize("pool", ["human-train", "human-test"])
def test_all_proxies_are_one_family_whose_clones_are_a_recipe(pool):
    players = partners_of(Pool.load(pool), LAYOUT)
    assert {family(player) for player in players} == {"human proxies"}
    assert 2 <= len({recipe(player) for player in players}) < len(players)

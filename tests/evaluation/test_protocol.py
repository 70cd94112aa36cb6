import re

import msgspec
import pytest

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool
from overcooked_bench.evaluation import protocol as module
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.roster import roster
from overcooked_bench.evaluation.protocol import (
    Play,
    Protocol,
    ProtocolError,
    Report,
    load_protocol,
    protocol_names,
    read_protocol,
    upgrade,
    with_start,
)
from overcooked_bench.evaluation.scenario_scores import suite_sha256
from overcooked_bench.evaluation.scores import Source, read_scores
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import Shelf
from tests.evaluation.made import SCRIPTED_POOL, block, changed, protocol_text, reporting


def test_the_default_is_v1_and_dev_is_as_it_was():
    assert load_protocol() == load_protocol("v1")
    assert protocol_names()[0] == "v1"
    protocol = load_protocol("dev")
    play = protocol.play
    assert play.layouts == layout_names()[:5]
    assert (play.horizon, play.episodes, play.seats, play.pool) == (400, 10, (0, 1), "dev-v0")
    assert protocol.report.thresholds == (1, 3, 5)


@pytest.mark.parametrize("name", protocol_names())
def test_every_shipped_protocol_is_named_as_its_file(name):
    assert load_protocol(name).name == name


def test_a_protocol_is_one_file(tmp_path, monkeypatch):
    shelf = Shelf("protocol", "tests", ".yaml", ProtocolError, "a YAML file", str(tmp_path))
    monkeypatch.setattr(module, "_SHELF", shelf)
    (tmp_path / "tiny.yaml").write_text(protocol_text())
    assert protocol_names() == ("tiny",)
    assert load_protocol("tiny") == load_protocol(tmp_path / "tiny.yaml")


def test_a_file_is_read(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(protocol_text(pool="my/pool"))
    protocol = load_protocol(file)
    assert (protocol.name, protocol.play.pool, protocol.report.thresholds) == ("tiny", "my/pool", (1.0, 3.0))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"horizon": "many"}, "Expected `int`, got `str` - at key `play.horizon`"),
        ({"horizon": 0}, "horizon is 0; give a number of steps from 1"),
        ({"horizon": 10_001}, "horizon is 10001; give a number of steps from 1 to 10,000"),
        ({"horizon": None}, "missing key `horizon`"),
        ({"horizn": 400}, "unknown key `horizn`; did you mean 'horizon'. keys are pool, layouts"),
        ({"partners": ["greedy"]}, "unknown key `partners`; .*keys are pool"),
        ({"cooking": "microwave"}, "Invalid enum value .microwave. - at key `play.cooking`"),
        ({"seats": [0, 2]}, "at key `play.seats"),
        ({"seats": [0, 0]}, r"seats is \[0, 0\]"),
        ({"layouts": []}, r"layouts is \[\]; give at least one"),
        ({"object_probability": 1.5}, "object_probability is 1.5; give a probability"),
        ({"episodes": 0}, "episodes is 0"),
        ({"episodes": 200_000_000}, "episodes is 200000000; give a number from 1 to 10,000"),
        ({"salt": '""'}, "salt is ''; give a text"),
        ({"thresholds": [0]}, "thresholds"),
        ({"thresholds": [".inf"]}, "inf"),
        ({"thresholds": None}, "report"),
        ({"name": "../../x"}, "name is '../../x'"),
        ({"version": -1}, "version is -1"),
        ({"pool_sha256": "abc"}, "pool_sha256 is 'abc'; give a SHA-256, 64 hexadecimal digits"),
        ({"per_stratum": 0}, "per_stratum is 0; give a number of partners from 1"),
        ({"self_play": -1}, "Expected `bool`, got `int` - at key `play.self_play`"),
        ({"name": "{"}, "not YAML"),
    ],
)
def test_a_wrong_key_is_named_with_the_file(changes, words):
    with pytest.raises(ProtocolError, match=rf"^tiny.yaml:\d+: .*{words}"):
        read_protocol(protocol_text(**changes), "tiny.yaml")


def with_report(*lines):
    """A protocol file with further lines in its report; the first of them is line 17."""
    return protocol_text(pool_sha256="0" * 63 + "a") + "".join(f"  {line}\n" for line in lines)


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (["metrics: [mean, n]", "headlines: [mean, tail_mean]"], r"18: headlines is .*among the metrics"),
        (["metrics:", "    - mean", "    - meen"], r"19: no metric 'meen'; did you mean 'mean'"),
        (["headlines: [mean, mean_]"], r"17: no metric 'mean_'"),
        (["metrics: [mean, mean]"], r"17: metrics is .*each once"),
        (["estimators: bayesian"], r"17: Invalid enum value 'bayesian' - at key `report.estimators`"),
        (["criterion: peeple"], r"17: no protocol 'peeple'; did you mean 'people'"),
        (["scenarios: {name: unit_scenarios}"], r"17: missing key `sha256`"),
        (["scenarios: {name: unit_scenarios, sha256: 12}"], r"17: .*`report.scenarios.sha256`"),
        (["scenarios:", "    name: a", "    sha256: beef"], r"19: sha256 is 'beef'; give a SHA-256"),
        (["ordered:", "    quantile: 0.15"], r"17: missing key `band`"),
        (
            ["ordered:", "    {band: [0.75, 0.25], quantile: 0.15, quantile_band: [0, 0.3], positions: [1]}"],
            r"18: band is .*ascending",
        ),
        (
            ["ordered:", "    {band: [0, 1], quantile: 0.5, quantile_band: [0, 0.3], positions: [1]}"],
            r"18: quantile_band is .*one below `quantile`, one above",
        ),
        (
            ["ordered:", "    {band: [0, 1], quantile: 0.15, quantile_band: [0, 0.3], positions: [50]}"],
            r"18: positions is \[50.0\]; give shares from 0 to 1",
        ),
    ],
)
def test_what_a_report_cannot_say_is_an_error_with_its_line(lines, words):
    with pytest.raises(ProtocolError, match=rf"^tiny.yaml:{words}"):
        read_protocol(with_report(*lines), "tiny.yaml")


def test_a_protocol_with_headlines_says_which_pool_it_means():
    ranks = with_report("headlines: [mean]")
    assert read_protocol(ranks, "tiny.yaml").report.headline == "mean"
    with pytest.raises(ProtocolError, match=r"tiny.yaml:9: missing key `pool_sha256`.*manifest.json"):
        read_protocol(re.sub("  pool_sha256.*\n", "", ranks), "tiny.yaml")
    anywhere = re.sub("  pool: .*\n", "  pool: null\n", re.sub("  pool_sha256.*\n", "", ranks))
    assert read_protocol(anywhere, "tiny.yaml").play.pool is None


@pytest.mark.parametrize("name", ["v1", "v1-lite"])
def test_what_ranks_means_the_pool_and_the_scenarios_that_ship(name):
    """If this fails because one of them was changed: write the new hash, then `evaluation.references` once more."""
    protocol = load_protocol(name)
    assert protocol.play.pool_sha256 == read_manifest(find_pool("v1")).hash
    assert protocol.report.scenarios.sha256 == suite_sha256()
    shipped = [read_scores(file) for file in REFERENCES.glob("*.json")]
    (reference,) = [one for one in shipped if one.protocol.name == name]
    assert reference.agent == Source("greedy", find("greedy").sha256)
    assert (reference.protocol.sha256, reference.pool.sha256) == (protocol.sha256, protocol.play.pool_sha256)
    assert [layout.layout for layout in reference.layouts] == list(protocol.play.layouts)


def test_only_v1_ranks():
    assert [name for name in protocol_names() if load_protocol(name).report.ranked] == ["v1"]


def test_v1_and_its_small_sister():
    whole, lite = load_protocol("v1"), load_protocol("v1-lite")
    assert (whole.play.episodes, whole.play.seats, whole.play.start, whole.play.self_play) == (
        10,
        (0, 1),
        "random",
        True,
    )
    assert (whole.report.headlines, whole.report.thresholds) == (("n", "h50"), (1, 2, 3, 5))
    assert (lite.play.episodes, lite.play.per_stratum, lite.report.ranked) == (1, 2, False)
    pool = Pool.load("v1")
    for layout in lite.play.layouts:
        strata = [partner.entry.stratum for partner in roster(pool, layout, lite.play.per_stratum)]
        assert sorted(strata) == sorted(2 * ["own", "other-trainers", "human", "scripted"])


def test_the_standard_start_makes_other_games_of_another_name():
    v1 = load_protocol("v1")
    standard = with_start(v1, "standard")
    assert (standard.name, standard.play.start) == ("v1-standard", "standard")
    assert standard.sha256 != v1.sha256
    assert with_start(v1, "random") is v1


def test_the_thesis_is_a_protocol():
    protocol = load_protocol("thesis")
    ordered = protocol.report.ordered
    assert (ordered.band, ordered.quantile, ordered.quantile_band) == ((0.25, 0.75), 0.15, (0.0, 0.3))
    assert ordered.positions == (0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
    assert protocol.play.pool is None


FLAT = """
name: mini
version: 0
layouts: [cramped_room]
cooking: auto
horizon: 100
start: random
object_probability: 0.0
pool: dev-v0
partners: [onion_courier, dish_courier, greedy]
floors: [stay, random]
seats: [0, 1]
episodes: 2
mode: sample
thresholds: [1, 3, 5]
salt: wooden spoon
"""


def test_a_file_of_the_first_form_is_refused_with_what_to_write():
    with pytest.raises(ProtocolError, match=r"flat.yaml:1: .*below play, thresholds below report.*pool's manifest"):
        read_protocol(FLAT, "flat.yaml")


def test_a_protocol_that_a_score_of_the_first_form_holds_is_still_read():
    import yaml

    flat = yaml.safe_load(FLAT)
    protocol = msgspec.convert(upgrade(flat), Protocol)
    assert (protocol.name, protocol.play.pool, protocol.play.horizon) == ("mini", "dev-v0", 100)
    assert protocol.report.thresholds == (1, 3, 5)
    assert upgrade(msgspec.to_builtins(protocol)) == msgspec.to_builtins(protocol)
    nameless = msgspec.convert(upgrade({**flat, "name": "../my protocol", "pool": None}), Protocol)
    assert (nameless.name, nameless.play.pool) == ("my-protocol", None)
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(upgrade({"name": 3}), Protocol)


def test_a_file_that_is_no_mapping_is_refused():
    with pytest.raises(ProtocolError, match=r"^tiny.yaml:1: .*mapping"):
        read_protocol("[1, 2]", "tiny.yaml")


def test_a_file_that_is_not_utf_8_is_refused(tmp_path):
    file = tmp_path / "latin.yaml"
    file.write_bytes(b"name: caf\xe9\n")
    with pytest.raises(ProtocolError, match=r"latin.yaml: not a text file in UTF-8"):
        load_protocol(file)


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(ProtocolError, match="no protocol named 'dve'; did you mean 'dev'"):
        load_protocol("dve")


def test_the_hash_is_of_what_is_played():
    text = protocol_text()
    protocol = read_protocol(text, "a")
    lines = text.splitlines()
    start, end = lines.index("play:") + 1, lines.index("report:")
    shuffled = [*lines[:start], *reversed(lines[start:end]), *lines[end:]]
    same = "# a remark\r\n" + "\r\n".join(shuffled) + "\r\n"
    assert read_protocol(same, "b").sha256 == protocol.sha256
    assert reporting(protocol, thresholds=(2,)).sha256 == protocol.sha256
    assert reporting(protocol, thresholds=(2,)).report_sha256 != protocol.report_sha256
    assert read_protocol(protocol_text(name="other", version=7), "c").sha256 == protocol.sha256
    assert changed(protocol, object_probability=1).sha256 == changed(protocol, object_probability=1.0).sha256
    hashes = {changed(protocol, **{key: value}).sha256 for key, value in (("salt", "x"), ("horizon", 41))}
    assert len(hashes | {protocol.sha256}) == 3


def test_the_hash_of_dev_is_frozen_and_a_new_optional_key_leaves_it_alone():
    """Start states and streams of every published score hang on it."""
    protocol = load_protocol("dev")
    assert protocol.sha256 == "da6fc489cc73be86a495066cfb55590b3654f9778aeec64e32ea2b8a8a074cbe"

    class Later(Play, frozen=True, kw_only=True):
        surprise: float = 0.5
        surprises: tuple[str, ...] = ()

    class LaterReport(Report, frozen=True, kw_only=True):
        metrics: tuple[str, ...] = ("mean",)

    plain = msgspec.to_builtins(protocol.play)
    assert msgspec.convert(plain, Later).sha256 == protocol.sha256
    assert msgspec.convert({**plain, "surprise": 0.5, "surprises": []}, Later).sha256 == protocol.sha256
    assert msgspec.convert({**plain, "surprise": 1}, Later).sha256 != protocol.sha256
    report = msgspec.convert(msgspec.to_builtins(protocol.report), LaterReport)
    assert report.sha256 == protocol.report_sha256


def test_what_is_reported_changes_no_game(protocol):
    """A threshold was part of every key: with another one, not one start state was the same."""
    once = play_block(block(protocol)).episodes
    assert play_block(block(reporting(protocol, thresholds=(1, 2)))).episodes == once
    assert play_block(block(msgspec.structs.replace(protocol, name="other", version=9))).episodes == once
    assert play_block(block(changed(protocol, salt="other"))).episodes[0].start != once[0].start


def test_a_protocol_names_a_pool_and_no_other_partners(protocol):
    assert protocol.play.pool == str(SCRIPTED_POOL)
    assert not {"partners", "floors"} & set(re.findall(r"\w+", (" ".join(Play.__struct_fields__))))


def test_people_are_met_from_random_starts_and_from_the_standard_one():
    people, standard = load_protocol("people"), load_protocol("people-standard")
    assert msgspec.structs.replace(people.play, start="standard") == standard.play
    assert (people.play.pool, people.play.start, people.report) == ("human-test", "random", standard.report)

import pytest

from overcooked_bench.evaluation.protocol import ProtocolError, load_protocol, protocol_names, read_protocol
from overcooked_bench.kitchen.layout import layout_names
from tests.evaluation.made import protocol_text


def test_the_default_is_the_dev_protocol():
    protocol = load_protocol()
    assert protocol == load_protocol("dev")
    assert protocol.layouts == layout_names()[:5]
    assert (protocol.horizon, protocol.episodes, protocol.seats, protocol.pool) == (400, 10, (0, 1), "dev-v0")
    assert set(protocol.floors) == {"stay", "random"}


@pytest.mark.parametrize("name", protocol_names())
def test_every_shipped_protocol_is_named_as_its_file(name):
    assert load_protocol(name).name == name


def test_a_file_is_read(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text(protocol_text(pool="my/pool"))
    protocol = load_protocol(file)
    assert (protocol.name, protocol.pool, protocol.thresholds) == ("tiny", "my/pool", (1.0, 3.0))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"horizon": "many"}, "Expected `int`, got `str` - at key `horizon`"),
        ({"horizon": 0}, "horizon is 0; give a number of steps from 1"),
        ({"horizon": 10_001}, "horizon is 10001; give a number of steps from 1 to 10,000"),
        ({"horizon": None}, "missing key `horizon`"),
        ({"horizn": 400}, "unknown key `horizn`; did you mean 'horizon'. keys are name, version"),
        ({"cooking": "microwave"}, "Invalid enum value 'microwave' - at key `cooking`"),
        ({"seats": [0, 2]}, "at key `seats"),
        ({"seats": [0, 0]}, r"seats is \[0, 0\]"),
        ({"layouts": []}, r"layouts is \[\]; give at least one"),
        ({"object_probability": 1.5}, "object_probability is 1.5; give a probability"),
        ({"episodes": 0}, "episodes is 0"),
        ({"episodes": 200_000_000}, "episodes is 200000000; give a number from 1 to 10,000"),
        ({"name": "../../X"}, "the key `name` is"),
        ({"salt": "!!bool x"}, "the tag"),
        ({"thresholds": [0]}, "thresholds"),
        ({"floors": ["greedy"]}, "partners and floors name 'greedy' twice"),
        ({"partners": []}, "partners"),
        ({"name": "{"}, "not YAML"),
    ],
)
def test_a_wrong_key_is_named_with_the_file(changes, words):
    with pytest.raises(ProtocolError, match=rf"^tiny.yaml(:\d+)?: .*{words}"):
        read_protocol(protocol_text(**changes), "tiny.yaml")


def test_a_file_that_is_no_mapping_is_refused():
    with pytest.raises(ProtocolError, match=r"^tiny.yaml:1: not a mapping"):
        read_protocol("[1, 2]", "tiny.yaml")


def test_a_file_that_is_not_utf_8_is_refused(tmp_path):
    file = tmp_path / "latin.yaml"
    file.write_bytes(b"name: caf\xe9\n")
    with pytest.raises(ProtocolError, match=r"latin.yaml: not a text file in UTF-8"):
        load_protocol(file)


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(ProtocolError, match="no protocol named 'dve'; did you mean 'dev'"):
        load_protocol("dve")


def test_the_hash_is_of_what_the_file_says():
    text = protocol_text()
    same = "# a remark\r\n" + "\r\n".join(reversed(text.splitlines())) + "\r\n"
    assert read_protocol(same, "b").sha256 == read_protocol(text, "a").sha256
    hashes = {
        read_protocol(protocol_text(**{key: value}), key).sha256 for key, value in (("salt", "x"), ("horizon", 41))
    }
    assert len(hashes | {read_protocol(text, "a").sha256}) == 3

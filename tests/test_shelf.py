import pytest

from overcooked_bench.errors import WrongUse
from overcooked_bench.shelf import Shelf, guess

PROTOCOLS = Shelf("protocol", "overcooked_bench.protocols", ".yaml", WrongUse, "a YAML file", first=("dev",))
POOLS = Shelf("pool", "overcooked_bench.baselines", "/manifest.json", WrongUse, "a pool's folder", "pools")


def test_a_shelf_of_files():
    assert PROTOCOLS.names()[0] == "dev"
    assert PROTOCOLS.find("dev").name == "dev.yaml"


def test_a_shelf_of_folders():
    assert set(POOLS.names()) >= {"dev-v0", "train-v1"}
    assert POOLS.find("dev-v0").parent.name == "dev-v0"


def test_a_path_will_do_too(tmp_path, monkeypatch):
    (tmp_path / "manifest.json").touch()
    assert POOLS.find(tmp_path) == POOLS.find(str(tmp_path)) == tmp_path / "manifest.json"
    (tmp_path / "p").touch()
    monkeypatch.chdir(tmp_path)
    assert PROTOCOLS.find("p").is_file()


@pytest.mark.parametrize("name", ["dve", "x" * 100_000, "a\0b", "/", "..", "\ud800", "/dev/zero"])
def test_what_is_neither_is_refused_at_once(name):
    with pytest.raises(WrongUse, match=r"no protocol named .*Shipped are dev.*the path of a YAML file will do too"):
        PROTOCOLS.find(name)


def test_a_guess():
    assert guess("dve", ["dev", "greedy"]) == "did you mean 'dev'? "
    assert guess("xyz", ["dev", "greedy"]) == ""

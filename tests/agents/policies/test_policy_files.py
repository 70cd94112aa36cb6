"""A policy's two files are untrusted: they are bounded and regular, and what they name is never opened as a path."""

import json
import os

import pytest

from overcooked_bench.agents.policies.policy import PolicyError, load_policy, policy_files
from tests.agents.made import write_policy


@pytest.fixture
def files(tmp_path):
    return policy_files(write_policy(tmp_path / "p").weights)


def edit(files, **changes):
    files.architecture.write_text(json.dumps(json.loads(files.architecture.read_text()) | changes))


@pytest.mark.parametrize("layout", ["/proc/kmsg", "/proc/self/mem", "/dev/zero", "mine.layout", "x" * 300, "", "a\0b"])
def test_a_layout_is_a_shipped_name_or_a_grid_never_a_path(files, layout, tmp_path, monkeypatch):
    (tmp_path / "mine.layout").write_text("XXPXX\nO1 2O\nX   X\nXDXSX\n")
    monkeypatch.chdir(tmp_path)
    edit(files, layout=layout)
    with pytest.raises(PolicyError, match=r"p\.json: the entry 'layout': no layout named"):
        load_policy(files.weights)


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices")
@pytest.mark.parametrize("which", ["weights", "architecture"])
@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "itself"])
def test_a_file_is_a_regular_one(files, which, kind):
    file = getattr(files, which)
    file.unlink()
    make = {
        "pipe": lambda: os.mkfifo(file),
        "device": lambda: file.symlink_to("/dev/zero"),
        "folder": file.mkdir,
        "itself": lambda: file.symlink_to(file),
    }
    make[kind]()
    with pytest.raises(PolicyError, match=f"{file.name}: cannot be read"):
        load_policy(files.weights)


BAD_JSON = {
    "arrays": ("[" * 1500, "more than 64"),
    "objects": ('{"a":' * 1500, "more than 64"),
    "nan": ('{"layout": NaN}', "not JSON"),
    "long": (" " * 10**6 + "1", "larger than 1,000,000 bytes"),
}


@pytest.mark.parametrize(("text", "message"), BAD_JSON.values(), ids=BAD_JSON.keys())
def test_an_architecture_is_small_plain_json(files, text, message):
    files.architecture.write_text(text)
    with pytest.raises(PolicyError, match=message):
        load_policy(files.weights)

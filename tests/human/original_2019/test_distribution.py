"""Only the one source distribution is opened, and only in memory."""

import gzip
import io
import sys
import tarfile

import pytest

from overcooked_bench.human.original_2019 import distribution
from overcooked_bench.human.original_2019.distribution import (
    SHA256,
    DistributionError,
    digest_of,
    download,
    member,
    read_file,
    unpack,
)


def sdist(pickles: dict[str, bytes]) -> bytes:
    """Packs pickles as the source distribution does."""
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w:gz") as archive:
        for name, data in pickles.items():
            entry = tarfile.TarInfo(member(name))
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
    return file.getvalue()


def opened(data: bytes) -> dict[str, bytes]:
    return unpack(data, "x.tar.gz", digest_of(data))


def test_both_pickles_are_taken_out():
    pickles = {"train": b"one", "test": b"two"}
    assert opened(sdist(pickles)) == pickles


def test_another_file_is_not_opened():
    with pytest.raises(
        DistributionError, match=rf"x\.tar\.gz has the SHA-256 [0-9a-f]{{64}}, and .* has {SHA256}; run python -m pip"
    ):
        unpack(sdist({"train": b"one", "test": b"two"}), "x.tar.gz")


def test_a_file_without_the_pickles_is_refused():
    with pytest.raises(DistributionError, match=r"does not hold .*clean_test_trials\.pickle"):
        opened(sdist({"train": b"one"}))


def test_a_link_in_the_place_of_a_pickle_is_refused():
    file = io.BytesIO()
    with tarfile.open(fileobj=file, mode="w:gz") as archive:
        link = tarfile.TarInfo(member("train"))
        link.type, link.linkname = tarfile.SYMTYPE, "/etc/passwd"
        archive.addfile(link)
    with pytest.raises(DistributionError, match="does not hold"):
        opened(file.getvalue())


WHOLE = sdist({"train": b"one" * 999, "test": b"two"})
BROKEN = {
    "no gzip": (b"x" * 100, "not a .tar.gz"),
    "no tar": (gzip.compress(b"x" * 2000), "not a .tar.gz"),
    "cut short": (WHOLE[:-20], "not a .tar.gz"),
    "damaged": (WHOLE[:40] + b"x" + WHOLE[41:], "not a .tar.gz"),
    "nothing": (b"", "does not hold|not a .tar.gz"),
}


@pytest.mark.parametrize(("data", "message"), BROKEN.values(), ids=BROKEN.keys())
def test_what_is_no_distribution_is_refused(data, message):
    with pytest.raises(DistributionError, match=message):
        opened(data)


def test_a_bomb_does_not_go_off(monkeypatch):
    monkeypatch.setattr(distribution, "_MOST_UNPACKED", 1 << 20)
    with pytest.raises(DistributionError, match="more than 1,048,576 bytes"):
        opened(gzip.compress(bytes(20 << 20)))


def test_a_file_that_is_not_there_or_far_too_large_is_refused(tmp_path):
    with pytest.raises(DistributionError, match="no such file"):
        read_file(tmp_path / "x.tar.gz")
    (tmp_path / "x.tar.gz").write_bytes(bytes(9 << 20))
    with pytest.raises(DistributionError, match="larger than"):
        read_file(tmp_path / "x.tar.gz")


PIP = """
import pathlib, sys
wish = pathlib.Path(sys.argv[sys.argv.index("--requirement") + 1]).read_text()
assert wish.startswith("overcooked-ai==1.1.0 --hash=sha256:") and "--require-hashes" in sys.argv
pathlib.Path(sys.argv[sys.argv.index("--dest") + 1], "overcooked_ai-1.1.0.tar.gz").write_bytes(b"got")
"""


def pips(tmp_path, *programs):
    for number, program in enumerate(programs):
        (tmp_path / f"pip{number}.py").write_text(program)
    return lambda: iter([[sys.executable, str(tmp_path / f"pip{number}.py")] for number in range(len(programs))])


def test_the_next_pip_is_asked_if_one_fails(tmp_path, monkeypatch):
    monkeypatch.setattr(distribution, "_pips", pips(tmp_path, "raise SystemExit('no network')", PIP))
    assert download() == b"got"


def test_without_pip_or_network_it_is_said_what_to_run(tmp_path, monkeypatch):
    monkeypatch.setattr(distribution, "_pips", pips(tmp_path, "raise SystemExit('no network')"))
    with pytest.raises(DistributionError, match=r"\(pip failed: no network\); .*run python -m pip download .* --file"):
        download()
    monkeypatch.setattr(distribution, "_pips", lambda: iter([["/nowhere/pip"]]))
    with pytest.raises(DistributionError, match="pip did not answer"):
        download()
    monkeypatch.setattr(distribution, "_pips", lambda: iter([]))
    with pytest.raises(DistributionError, match="no pip was found"):
        download()

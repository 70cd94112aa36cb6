"""Archives of strangers: exactly what `pack` writes is read, everything else is refused and nothing is written."""

import io
import os
import stat
import struct
import tarfile
import zipfile
import zlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.leaderboard.submission import archive
from overcooked_bench.leaderboard.submission.archive import pack_files, read_archive, unpack
from overcooked_bench.leaderboard.submission.manifest import SubmissionError
from overcooked_bench.leaderboard.submission.names import collisions, path_problem

GOOD = {"agent.py": b"x = 1\n", "weights/a.npz": bytes(range(256)) * 9}
PARTS = st.from_regex(r"[a-z0-9_][a-z0-9_.+=-]{0,7}[a-z]", fullmatch=True)
PATHS = st.lists(PARTS, min_size=1, max_size=3).map("/".join)
FILES = st.dictionaries(PATHS, st.binary(max_size=50), min_size=1, max_size=5).filter(
    lambda files: not collisions(files) and not any(map(path_problem, files))
)


def zipped(files, **settings):
    """A zip as other programs write it."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", **settings) as whole:
        for name, data in files:
            whole.writestr(name, data)
    return made.getvalue()


def marked(name, kind):
    """An entry that the archive marks as a link, a folder or a device."""
    info = zipfile.ZipInfo(name)
    info.create_system, info.external_attr = 3, (kind | 0o777) << 16
    return info


def tarred():
    made = io.BytesIO()
    with tarfile.open(fileobj=made, mode="w:gz") as whole:
        whole.addfile(tarfile.TarInfo("agent.py"))
    return made.getvalue()


def raw_name(name):
    """An archive that is right but for a name, which may be any bytes."""
    return pack_files({"x" * len(name): b""}).replace(b"x" * len(name), name)


def with_size(size):
    """An archive whose only file claims another size."""
    data = bytearray(pack_files({"a.txt": b"abc"}))
    struct.pack_into("<2I", data, 18, size, size)
    return bytes(data)


def bomb():
    """Many entries of the list of contents that share one file of a MiB."""
    once = pack_files({"a.txt": bytes(1 << 20)})
    entry = once[-22 - 46 - 5 : -22]
    entries = b"".join(entry.replace(b"a.txt", b"%05d" % i) for i in range(1000))
    end = struct.pack("<4s4H2IH", b"PK\5\6", 0, 0, 1000, 1000, len(entries), (1 << 20) + 35, 0)
    return once[: -22 - len(entry)] + entries + end


HOSTILE = {
    "nothing": (b"", "not a packed submission"),
    "text": (b"hello", "not a packed submission"),
    "tar": (tarred(), "not a packed submission"),
    "empty zip": (zipped([]), "not a packed submission"),
    "model": (zipped([("data", "{}"), ("_stable_baselines3_version", "2.8")]), "overcooked-bench export"),
    "traversal": (zipped([("../agent.py", "x")]), "leads out of the submission's folder"),
    "hidden traversal": (zipped([("a/../../agent.py", "x")]), "leads out of the submission's folder"),
    "absolute": (zipped([("/etc/cron.d/x", "x")]), "leads out of the submission's folder"),
    "drive": (zipped([("C:/x", "x")]), "leads out of the submission's folder"),
    "backslash": (raw_name(b"..\\x"), "not the same on every system"),
    "link": (zipped([(marked("agent.py", stat.S_IFLNK), "/etc/passwd")]), "a link; put the file itself"),
    "device": (zipped([(marked("agent.py", stat.S_IFCHR), "")]), "a folder, pipe or device"),
    "pipe": (zipped([(marked("agent.py", stat.S_IFIFO), "")]), "a folder, pipe or device"),
    "folder": (zipped([("weights/", "")]), "not the same on every system"),
    "compressed": (zipped([("a.txt", bytes(1 << 22))], compression=zipfile.ZIP_DEFLATED), "compressed"),
    "shared content": (bomb(), "not what `submission pack` writes"),
    "long claim": (with_size(2**32 - 1), "more than 268,435,456 bytes in all"),
    "claim beyond the end": (with_size(1000), "damaged or cut off"),
    "short claim": (with_size(1), "damaged or cut off"),
    "many": (pack_files({f"{i}.txt": b"" for i in range(2001)}), "more than 2,000 files"),
    "control character": (raw_name(b"a\x1b[2Jb"), "not the same on every system"),
    "new line": (raw_name(b"a\nb"), "not the same on every system"),
    "null": (raw_name(b"a\0b"), "not the same on every system"),
    "not UTF-8": (raw_name(b"\xff\xfe"), "a name that is not UTF-8"),
    "right to left": (raw_name("a\u202eb".encode()), "not the same on every system"),
    "upper and lower case": (pack_files({"Agent.py": b"", "agent.py": b""}), "one name on some systems"),
    "file and folder": (pack_files({"a": b"", "a/b": b""}), "one name on some systems"),
    "twice": (pack_files({"a": b"1", "b": b"2"}).replace(b"b", b"a"), "twice in the archive"),
    "Windows": (pack_files({"aux.py": b""}), "a device on Windows"),
    "last dot": (pack_files({"agent.": b""}), "not the same on every system"),
    "hidden": (pack_files({".bashrc": b""}), "not the same on every system"),
    "long": (pack_files({"a" * 201: b""}), "a path of 201 characters"),
    "deep": (pack_files({"a/" * 6 + "b": b""}), "6 folders inside each other"),
    "cut off": (pack_files(GOOD)[:40], "damaged or cut off"),
    "no end": (pack_files(GOOD)[:-1], "not what `submission pack` writes"),
    "behind the end": (pack_files(GOOD) + b"more", "not what `submission pack` writes"),
    "in front": (b"#!/bin/sh\n" + pack_files(GOOD), "not a packed submission"),
    "of another program": (zipped(GOOD.items()), "not what `submission pack` writes"),
}


@pytest.mark.parametrize(("data", "words"), HOSTILE.values(), ids=HOSTILE.keys())
def test_a_hostile_archive_is_refused_and_nothing_is_written(data, words, tmp_path):
    home = tmp_path / "home"
    home.mkdir()
    (home / "x.submission.zip").write_bytes(data)
    with pytest.raises(SubmissionError) as refusal:
        unpack(home / "x.submission.zip", home / "out")
    assert words in str(refusal.value)
    assert str(refusal.value).isprintable()
    assert [file.name for file in tmp_path.rglob("*")] == ["home", "x.submission.zip"]


@given(files=FILES)
def test_what_is_packed_is_unpacked(files, tmp_path_factory):
    home = tmp_path_factory.mktemp("home")
    data = pack_files(files)
    assert data == pack_files(dict(reversed(files.items())))
    (home / "a.zip").write_bytes(data)
    unpack(home / "a.zip", home / "out")
    found = [file for file in (home / "out").rglob("*") if file.is_file()]
    assert {file.relative_to(home / "out").as_posix(): file.read_bytes() for file in found} == files
    assert read_archive(home / "a.zip") == files
    with zipfile.ZipFile(home / "a.zip") as whole:
        assert whole.testzip() is None
        assert {info.filename: whole.read(info) for info in whole.infolist()} == files


@given(place=st.integers(0, len(pack_files(GOOD)) - 1), flip=st.integers(1, 255))
def test_no_byte_can_be_changed(place, flip, tmp_path_factory):
    data = bytearray(pack_files(GOOD))
    data[place] ^= flip
    file = tmp_path_factory.getbasetemp() / "changed.zip"
    file.write_bytes(data)
    with pytest.raises(SubmissionError):
        read_archive(file)


@given(path=st.one_of(st.text(max_size=30), st.from_regex(r"([a-zA-Z0-9._/\\: ]|\.\./|CON|nul\.)+", fullmatch=True)))
def test_an_accepted_path_stays_in_its_folder_under_its_own_name(path):
    if path_problem(path):
        return
    assert os.path.normpath(path) == path
    assert not os.path.isabs(path)
    assert path.isascii()
    assert path.isprintable()
    assert all(part == part.strip(". ") or part.startswith("_") for part in path.split("/"))


def test_an_archive_that_is_too_large_or_no_file_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "_MOST_ARCHIVE", 1000)
    (tmp_path / "large.zip").write_bytes(pack_files(GOOD))
    os.mkfifo(tmp_path / "pipe.zip")
    for name, words in (("large.zip", "larger than 1,000"), ("pipe.zip", "a pipe or a device"), ("no.zip", "no such")):
        with pytest.raises(SubmissionError, match=words):
            read_archive(tmp_path / name)


def test_nothing_is_unpacked_over_anything(tmp_path):
    (tmp_path / "a.zip").write_bytes(pack_files(GOOD))
    (tmp_path / "link").symlink_to("nowhere")
    for name in ("a.zip", "link", "."):
        with pytest.raises(SubmissionError, match="exists already"):
            unpack(tmp_path / "a.zip", tmp_path / name)
    assert {file.name for file in tmp_path.iterdir()} == {"a.zip", "link"}


def test_the_crc_is_the_one_of_zip():
    data = pack_files({"a": b"abc"})
    assert struct.unpack_from("<I", data, 14) == (zlib.crc32(b"abc"),)

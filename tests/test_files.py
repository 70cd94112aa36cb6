"""`read_regular` never waits and never fills the memory; names from files stay names."""

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import (
    FileError,
    append_line,
    check_name,
    cut_unfinished_line,
    is_file,
    read_regular,
    read_text,
    shown,
    write_whole,
)

pytestmark = pytest.mark.skipif(os.name != "posix", reason="pipes and devices")


@pytest.fixture
def pipe(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    return tmp_path / "pipe"


def test_what_was_written_whole_is_read(tmp_path):
    write_whole(tmp_path / "f", b"abc")
    assert read_regular(tmp_path / "f", 3) == b"abc"
    assert [file.name for file in tmp_path.iterdir()] == ["f"]


def test_one_byte_more_is_too_much(tmp_path):
    write_whole(tmp_path / "f", b"abc")
    with pytest.raises(FileError, match="larger than 2 bytes"):
        read_regular(tmp_path / "f", 2)


def test_a_pipe_is_not_waited_for(pipe):
    with pytest.raises(FileError, match="a folder, a pipe or a device"):
        read_regular(pipe, 10)
    (pipe.parent / "link").symlink_to(pipe)
    with pytest.raises(FileError, match="a folder, a pipe or a device"):
        read_regular(pipe.parent / "link", 10)


@pytest.mark.parametrize("path", ["/dev/zero", "/dev/null", ".", "/proc/self/mem", "x" * 300, "a\0b", "\ud800", "gone"])
def test_what_is_no_regular_file_is_refused(path):
    with pytest.raises(FileError):
        read_regular(path, 10)


def test_a_link_is_followed_only_where_it_may_be(tmp_path):
    write_whole(tmp_path / "f", b"abc")
    (tmp_path / "link").symlink_to("f")
    (tmp_path / "itself").symlink_to("itself")
    assert read_regular(tmp_path / "link", 3) == b"abc"
    with pytest.raises(FileError, match="a symbolic link"):
        read_regular(tmp_path / "link", 3, follow_links=False)
    for follow in (True, False):
        with pytest.raises(FileError):
            read_regular(tmp_path / "itself", 3, follow_links=follow)


def test_a_text_has_plain_line_ends_and_is_utf8(tmp_path):
    write_whole(tmp_path / "f", b"a\r\nb\rc\n")
    assert read_text(tmp_path / "f", 10) == "a\nb\nc\n"
    write_whole(tmp_path / "f", b"\xff")
    with pytest.raises(FileError, match="not a text file in UTF-8"):
        read_text(tmp_path / "f", 10)


def test_errors_have_the_class_that_was_asked_for(tmp_path):
    class Mine(WrongUse):
        pass

    with pytest.raises(Mine):
        read_regular(tmp_path / "gone", 1, raises=Mine)
    with pytest.raises(Mine):
        check_name("..", "the name", Mine)


@given(st.text())
def test_a_name_that_passes_stays_in_its_folder(name):
    try:
        check_name(name, "the name")
    except FileError:
        return
    assert os.path.basename(os.path.normpath(f"folder/{name}")) == name


@pytest.mark.parametrize("name", ["../../X", "a/b", ".", "..", ".hidden", "", "a\nb", "a\\b", "x" * 101, "-rf", "a\n"])
def test_names_that_are_paths_are_refused(name):
    with pytest.raises(FileError, match="the name is"):
        check_name(name, "the name")


@pytest.mark.parametrize("path", ["x" * 300, "a\0b", "\ud800", "", "/dev/null", "/proc/self/gone"])
def test_what_cannot_be_a_path_is_no_file(path):
    assert not is_file(path)


def test_what_is_shown_is_short_and_has_no_control_characters():
    assert shown("a\x1b[31m" + "b" * 1000) == "a\\x1b[31m" + "b" * 193 + "…"


def test_a_line_that_a_killed_program_left_unfinished_is_cut_off(tmp_path):
    file = tmp_path / "lines"
    cut_unfinished_line(file)
    assert not file.exists()
    for line in (b"one", b"two"):
        append_line(file, line)
    for left, whole in ((b"", b"one\ntwo\n"), (b"x" * 200_000, b"one\ntwo\n"), (b"th", b"one\ntwo\n")):
        file.write_bytes(whole + left)
        cut_unfinished_line(file)
        assert file.read_bytes() == whole
    file.write_bytes(b"no line at all" * 10_000)
    cut_unfinished_line(file)
    assert file.read_bytes() == b""

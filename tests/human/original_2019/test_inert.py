"""A pickle is taken apart and nothing in it is run, whatever it holds."""

import os
import pickle
import sys

import pytest

from overcooked_bench.human.original_2019.inert import MOST_STEPS, Name, PickleError, Shell, read_pickle
from tests.human.original_2019.pickled import ARRAY, FRAME, Call, dumped, named


class Trap:
    """Makes a folder when it is unpickled."""

    def __init__(self, folder):
        self.folder = folder

    def __reduce__(self):
        return os.mkdir, (self.folder,)


def text(value: str) -> bytes:
    return pickle.SHORT_BINUNICODE + bytes([len(value)]) + value.encode()


FRAME_NAME = text("pandas.core.frame") + text("DataFrame") + pickle.STACK_GLOBAL
SHELL = FRAME_NAME + pickle.EMPTY_TUPLE + pickle.NEWOBJ
CALL = pickle.EMPTY_TUPLE + pickle.REDUCE
WHOLE = {
    "a call of the shell": (dumped(Call(named("os.system"), "touch x")), r"the name os\.system"),
    "eval": (dumped(Call(named("builtins.eval"), "1")), r"the name builtins\.eval"),
    "getattr": (dumped(Call(named("builtins.getattr"), ARRAY, "x")), r"the name builtins\.getattr"),
    "another name of a module": (dumped(named("numpy.core.multiarray.scalar")), r"multiarray\.scalar"),
    "another module": (dumped(named("pandas.io.pickle.DataFrame")), r"pandas\.io\.pickle\.DataFrame"),
    "a name for its own": (dumped(len), r"builtins\.len"),
}
PIECES = {
    "a name with dots": (text("pandas.core.frame") + text("DataFrame.to_pickle") + b"\x93", r"DataFrame\.to_pickle"),
    "a module in a name": (text("numpy") + text("core.multiarray._reconstruct") + b"\x93", "multiarray"),
    "a name that is a number": (text("numpy") + b"K\x01\x93", "no text"),
    "a name that is a list": (text("numpy") + b"]\x93", "no text"),
    "GLOBAL": (b"cposix\nsystem\n", "the opcode GLOBAL"),
    "GLOBAL of a known name": (b"cnumpy\nndarray\n", "the opcode GLOBAL"),
    "INST": (b"(S'id'\nios\nsystem\n", "the opcode STRING"),
    "INST alone": (b"(ios\nsystem\n", "the opcode INST"),
    "OBJ": (b"(" + FRAME_NAME + b"o", "the opcode OBJ"),
    "NEWOBJ_EX": (FRAME_NAME + b")}\x92", "the opcode NEWOBJ_EX"),
    "EXT1": (b"\x82\x01", "the opcode EXT1"),
    "EXT2": (b"\x83\x01\x00", "the opcode EXT2"),
    "EXT4": (b"\x84\x01\x00\x00\x00", "the opcode EXT4"),
    "PERSID": (b"Pid\n", "the opcode PERSID"),
    "BINPERSID": (b"N\x51", "the opcode BINPERSID"),
    "NEXT_BUFFER": (b"\x97", "the opcode NEXT_BUFFER"),
    "PUT far away": (b"Nr\xff\xff\xff\xff", "the opcode LONG_BINPUT"),
    "GET far away": (b"j\xff\xff\xff\xff", "damaged"),
    "DUP": (b"N2", "the opcode DUP"),
    "a long number": (b"\x8b\xff\xff\xff\x7f", "the opcode LONG4"),
    "an unknown opcode": (b"\xff", "the opcode b'.xff'"),
    "endless bytes": (b"B\xff\xff\xff\xffx", "it ends early"),
    "endless text": (b"X\xff\xff\xff\x7fx", "it ends early"),
    "half a number": (b"J\x00", "it ends early"),
    "text that is none": (b"\x8c\x01\xff", "damaged"),
    "nothing to call": (b")R", "damaged"),
    "a call of a shell": (SHELL + CALL, "a call of what is not a name"),
    "a call of a text": (text("os.system") + CALL, "a call of what is not a name"),
    "a call with a list": (FRAME_NAME + b"]R", "a call of what is not a name"),
    "a state for a name": (FRAME_NAME + b"}b", "a Name where a Shell belongs"),
    "a state for a list": (b"]}b", "a list where a Shell belongs"),
    "a second state": (SHELL + b"}b}b", "filled twice"),
    "an item of a shell": (SHELL + text("x") + b"Ns", "a Shell where a dict belongs"),
    "an entry of a shell": (SHELL + b"Na", "a Shell where a list belongs"),
    "a list as a key": (b"}]Ns", "keys that are no texts"),
    "half an item": (b"}(" + text("x") + b"u", "keys that are no texts"),
    "a mark that is missing": (b"t", "damaged"),
    "values below a mark": (b"K\x01(\x85", "damaged"),
    "two results": (b"NN", "damaged"),
}


@pytest.mark.parametrize(("data", "message"), WHOLE.values(), ids=WHOLE.keys())
def test_other_names_are_refused(data, message):
    with pytest.raises(PickleError, match=rf"^x: byte \d+: .*{message}"):
        read_pickle(data, "x")


@pytest.mark.parametrize(("piece", "message"), PIECES.values(), ids=PIECES.keys())
def test_what_no_table_needs_is_refused(piece, message):
    with pytest.raises(PickleError, match=rf"^x: byte \d+: .*{message}"):
        read_pickle(b"\x80\x04" + piece + b".", "x")


def test_what_python_would_run_is_not_run(tmp_path):
    trap = Trap(str(tmp_path / "sprung"))
    for protocol in range(6):
        with pytest.raises(PickleError):
            read_pickle(pickle.dumps(trap, protocol), "x")
    assert not (tmp_path / "sprung").exists()
    pickle.loads(pickle.dumps(trap))
    assert (tmp_path / "sprung").exists()


def test_no_name_is_imported():
    before = set(sys.modules)
    found = read_pickle(dumped([FRAME, named("pandas.core.indexes.range.RangeIndex")]), "x")
    assert found == [Name("pandas.core.frame", "DataFrame"), Name("pandas.core.indexes.range", "RangeIndex")]
    assert set(sys.modules) == before


def test_a_state_is_kept_and_sets_nothing():
    state = {"__class__": "evil", "kind": "evil", "__dict__": {"kind": 1}, "__setstate__": 2, "__reduce__": 3}
    filled = FRAME()
    filled.state = state
    found = read_pickle(dumped(filled), "x")
    assert type(found) is Shell
    assert found.kind == Name("pandas.core.frame", "DataFrame")
    assert (found.arguments, found.state) == ((), state)


def test_slots_of_a_state_set_nothing():
    """Python would set the attributes that the second dict of such a state names."""
    found = read_pickle(b"\x80\x04" + SHELL + b"N}" + text("kind") + b"Ns\x86b.", "x")
    assert (found.kind.name, found.state) == ("DataFrame", (None, {"kind": None}))


def test_plain_values_are_those_of_python():
    values = [None, True, False, 0, 255, 65535, -(2**31), "ä" * 300, b"x" * 300, (), (1,), (1, 2, 3), (1, 2, 3, 4)]
    whole = {"values": values, "again": values, "more": {"x": [[]], "y": {}}}
    found = read_pickle(pickle.dumps(whole, 4), "x")
    assert found == whole
    assert found["values"] is found["again"]


@pytest.mark.parametrize("end", range(0, 200, 7))
def test_what_is_cut_short_is_refused(end):
    data = dumped([Call(ARRAY, (0,), b"b", state=(1, ["x"] * 20)), "y" * 100, {"a": 1, "b": 2}])
    assert len(data) > 200
    with pytest.raises(PickleError, match=r"ends early|damaged"):
        read_pickle(data[:end], "x")
    with pytest.raises(PickleError, match="more after its end"):
        read_pickle(data + b"N", "x")


def test_opcodes_without_end_are_refused():
    with pytest.raises(PickleError, match="more than 1,000,000 opcodes"):
        read_pickle(b"\x80\x04" + b"N" * (MOST_STEPS + 5), "x")


def test_deep_values_end_as_they_began():
    found = read_pickle(b"\x80\x04N" + b"\x85" * 200_000 + b".", "x")
    depth = 0
    while found is not None:
        (found,), depth = found, depth + 1
    assert depth == 200_000

"""Takes a pickle of a pandas table apart without running anything that it names.

Python's unpickler imports what a pickle names and calls it. This reader does neither: it knows the opcodes that a table
consists of and ten names, none of which it looks up. What the pickle would have made of a name is a `Shell` that
notes the arguments and the state, and that is all.

Source of the opcodes: `pickletools` of the standard library.
"""

import pickletools
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown

MOST_STEPS: Final = 1_000_000
"""Opcodes that are followed: together with the size of the data, they bound memory and time."""

NAMES: Final = {
    "numpy": {"dtype", "ndarray"},
    "numpy.core.multiarray": {"_reconstruct"},
    "pandas.core.frame": {"DataFrame"},
    "pandas.core.indexes.base": {"Index", "_new_Index"},
    "pandas.core.indexes.numeric": {"Int64Index"},
    "pandas.core.indexes.range": {"RangeIndex"},
    "pandas.core.internals.managers": {"BlockManager"},
}
"""Names that a pickle may hold, by module."""


class PickleError(WrongUse):
    """A pickle is damaged, or holds more than a table; the message names the byte."""


@dataclass(frozen=True, slots=True)
class Name:
    """A name from a pickle, only as text.

    Attributes:
        module: Where the pickle says that it is defined.
        name: What it is called there.
    """

    module: str
    name: str


@dataclass(eq=False, repr=False, slots=True)
class Shell:
    """What a pickle would have made an object of.

    Attributes:
        kind: The class or function that would have been called.
        arguments: With which arguments.
        state: What the object would have been filled with; None if with nothing.
    """

    kind: Name
    arguments: tuple[Any, ...]
    state: Any = None


def read_pickle(data: bytes, where: str) -> Any:
    """Reads a pickle as plain values, lists, tuples, dicts, names and shells.

    Args:
        data: The pickle.
        where: Its name, for messages.

    Raises:
        PickleError: It is damaged, or holds an opcode or a name that no table needs; names the byte.
    """
    reader, place = _Reader(), 0
    try:
        for _ in range(MOST_STEPS):
            begin, code = place, data[place : place + 1]
            if not code:
                raise _Refused("it ends early")
            if code not in _OPCODES:
                raise _Refused(f"the opcode {_ALL.get(code, code)}, which no table needs")
            number, counted, do = _OPCODES[code]
            argument: Any = None
            place += 1
            if number:
                (argument,) = number.unpack_from(data, place)
                place += number.size
            if counted:
                if argument > len(data) - place:
                    raise _Refused("it ends early")
                argument, place = data[place : place + argument], place + argument
            if do is not None:
                do(reader, argument)
            elif place != len(data):
                raise _Refused("there is more after its end")
            else:
                return reader.result()
        raise _Refused(f"more than {MOST_STEPS:,} opcodes")
    except struct.error:
        reason = "it ends early"
    except (IndexError, UnicodeDecodeError):
        reason = "damaged"
    except _Refused as refused:
        reason = str(refused)
    raise PickleError(
        f"{where}: byte {begin}: {reason}; only pickles of pandas tables are read, and nothing in them run"
    )


class _Refused(Exception):
    """The pickle is not read any further."""


class _Reader:
    """The stack, the stacks below each mark, and the memo of a pickle."""

    def __init__(self) -> None:
        self.stack: list[Any] = []
        self._below: list[list[Any]] = []
        self._memo: list[Any] = []

    def result(self) -> Any:
        if len(self.stack) != 1 or self._below:
            raise _Refused("damaged")
        return self.stack[0]

    def mark(self, _: None) -> None:
        self._below.append(self.stack)
        self.stack = []

    def since_mark(self) -> list[Any]:
        found, self.stack = self.stack, self._below.pop()
        return found

    def memoize(self, _: None) -> None:
        self._memo.append(self.stack[-1])

    def recall(self, index: int) -> None:
        self.stack.append(self._memo[index])

    def push(self, value: Any) -> None:
        self.stack.append(value)

    def text(self, value: bytes) -> None:
        self.stack.append(value.decode("utf-8"))

    def marked_tuple(self, _: None) -> None:
        entries = self.since_mark()
        self.stack.append(tuple(entries))

    def append(self, _: None) -> None:
        entry = self.stack.pop()
        self._top(list).append(entry)

    def appends(self, _: None) -> None:
        entries = self.since_mark()
        self._top(list).extend(entries)

    def set_item(self, _: None) -> None:
        value, key = self.stack.pop(), self.stack.pop()
        self._set([key, value])

    def set_items(self, _: None) -> None:
        self._set(self.since_mark())

    def name(self, _: None) -> None:
        name, module = self.stack.pop(), self.stack.pop()
        if not isinstance(module, str) or not isinstance(name, str) or name not in NAMES.get(module, ()):
            what = f"{module}.{name}" if isinstance(module, str) and isinstance(name, str) else "that is no text"
            raise _Refused(f"the name {shown(what)}, which no table needs")
        self.stack.append(Name(module, name))

    def make(self, _: None) -> None:
        arguments, kind = self.stack.pop(), self.stack.pop()
        if not isinstance(kind, Name) or not isinstance(arguments, tuple):
            raise _Refused("a call of what is not a name")
        self.stack.append(Shell(kind, arguments))

    def fill(self, _: None) -> None:
        state = self.stack.pop()
        shell = self._top(Shell)
        if shell.state is not None:
            raise _Refused("an object that is filled twice")
        shell.state = state

    def _set(self, entries: list[Any]) -> None:
        keys = entries[::2]
        if len(entries) % 2 or not all(isinstance(key, str) for key in keys):
            raise _Refused("a dict with keys that are no texts")
        self._top(dict).update(zip(keys, entries[1::2], strict=True))

    def _top(self, kind: type) -> Any:
        if not isinstance(self.stack[-1], kind):
            raise _Refused(f"a {type(self.stack[-1]).__name__} where a {kind.__name__} belongs")
        return self.stack[-1]


def _last(count: int) -> Callable[[_Reader, Any], None]:
    """Makes what joins the last values of the stack to a tuple."""

    def join(reader: _Reader, _: None) -> None:
        if len(reader.stack) < count:
            raise IndexError
        reader.stack[-count:] = [tuple(reader.stack[-count:])]

    return join


class _Opcode(NamedTuple):
    """An opcode: the number that follows, whether that counts bytes which follow in turn, and what it does."""

    number: struct.Struct | None
    counted: bool
    do: Callable[[_Reader, Any], None] | None  # None: the end


def _plain(do: Callable[[_Reader, Any], None] | None) -> _Opcode:
    return _Opcode(None, False, do)


def _number(form: str, do: Callable[[_Reader, Any], None]) -> _Opcode:
    return _Opcode(struct.Struct(form), False, do)


def _counted(form: str, do: Callable[[_Reader, Any], None]) -> _Opcode:
    return _Opcode(struct.Struct(form), True, do)


_KNOWN: Final = {
    "PROTO": _number("<B", lambda reader, number: None),
    "FRAME": _number("<Q", lambda reader, number: None),
    "STOP": _plain(None),
    "NONE": _plain(lambda reader, _: reader.push(None)),
    "NEWTRUE": _plain(lambda reader, _: reader.push(True)),
    "NEWFALSE": _plain(lambda reader, _: reader.push(False)),
    "BININT": _number("<i", _Reader.push),
    "BININT1": _number("<B", _Reader.push),
    "BININT2": _number("<H", _Reader.push),
    "SHORT_BINUNICODE": _counted("<B", _Reader.text),
    "BINUNICODE": _counted("<I", _Reader.text),
    "SHORT_BINBYTES": _counted("<B", _Reader.push),
    "BINBYTES": _counted("<I", _Reader.push),
    "EMPTY_LIST": _plain(lambda reader, _: reader.push([])),
    "EMPTY_DICT": _plain(lambda reader, _: reader.push({})),
    "EMPTY_TUPLE": _plain(lambda reader, _: reader.push(())),
    "TUPLE1": _plain(_last(1)),
    "TUPLE2": _plain(_last(2)),
    "TUPLE3": _plain(_last(3)),
    "TUPLE": _plain(_Reader.marked_tuple),
    "MARK": _plain(_Reader.mark),
    "APPEND": _plain(_Reader.append),
    "APPENDS": _plain(_Reader.appends),
    "SETITEM": _plain(_Reader.set_item),
    "SETITEMS": _plain(_Reader.set_items),
    "MEMOIZE": _plain(_Reader.memoize),
    "BINGET": _number("<B", _Reader.recall),
    "LONG_BINGET": _number("<I", _Reader.recall),
    "STACK_GLOBAL": _plain(_Reader.name),
    "NEWOBJ": _plain(_Reader.make),
    "REDUCE": _plain(_Reader.make),
    "BUILD": _plain(_Reader.fill),
}
_ALL: Final = {opcode.code.encode("latin-1"): opcode.name for opcode in pickletools.opcodes}
_OPCODES: Final = {code: _KNOWN[name] for code, name in _ALL.items() if name in _KNOWN}

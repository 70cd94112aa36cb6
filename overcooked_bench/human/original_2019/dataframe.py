"""Reads columns of a pandas table that was taken apart by `inert`; pandas is not needed.

Source of the form: pickles of `DataFrame` as pandas 0.24 to 1.0 wrote them (`BlockManager.__getstate__`).
"""

from collections.abc import Mapping
from typing import Any, Final

import numpy as np

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown
from overcooked_bench.human.original_2019.inert import Name, Shell

_NUMBERS: Final = {"b1": "?", "f8": "<f8", "i8": "<i8"}
_TABLE: Final = Name("pandas.core.frame", "DataFrame")
_BLOCKS: Final = Name("pandas.core.internals.managers", "BlockManager")
_INDEX: Final = Name("pandas.core.indexes.base", "_new_Index")
_ARRAY: Final = Name("numpy.core.multiarray", "_reconstruct")
_TYPE: Final = Name("numpy", "dtype")


class TableError(WrongUse):
    """A table is not of the form that is expected, or lacks a column."""


def read_columns(table: Any, wanted: Mapping[str, type], where: str) -> dict[str, list[Any]]:
    """Reads some columns of a table and nothing else.

    Args:
        table: What `read_pickle` returned.
        wanted: The columns' names -> the type of their entries: bool, int, float or str.
        where: The table's name, for messages.

    Returns:
        Each column, all of one length.

    Raises:
        TableError: It is not a table, or one of the columns is missing or of another type.
    """
    found: dict[str, list[Any]] = {}
    try:
        _, values, items = _state(_state(table, _TABLE)["_data"], _BLOCKS)[:3]
        for block, index in zip(values, items, strict=True):
            (names,) = _array(_made(index, _INDEX).arguments[1]["data"], 1)
            for name, column in zip(names, _array(block, 2), strict=True):
                if type(name) is str and name in wanted:  # hashing a deep tuple would end the process
                    found[name] = column
    except (TypeError, ValueError, LookupError) as error:
        raise TableError(f"{where}: not a pandas table of the form that is read here ({shown(error)})") from None
    for name, kind in wanted.items():
        if name not in found:
            raise TableError(f"{where}: the table has no column {name!r}")
        if any(type(entry) is not kind for entry in found[name]):
            raise TableError(f"{where}: the column {name!r} holds something else than {kind.__name__}")
    if len({len(column) for column in found.values()}) > 1:
        raise TableError(f"{where}: the table's columns are not of one length")
    return found


def _made(shell: Any, kind: Name) -> Shell:
    if not isinstance(shell, Shell) or shell.kind != kind:
        raise ValueError(f"no {kind.name} where one belongs")
    return shell


def _state(shell: Any, kind: Name) -> Any:
    return _made(shell, kind).state


def _array(shell: Any, dimensions: int) -> list[list[Any]]:
    """Returns an array of one or two dimensions as a list of rows."""
    _, shape, type_, by_columns, content = _state(shell, _ARRAY)
    code = _made(type_, _TYPE).arguments[0]
    if by_columns is not False or len(shape) != dimensions or any(type(n) is not int or n < 1 for n in shape):
        raise ValueError("an array of another shape")
    count, length = (1, *shape)[-2:]
    if code == "O8" and type(content) is list and len(content) == count * length:
        return [content[i * length : (i + 1) * length] for i in range(count)]
    if type(code) is not str or code not in _NUMBERS or type(content) is not bytes:
        raise ValueError("an array of another type or size")
    rows: list[list[Any]] = np.frombuffer(content, _NUMBERS[code]).reshape(count, length).tolist()
    return rows

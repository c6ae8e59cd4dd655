"""A MAT-file as tables: one of each structure that holds vectors, named by its place in the file."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from typing import IO, TYPE_CHECKING

import numpy as np

from connectors.exports.cells.tag_roles import ROLE, is_time, plain
from connectors.exports.fault import MOST_COLUMNS, RecordingError
from connectors.exports.tables.mat5 import MatFileError, Value, variables
from connectors.exports.tables.sheet import Column, Sheet

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.exports.tables.sheet import FloatArray

MAGIC = b"MATL"
MOST_UNPACKED = 1 << 27
"""Bytes of a file, unpacked: all is held in memory, where a number of one byte takes eight."""
SAMPLING = frozenset({"ts", "dt", "sampletime", "samplingtime", "samplinginterval", "sampleperiod"})
"""Names of a number that is the sampling time, s; that of ISDB is ``Ts``."""

NO_WORD = re.compile(r"\W|^$")
"""What a name in a path may not have; MATLAB gives no such names."""

Vectors = dict[str, "FloatArray"]


def is_matlab(head: bytes) -> bool:
    """Return whether a file is a MAT-file by its first bytes."""
    return head.startswith(MAGIC)


def sheets_of_matlab(path: Path, content: IO[bytes]) -> tuple[Sheet, ...]:
    """Return a table of each structure with vectors as long as each other, the most that are.

    Raises:
        RecordingError: It is no MAT-file up to version 7, is too large, or has no vectors.
    """
    data = content.read(MOST_UNPACKED + 1)
    if len(data) > MOST_UNPACKED:
        raise RecordingError(f"{path}: is larger than {MOST_UNPACKED >> 20} MiB: split it by loop")
    try:
        held = variables(data, MOST_UNPACKED)
    except MatFileError as error:
        raise RecordingError(f"{path}: expected a MAT-file: {error}") from error
    found = tuple(_sheet(path, *each) for each in _structures((), held, None) if each[1])
    if not found:
        raise RecordingError(
            f"{path}: holds no vectors of numbers: save OP and PV as vectors or in a structure "
            "(a table or a timeseries as a structure)"
        )
    return found


def _structures(
    place: tuple[str, ...], held: Mapping[str, Value], ts: float | None
) -> Iterator[tuple[tuple[str, ...], Vectors, float | None]]:
    """Yield place, vectors and sampling time, s, of a structure and of those within it, which inherit it."""
    vectors: Vectors = {}
    inner: list[tuple[str, Mapping[str, Value]]] = []
    for name, value in held.items():
        if isinstance(value, dict):
            inner.append((name, value))
        elif isinstance(value, list):
            inner += [(f"{name}{k}", each) for k, each in enumerate(value, 1) if isinstance(each, dict)]
        elif value is not None and value.ndim:
            vectors.update(_columns(name, value))
        elif value is not None and plain(name) in SAMPLING and 0 < value < np.inf:
            ts = float(value)
    yield place, vectors, ts
    for name, within in inner:
        yield from _structures((*place, NO_WORD.sub("_", name)), within, ts)


def _columns(name: str, values: FloatArray) -> Vectors:
    """Return a vector by its name, the columns of a matrix with numbers behind it."""
    if values.ndim == 1:
        return {name: values} if len(values) else {}
    if values.ndim == 2 and values.shape[1] <= min(values.shape[0], MOST_COLUMNS):
        return {f"{name}{k + 1}": values[:, k] for k in range(values.shape[1])}
    return {}


def _sheet(path: Path, place: tuple[str, ...], vectors: Vectors, ts: float | None) -> Sheet:
    lengths = Counter(len(each) for each in vectors.values())
    length = max(lengths, key=lambda each: (lengths[each], each))
    own = path.joinpath(*place)
    columns = [
        Column(name, each if len(each) == length else _refused(own, name, len(each), length))
        for name, each in vectors.items()
        if len(each) == length or plain(name) in ROLE
    ]
    if ts is not None and not any(is_time(each.name) for each in columns):
        columns.insert(0, Column("time [s]", ts * np.arange(length, dtype=np.float64)))
    return Sheet(own, tuple(columns), range(1, length + 1), "row", 1, "matlab")


def _refused(path: Path, name: str, found: int, expected: int) -> Callable[[], FloatArray]:
    """Return what raises when the vector of a role is read that is not as long as the others of its loop."""

    def read() -> FloatArray:
        raise RecordingError(f"{path}: {name} has {found} values, expected {expected} as in the others")

    return read

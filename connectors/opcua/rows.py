"""Values of a loop that a server sends one after the other with the same time become one piece."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from connectors.base import LoopRole, Sample
from connectors.opcua.notification import NodeValue, ValueBlock
from connectors.opcua.values import is_waiting, sample
from connectors.readings import Readings

_NOWHERE = -1
"""Column of a node that is read for several tags."""


class _Row:
    """A loop, and which of its tags have come in one piece."""

    def __init__(self) -> None:
        self.names: list[LoopRole] = []
        self._tags: dict[tuple[int, ...] | None, tuple[LoopRole, ...]] = {}

    def piece(self, columns: tuple[int, ...] | None, time: float, values: np.ndarray) -> Sample | Readings:
        """Return what came of these columns, None: of all; readings have the same tags again."""
        if len(values) == 1:
            place = 0 if columns is None else columns[0]
            return Sample.measured(self.names[place], time, float(values[0]))
        tags = self._tags.get(columns)
        if tags is None:
            there = range(len(self.names)) if columns is None else columns
            tags = self._tags[columns] = tuple(self.names[each] for each in there)
        return Readings(tags, time, values)


class LoopRows:
    """Gives values on in their order."""

    def __init__(self, tags: Mapping[str, Sequence[LoopRole]]) -> None:
        """Make it of what each node is read for."""
        self._tags = tags
        rows: dict[str, _Row] = {}
        self._rows: list[_Row] = []
        self._places: dict[str, tuple[int, int]] = {}
        """Of each node: number of its row, and its column."""
        numbers: dict[str, int] = {}
        for node, names in tags.items():
            for name in names:
                if name.loop not in rows:
                    numbers[name.loop] = len(self._rows)
                    rows[name.loop] = _Row()
                    self._rows.append(rows[name.loop])
                row = rows[name.loop]
                alone = len(names) == 1
                self._places[node] = numbers[name.loop], len(row.names) if alone else _NOWHERE
                row.names.append(name)
        self._widths = np.array([len(row.names) for row in self._rows], np.intp)

    def pieces(
        self, nodes: Sequence[str], values: ValueBlock | Sequence[NodeValue]
    ) -> Iterator[Sample | Readings]:
        """Yield what came of the nodes, values of a loop side by side with one time together."""
        if not isinstance(values, ValueBlock):
            yield from self._one_by_one(nodes, values)
            return
        row, column = np.array([self._places[node] for node in nodes], np.intp).reshape(-1, 2).T
        plain = (values.status == 0) & np.isfinite(values.values) & (column != _NOWHERE)
        goes_on = (row[1:] == row[:-1]) & (column[1:] > column[:-1]) & (values.times[1:] == values.times[:-1])
        starts = np.flatnonzero(np.append([True], ~goes_on))
        ends = np.append(starts[1:], [len(nodes)])
        all_plain = np.logical_and.reduceat(plain, starts)
        whole = ends - starts == self._widths[row[starts]]
        items = None if all_plain.all() else [change for _, change in values.items()]
        groups = (all_plain, whole, starts, ends, row[starts], values.times[starts])
        for usual, full, start, end, number, time in zip(*(each.tolist() for each in groups), strict=True):
            if usual:
                columns = None if full else tuple(column[start:end].tolist())
                yield self._rows[number].piece(columns, time, values.values[start:end])
            elif items is not None:
                yield from self._one_by_one(nodes[start:end], items[start:end])

    def _one_by_one(self, nodes: Sequence[str], changes: Sequence[NodeValue]) -> Iterator[Sample | Readings]:
        held: list[tuple[int, float]] = []
        """Columns and values of the loop ``number`` at ``time``."""
        number, time = 0, math.nan
        for node, change in zip(nodes, changes, strict=True):
            row, column = self._places[node]
            value = change.value
            plain = column != _NOWHERE and _is_plain(change)
            if held and not (plain and row == number and change.time == time and column > held[-1][0]):
                yield self._held(number, time, held)
                held = []
            if plain and isinstance(value, int | float):
                number, time = row, change.time
                held.append((column, float(value)))
            elif not is_waiting(change):
                for name in self._tags[node]:
                    yield sample(name, change)
        if held:
            yield self._held(number, time, held)

    def _held(self, number: int, time: float, held: Sequence[tuple[int, float]]) -> Sample | Readings:
        columns, values = zip(*held, strict=True)
        row = self._rows[number]
        return row.piece(columns if len(columns) < len(row.names) else None, time, np.array(values))


def _is_plain(change: NodeValue) -> bool:
    """Return whether a value is a good number with a time, and nothing else is to be said of it."""
    value = change.value
    return (
        change.status == 0
        and isinstance(value, int | float)
        and math.isfinite(value)
        and not math.isnan(change.time)
    )

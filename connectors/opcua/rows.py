"""Values of a loop that a server sends one after the other with the same time become one piece."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from connectors.base import LoopRole, Sample
from connectors.opcua.notification import Block, Change
from connectors.opcua.values import is_waiting, sample
from connectors.readings import Readings


class _Row:
    """What came of a loop with one time."""

    def __init__(self) -> None:
        self.names: list[LoopRole] = []
        """All tags of the loop."""
        self.time = math.nan
        self._values: dict[int, float] = {}
        self._tags: dict[tuple[int, ...], tuple[LoopRole, ...]] = {}
        """By columns: readings with the same tags have the same object."""

    @property
    def all_tags(self) -> tuple[LoopRole, ...]:
        """All tags of the loop, the same object each time."""
        return self._of(tuple(range(len(self.names))))

    def takes(self, column: int, time: float) -> bool:
        """Return whether a value belongs to it."""
        return not self._values or (time == self.time and column not in self._values)

    def put(self, column: int, time: float, value: float) -> bool:
        """Take a value that belongs to it; return whether it is complete."""
        self.time = time
        self._values[column] = value
        return len(self._values) == len(self.names)

    def ended(self) -> Iterator[Sample | Readings]:
        """Yield what came, and begin anew."""
        values, self._values = self._values, {}
        if len(values) > 1:
            columns = tuple(sorted(values))
            yield Readings(self._of(columns), self.time, np.array([values[each] for each in columns]))
        elif values:
            ((column, value),) = values.items()
            yield Sample.measured(self.names[column], self.time, value)

    def _of(self, columns: tuple[int, ...]) -> tuple[LoopRole, ...]:
        tags = self._tags.get(columns)
        if tags is None:
            tags = self._tags[columns] = tuple(self.names[each] for each in columns)
        return tags


class _Place(NamedTuple):
    """Where values of a node belong."""

    row: _Row
    column: int


_NOWHERE = (-1, -1)
"""Row and column of a node that is read for several tags."""


class LoopRows:
    """Gives values on in their order, those of a loop with the same time together."""

    def __init__(self, tags: Mapping[str, Sequence[LoopRole]]) -> None:
        """Make it of what each node is read for."""
        rows: dict[str, _Row] = {}
        self._places: dict[str, list[_Place]] = {}
        for node, names in tags.items():
            for name in names:
                row = rows.setdefault(name.loop, _Row())
                self._places.setdefault(node, []).append(_Place(row, len(row.names)))
                row.names.append(name)
        self._rows = list(rows.values())
        number = {row: k for k, row in enumerate(self._rows)}
        self._places_of = {
            node: (number[places[0].row], places[0].column) if len(places) == 1 else _NOWHERE
            for node, places in self._places.items()
        }
        self._widths = np.array([len(row.names) for row in self._rows])
        self._begun: dict[_Row, None] = {}

    def put_many(self, nodes: Sequence[str], block: Block) -> Iterator[Sample | Readings]:
        """Do what ``put`` does with each; all of a loop side by side is taken at once."""
        places = np.array([self._places_of[node] for node in nodes])
        row, column = places.T
        plain = (block.status == 0) & np.isfinite(block.values) & (row >= 0)
        goes_on = (
            (row[1:] == row[:-1]) & (column[1:] == column[:-1] + 1) & (block.times[1:] == block.times[:-1])
        )
        starts = np.flatnonzero(np.append([True], ~goes_on))
        ends = np.append(starts[1:], [len(nodes)])
        whole = (column[starts] == 0) & (ends - starts == self._widths[row[starts]])
        whole &= np.logical_and.reduceat(plain, starts)
        items: list[tuple[int, Change]] = [] if whole.all() else block.items()
        for k, start, end, at in zip(
            whole.tolist(), starts.tolist(), ends.tolist(), block.times[starts].tolist(), strict=True
        ):
            if k:
                own = self._rows[row[start]]
                yield from own.ended()
                yield Readings(own.all_tags, at, block.values[start:end])
                continue
            for place in range(start, end):
                yield from self.put(nodes[place], items[place][1])

    def put(self, node: str, change: Change) -> Iterator[Sample | Readings]:
        """Take a value, and yield what waits for no others any more."""
        if is_waiting(change):
            return
        value, plain = change.value, _is_plain(change)
        for row, column in self._places[node]:
            if not plain or not row.takes(column, change.time):
                yield from row.ended()
            if not plain or not isinstance(value, int | float):
                yield sample(row.names[column], change)
                continue
            self._begun[row] = None
            if row.put(column, change.time, float(value)):
                yield from row.ended()
                del self._begun[row]

    def ended(self) -> Iterator[Sample | Readings]:
        """Yield all that still waits: nothing more came."""
        for row in self._begun:
            yield from row.ended()
        self._begun.clear()


def _is_plain(change: Change) -> bool:
    """Return whether a value is a good number with a time, and nothing else is to be said of it."""
    value = change.value
    return (
        change.status == 0
        and isinstance(value, int | float)
        and math.isfinite(value)
        and not math.isnan(change.time)
    )

"""Rows of a loop: values of its roles at one time each, gathered to be taken in together.

What depends on the times alone is computed once for all loops that were read together.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray

FINE = 200
"""Parts of a sampling time to which it is kept when a value was reported: what matters is whether PV and OP
are reported together, and for how long nobody reported."""
HELD = -128
"""In place of such a time, at points that hold a former value."""


class Filled(NamedTuple):
    """All slots that rows change."""

    source: NDArray[np.intp]
    """Which row's value each has, from 1; 0: that which was there before the rows, (m,)."""
    reports: NDArray[np.int8]
    """When each was reported, in parts of a sampling time from its slot, or ``HELD``, (m,)."""
    at: NDArray[np.int64]
    """Where each is in the ring, (m,)."""
    added: int
    """How many of them are behind ``newest``."""


class GridPlaces:
    """Where times lie on the grid of a window."""

    def __init__(self, times: FloatArray, origin: float, ts: float) -> None:
        """Find them.

        Args:
            times: s UTC, (n,), increasing.
            origin: Where the grid begins, s UTC.
            ts: Sampling time, s.
        """
        places = (times - origin) / ts
        rounded = np.rint(places)
        self.earliest, self.latest = float(times[0]), float(times[-1])
        self._slots = rounded.astype(np.int64)
        self._reports = np.rint((places - rounded) * FINE).astype(np.int8)
        self.first, self.last = int(self._slots[0]), int(self._slots[-1])
        self.before_last = int(self._slots[-2]) if len(times) > 1 else self.first
        self._filled: dict[tuple[int, int], Filled] = {}

    def filled(self, newest: int, capacity: int) -> Filled:
        """Return what becomes of the slots from ``newest``, the last one that has a value, on.

        The last value of a slot counts, and one holds until the next. ``newest`` itself is among them where
        the first time belongs to it.
        """
        if (newest, capacity) not in self._filled:
            first = newest + (self.first != newest)
            counts = np.flatnonzero(np.append(self._slots[1:] != self._slots[:-1], [True]))
            slots = self._slots[counts] - first
            reports = np.full(self.last - first + 1, HELD, dtype=np.int8)
            reports[slots] = self._reports[counts]
            before = np.searchsorted(slots, np.arange(len(reports)), side="right")
            source = np.append([0], counts + 1)[before]
            at = np.arange(first, self.last + 1) % capacity
            self._filled[newest, capacity] = Filled(source, reports, at, self.last - newest)
        return self._filled[newest, capacity]


class RowTimes:
    """When rows came."""

    def __init__(self, times: FloatArray, arrivals: FloatArray) -> None:
        """Keep source times (s UTC) and arrivals (monotonic, s), oldest first, (n,) each."""
        self.source = times
        self.arrivals = arrivals
        self._places: dict[tuple[float, float], GridPlaces] = {}
        self._turned: dict[tuple[int, int], tuple[array[float], array[float]]] = {}
        self._off: float | None = None

    @cached_property
    def increasing(self) -> bool:
        """Whether each is newer than the one before."""
        return bool((self.source[1:] > self.source[:-1]).all())

    @cached_property
    def ahead(self) -> FloatArray:
        """Time less arrival, s, (n,)."""
        return self.source - self.arrivals

    @cached_property
    def leap(self) -> float:
        """Most by which one went ahead more than its arrival did, s; -inf where there is only one."""
        return float(np.max(self.ahead[1:] - self.ahead[:-1], initial=-np.inf))

    def newest(self, count: int, place: int) -> tuple[array[float], array[float]]:
        """Return the newest ``count`` times, and how far they are ahead of their arrivals, in a ring.

        ``count`` is at most n; ``place`` is that of the oldest in the ring of ``count``.
        """
        if (count, place) not in self._turned:
            turned = (np.roll(each[-count:], place).tolist() for each in (self.source, self.ahead))
            times, ahead = (array("d", each) for each in turned)
            self._turned[count, place] = (times, ahead)
        return self._turned[count, place]

    def off(self, now: float) -> float:
        """Return how far the worst was from this machine's clock when it came; that shows ``now``, s UTC."""
        if self._off is None:
            self._off = float(np.abs(self.source - (now - (self.arrivals[-1] - self.arrivals))).max())
        return self._off

    def places(self, origin: float, ts: float) -> GridPlaces:
        """Return where they lie on a grid that begins at ``origin``, s UTC, and goes on by ``ts``, s."""
        if (origin, ts) not in self._places:
            self._places[origin, ts] = GridPlaces(self.source, origin, ts)
        return self._places[origin, ts]


@dataclass(frozen=True, slots=True)
class ValueRows:
    """What came of one loop, oldest first."""

    roles: tuple[str, ...]
    times: RowTimes
    values: FloatArray
    """(roles, n), all finite."""
    short: NDArray[np.float32]
    """The same in the bits of a ring, with room for what it has before, (roles, 1 + n)."""


def short_of(values: FloatArray) -> NDArray[np.float32]:
    """Return values, (k, n), in 32 bits and behind a column of zeros, (k, 1 + n)."""
    short = np.zeros((len(values), values.shape[1] + 1), dtype=np.float32)
    with np.errstate(over="ignore"):  # beyond 32 bits is infinite, as it is one by one
        short[:, 1:] = values
    return short

"""Values of one role of one loop on their own times, and several of them on common times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from connectors.exports.tables.sheet import FloatArray

MOST_SHIFT = 0.05
"""Part of a sampling time by which two series may differ and still have common times."""


@dataclass(frozen=True, slots=True)
class Series:
    """Values of one role, in order of time."""

    time: FloatArray
    """s UTC, never falling, shape (n,)."""
    values: FloatArray
    """Shape (n,); NaN is a gap. For a mode the index into ``words``."""
    words: tuple[str, ...] = ()
    """Words of a mode; empty for numbers."""
    rows: NDArray[np.intp] | None = None
    """Row of the table that each value came from; None where it came from no table."""

    def at(self, times: FloatArray) -> FloatArray:
        """Return the values at other times, each held until the next one comes; NaN before the first."""
        places = np.searchsorted(self.time, times, side="right") - 1
        held = self.values[np.maximum(places, 0)]
        return np.where(places >= 0, held, np.nan)


def common_times(series: Mapping[str, Series]) -> FloatArray:
    """Return the times on which all roles of a loop are put: those of PV.

    Where PV and OP have the same times but for jitter these are theirs; else OP is held between its own
    times, as a historian that stores changes only means it.
    """
    return series["pv"].time


def on_common_times(series: Mapping[str, Series]) -> dict[str, FloatArray]:
    """Return each role's values at the times of PV, shape (n,).

    A value within a small part of a sampling time counts as simultaneous, so that two clocks that round
    differently do not shift OP by one sample.
    """
    times = common_times(series)
    steps = np.diff(times)
    steps = steps[steps > 0]
    slack = MOST_SHIFT * float(np.median(steps)) if steps.size else 0.0
    return {
        role: each.values
        if each.time is times or np.array_equal(each.time, times)
        else each.at(times + slack)
        for role, each in series.items()
    }


def rising(time: FloatArray, rows: NDArray[np.intp]) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return times and rows oldest first: exports with the newest row first are turned round.

    Most steps decide, for an hour that comes twice is one step the other way.
    """
    return (time[::-1], rows[::-1]) if falls(time) else (time, rows)


def falls(time: FloatArray) -> bool:
    """Return whether most steps of some times, in the order of the file, are backward."""
    steps = np.diff(time[np.isfinite(time)])
    return bool(np.count_nonzero(steps < 0) > np.count_nonzero(steps > 0))


def words_as_numbers(cells: Sequence[str]) -> tuple[FloatArray, tuple[str, ...]]:
    """Return words as indices, shape (n,), and the words; an empty cell is NaN."""
    words = tuple(dict.fromkeys(cell.strip() for cell in cells if cell.strip()))
    index = {word: float(k) for k, word in enumerate(words)}
    return np.array([index.get(cell.strip(), np.nan) for cell in cells], np.float64), words

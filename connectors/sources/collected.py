"""Values of one tag as a source gives them, collected into a series."""

from __future__ import annotations

from array import array
from collections.abc import Hashable, Sequence
from math import isfinite, nan

import numpy as np

from connectors.exports.fault import MOST_ROWS, RecordingError
from connectors.exports.series import Series
from connectors.historian import is_gap


class CollectedTag:
    """Values of one tag: 17 bytes each, whatever the source needs for them."""

    def __init__(self, name: str, *, mode: bool = False) -> None:
        """Begin without values.

        Args:
            name: Of the source and the tag, for messages.
            mode: Whether the values are words.
        """
        self.bad = 0
        """Values that are no number or may not be used; each is a gap."""
        self._name, self._mode = name, mode
        self._time, self._values = array("d"), array("d")
        self._words: dict[str, int] = {}

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self._time)

    def add(self, time: float, value: object, *, good: bool = True) -> None:
        """Take one value.

        Args:
            time: s UTC.
            value: A number, a word, or None where there is none.
            good: Whether its quality allows its use.

        Raises:
            RecordingError: There are more than are held in memory.
        """
        number = self._number(value) if good else nan
        self.bad += number != number  # noqa: PLR0124 - NaN
        self._time.append(time)
        self._values.append(number)
        if len(self._time) > MOST_ROWS:
            raise RecordingError(f"{self._name}: has more than {MOST_ROWS} values: shorten the span")

    def series(self) -> Series:
        """Return them in order of time; those of one time stay in the order in which they came."""
        time, values = np.array(self._time, np.float64), np.array(self._values, np.float64)
        if time.size > 1 and (np.diff(time) < 0).any():
            order = np.argsort(time, kind="stable")
            time, values = time[order], values[order]
        return Series(time, values, tuple(self._words))

    def _number(self, value: object) -> float:
        if self._mode:
            word = f"{value:g}" if isinstance(value, int | float) else str(value or "").strip()
            return float(self._words.setdefault(word, len(self._words))) if word else nan
        if isinstance(value, str):
            try:
                value = nan if is_gap(value) else float(value)
            except ValueError:
                return nan
        return float(value) if isinstance(value, int | float) and isfinite(value) else nan


class Overlap:
    """Pages by time that begin where the page before ended: what was there already is left out.

    Several values may have one time, so a page begins with the last time of the page before, not behind it.
    """

    def __init__(self, size: int) -> None:
        """Begin.

        Args:
            size: Values of a full page.
        """
        self._size = size
        self.last: Hashable | None = None
        """Time of the newest value, as the source writes it; the next page begins there."""
        self._there = 0
        """Values of that time that were taken."""

    def new(self, stamps: Sequence[Hashable]) -> range | None:
        """Return the places of the values of a page that are new; None where the source does not go on.

        Args:
            stamps: Times of the values of the page, never falling.
        """
        first = 0
        while first < min(self._there, len(stamps)) and stamps[first] == self.last:
            first += 1
        if self.is_full(stamps) and first == len(stamps):
            return None
        if len(stamps) > first:
            self.last = stamps[-1]
            self._there = next(
                (k for k, stamp in enumerate(reversed(stamps)) if stamp != self.last), len(stamps)
            )
        return range(first, len(stamps))

    def is_full(self, stamps: Sequence[Hashable]) -> bool:
        """Return whether a page after this one may have more."""
        return len(stamps) >= self._size

"""A stretch of a loop that is due, and the window that is cut there: values as the rings have them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.analysis.recording_stretches import newest_stretch

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from agent.analysis.diagnosis import RecordSummary
    from agent.analysis.record.recording import LoopHints


class DueStretch(NamedTuple):
    """Samples of a loop that are due: a mark in its rings, which keep them for a while."""

    origin: float
    """Time of slot 0, s UTC."""
    first: int
    """Slot of the first sample."""
    n: int
    """Samples."""

    def end(self, ts: float) -> float:
        """Return the time one sampling time, ``ts`` (s), after the last sample, s UTC."""
        return self.origin + (self.first + self.n) * ts


@dataclass(frozen=True, slots=True, eq=False)
class CutWindow:
    """What a window is made of. A worker makes it: to look for wild values takes longer than to cut them."""

    loop: str
    start: float
    """Time of the first sample, s UTC."""
    ts: float
    """Sampling time, s."""
    columns: Mapping[str, NDArray[np.float32]]
    """By role, (n,) each; NaN where nothing is known."""
    hints: LoopHints
    duplicates: int
    """Samples discarded since the window before, because their timestamp was there already."""
    clocks_apart: float
    """How far PV's clock is ahead of OP's, where that is known and matters, s."""
    unknown_modes: tuple[str, ...] = ()
    """Modes of which no table knows whether they are automatic."""

    @property
    def last(self) -> float:
        """Time of the last sample, s UTC."""
        return self.start + self.ts * (len(self.columns["op"]) - 1)

    @property
    def end(self) -> float:
        """One sampling time after the last sample, s UTC."""
        return self.last + self.ts

    def begin_of(self, judged: RecordSummary | None) -> float:
        """Return the time of the first sample that was judged, s UTC; None: all were."""
        if judged is None or judged.samples >= len(self.columns["op"]):
            return self.start
        return self.end - judged.samples * self.ts

    def open(self) -> LoopWindow:
        """Return the window, of a very long one the newest stretch; impossible and wild values are gaps."""
        wide = {role: column.astype(np.float64) for role, column in self.columns.items()}
        known = {role: column for role, column in wide.items() if not np.isnan(column).all()}
        mode = known.get("mode")
        window = LoopWindow(
            loop=self.loop,
            start=self.start,
            ts=self.ts,
            op=wide["op"],
            pv=wide["pv"],
            sp=known.get("sp"),
            mv=known.get("mv"),
            automatic=None if mode is None else mode == 1,
            unknown_modes=self.unknown_modes if mode is not None and (mode == 0).any() else (),
            hints=self.hints,
            duplicates=self.duplicates,
            clocks_apart=self.clocks_apart,
        )
        return newest_stretch(window)

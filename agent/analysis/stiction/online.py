"""The indices of the batch detectors of shape, sample by sample, over the latest half cycles.

Source: reference ``methods.md`` 4.10. Noise, dead time and samples a period are not checked here: the batch
detectors do that.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.stiction import hagglund_shape, he_curve_fit, rossi_scali
from agent.analysis.stiction.shapes.fitted_half_cycles import FEWEST_HALF_CYCLES
from agent.analysis.stiction.shapes.half_cycle_stream import HalfCycleStream

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

MEMORY = 10
"""Half cycles over which an index is taken."""
AT_ONCE = 50
"""Most half cycles that wait to be measured."""


def log_area_ratio(half_cycles: FloatArray) -> FloatArray:
    """Return ln of the area before the peak over that after it for each of ``half_cycles`` (m, 100), (m, 1).

    That of Singhal and Salsbury (2005); the peak counts half to each side.
    """
    m = np.arange(len(half_cycles))
    peak = np.argmax(half_cycles, axis=1)
    up_to = np.cumsum(half_cycles, axis=1)
    half_of_peak = half_cycles[m, peak] / 2
    before = up_to[m, peak] - half_of_peak
    after = up_to[:, -1] - before
    return np.asarray(np.log(before / after))[:, None]


def area_ratio(mean: FloatArray) -> float:
    """Return the ratio of the areas of the mean of ``log_area_ratio`` (1,)."""
    return float(np.exp(mean[0]))


@dataclass(frozen=True, slots=True)
class ShapeIndex:
    """How a batch detector measures half cycles."""

    name: str
    """That of the batch detector."""
    measures: Callable[[FloatArray], FloatArray]
    """Of half cycles (m, 100): (m, k)."""
    index: Callable[[FloatArray], float]
    """Of the mean of the measures (k,)."""


HE = ShapeIndex("he_curve_fit", he_curve_fit.measures, he_curve_fit.index)
OF_ERROR = (
    ShapeIndex("rossi_scali", rossi_scali.measures, rossi_scali.index),
    ShapeIndex("hagglund_shape", hagglund_shape.measures, hagglund_shape.index),
    ShapeIndex("singhal_salsbury", log_area_ratio, area_ratio),
)
"""Only self-regulating loops show these."""


class OnlineShape:
    """One signal and the indices of its half cycles."""

    def __init__(self, shapes: tuple[ShapeIndex, ...]) -> None:
        self._shapes = shapes
        self._stream = HalfCycleStream()
        self._means: list[FloatArray] = []
        self._half_cycles = 0
        self._new: list[FloatArray] = []
        """Half cycles that are not in the means yet: to measure many at once takes hardly longer than one."""

    def push(self, value: float) -> None:
        """Take the next sample, NaN for a gap."""
        half_cycle = self._stream.push(value)
        if half_cycle is None or not self._shapes:
            return
        self._new.append(half_cycle)
        if len(self._new) == AT_ONCE:
            self._measure()

    @property
    def indices(self) -> dict[str, float]:
        """By name of the batch detector; empty before there are half cycles enough."""
        self._measure()
        if self._half_cycles < FEWEST_HALF_CYCLES:
            return {}
        return {shape.name: shape.index(mean) for shape, mean in zip(self._shapes, self._means, strict=True)}

    def _measure(self) -> None:
        if not self._new:
            return
        measured = [shape.measures(np.array(self._new)) for shape in self._shapes]
        self._new.clear()
        for new in zip(*measured, strict=True):
            self._half_cycles += 1
            weight = 1 / min(self._half_cycles, MEMORY)
            before = self._means or new
            self._means = [mean + weight * (each - mean) for mean, each in zip(before, new, strict=True)]


class OnlineShapes:
    """All indices of shape of one loop. A loop of unknown kind is taken as self-regulating."""

    def __init__(self, *, integrating: bool | None = None) -> None:
        self._of_op = OnlineShape(() if integrating else (HE,))
        self._of_error = OnlineShape((HE,) if integrating else OF_ERROR)
        self._newest: float | None = None
        """Time of the newest sample that was taken from a window, s UTC."""

    def push(self, op: float, error: float) -> None:
        """Take OP (OP units) and control error (PV units) of the next sample; NaN for a gap or in manual."""
        self._of_op.push(op)
        self._of_error.push(error)

    def follow(self, window: LoopWindow) -> None:
        """Take what is new in ``window``, which may overlap the one before or leave a gap to it."""
        op = window.op if window.automatic is None else np.where(window.automatic, window.op, np.nan)
        error = (0.0 if window.sp is None else window.sp) - window.pv
        known = np.isfinite(op) & np.isfinite(error)
        new = 0
        if self._newest is not None:
            new = max(0, round((self._newest - window.start) / window.ts) + 1)
            if window.start > self._newest + 1.5 * window.ts:
                self.push(np.nan, np.nan)
        for k in range(new, len(window)):
            self.push(*((float(op[k]), float(error[k])) if known[k] else (np.nan, np.nan)))
        self._newest = max(window.start + (len(window) - 1) * window.ts, self._newest or -np.inf)

    @property
    def indices(self) -> dict[str, float]:
        """The newest of each, by name of the batch detector."""
        return self._of_op.indices | self._of_error.indices

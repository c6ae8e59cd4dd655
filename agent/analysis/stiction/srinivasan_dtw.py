"""The shape of each cycle by its nearest template: sine, square, triangle or saw-tooth.

Source: R. Srinivasan, R. Rengaswamy, R. Miller, "Control loop performance assessment. 1. A qualitative
approach for stiction diagnosis", Industrial & Engineering Chemistry Research 44 (2005) 6708; reconstructed
from its abstract (reference ``methods.md`` 3.15). Settled here: the signal, the slopes of the saw-teeth, the
band of the warping and the shares that decide.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from agent.analysis.results import MethodKind, MethodResult, MethodVerdict, Oscillation
from agent.analysis.stiction.shapes.fitted_half_cycles import shape_signal
from agent.analysis.stiction.shapes.half_cycle_shapes import T
from agent.analysis.stiction.shapes.stretch import longest_stretch
from agent.analysis.stiction.shapes.time_warping import warped_distances

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

BAND = 5
"""Points of 100 that the warping may shift: as much as a sine is off a triangle of the same height."""
STICKING, SOUND = 2 / 3, 1 / 3
"""Share of cycles that are no sine from which a valve sticks, and up to which not. Of random_plants, seeds 0
to 39, swinging loads have at most 0.15."""
FEWEST_CYCLES = 4
CYCLE = (0.5, 1.5)
"""Shortest and longest cycle that counts, periods."""


@dataclass(frozen=True, slots=True)
class LabelledCycles:
    """What the detector measured."""

    cycles: FloatArray
    """From one upward crossing of zero to the next, mean 0 and standard deviation 1, (m, 100)."""
    labels: NDArray[np.intp]
    """The nearest of ``TEMPLATES`` for each, (m,)."""
    distances: FloatArray
    """Warped distance from each template, (m, 5)."""


@dataclass(frozen=True, slots=True)
class SrinivasanDtw:
    """Looks at OP, in integrating loops at PV, cycle by cycle, so that stiction may come and go."""

    name: str = "srinivasan_dtw"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the share of cycles that are no sine, which is the index.

        A loop of unknown kind is taken as self-regulating.
        """
        stretch = longest_stretch(window)
        name, values = ("PV", stretch.error) if window.hints.integrating else ("OP", stretch.op)
        found = shape_signal(values, stretch, window, oscillation)
        if isinstance(found, str):
            return MethodResult("not_applicable", None, found)
        cycles = whole_cycles(*found)
        if len(cycles) < FEWEST_CYCLES:
            reason = f"only {len(cycles)} cycles are 0.5 to 1.5 periods long, {FEWEST_CYCLES} are needed"
            return MethodResult("not_applicable", None, reason)
        seen = labelled(cycles)
        share = float(np.mean(seen.labels != SINE))
        shapes = ", ".join(
            f"{count} {shape}"
            for shape, count in zip(
                TEMPLATES, np.bincount(seen.labels, minlength=len(TEMPLATES)), strict=True
            )
            if count
        )
        verdict: MethodVerdict = (
            "stiction" if share >= STICKING else "no_stiction" if share <= SOUND else "undecided"
        )
        return MethodResult(verdict, share, f"cycles of {name}: {shapes}", seen)


def whole_cycles(values: FloatArray, period: float) -> FloatArray:
    """Return the cycles of ``values`` (n,) at 100 points, standardised, (m, 100); ``period`` in samples."""
    upward = np.flatnonzero(np.signbit(values[:-1]) & ~np.signbit(values[1:]))
    crossings = upward + values[upward] / (values[upward] - values[upward + 1])
    shortest, longest = (part * period for part in CYCLE)
    times = [
        first + T * (last - first)
        for first, last in pairwise(crossings)
        if shortest <= last - first <= longest
    ]
    curves = np.interp(np.array(times).reshape(-1, len(T)), np.arange(len(values)), values)
    return _standardised(curves)


def labelled(cycles: FloatArray) -> LabelledCycles:
    """Find the nearest template of each of ``cycles`` (m, 100)."""
    distances = warped_distances(cycles, np.array(list(TEMPLATES.values())), BAND)
    return LabelledCycles(cycles, np.argmin(distances, axis=1), distances)


def _standardised(curves: FloatArray) -> FloatArray:
    centred = curves - curves.mean(axis=1, keepdims=True)
    return np.asarray(centred / centred.std(axis=1, keepdims=True))


def _saw(rising: float) -> FloatArray:
    """Return a cycle that rises for the part ``rising`` of it and falls for the rest, (100,)."""
    since_trough = (T + rising / 2) % 1
    return np.where(
        since_trough < rising, 2 * since_trough / rising - 1, 1 - 2 * (since_trough - rising) / (1 - rising)
    )


_SHAPES = {
    "sine": np.sin(2 * np.pi * T),
    "square": np.where(T < 0.5, 1.0, -1.0),
    "triangle": _saw(0.5),
    "slow rise": _saw(0.8),
    "slow fall": _saw(0.2),
}
TEMPLATES: dict[str, FloatArray] = dict(
    zip(_SHAPES, _standardised(np.array(list(_SHAPES.values()))), strict=True)
)
"""By name, (100,) each, from an upward crossing of zero."""
SINE = list(TEMPLATES).index("sine")

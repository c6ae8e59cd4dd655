"""The stretches by which a long recording is judged, each as long as a window of the agent.

Whatever a model lacks becomes certain in a record that is long enough: of 12 sound valves of
``simulators.draws.hidden_effects`` (24,000 samples, seeds 98000 to 98011) seven were called sticking, of
10,000 samples none; and a search that may cost so much looks at few valves in a long one.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.reversals import significant_reversals
from agent.identify.problem import bridge, dominant_period

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow

LONGEST = 3600
"""Samples of a stretch at most, unless it would have fewer periods: the longest window of the agent, an hour,
at one sample a second."""
PERIODS = 6.0
"""Swings of OP that a stretch must hold: the five that detectors need, and one that a cut may spoil."""
MOST = 12
"""Stretches that are judged: a dozen windows of one valve say what a week of them does, but for what happens
seldom (``benchmarks.simulated_weeks``: found within a week, and within six)."""


def stretches_of(window: LoopWindow) -> list[slice]:
    """Return which samples of a recording are judged, in order of time; one slice where it is short.

    Where there are more than ``MOST`` stretches, each of ``MOST`` equal parts of the recording gives that in
    which OP moves most.
    """
    cut = _equal_parts(window, LONGEST)
    if len(cut) <= MOST:
        return cut
    parts = np.array_split(np.arange(len(cut)), MOST)
    return [_liveliest(window, cut[part[0] : part[-1] + 1]) for part in parts]


def newest_stretch(window: LoopWindow) -> LoopWindow:
    """Return the last stretch of a window of the agent, nearly always all of it.

    A loop that is scanned ten times a second has 36,000 samples in an hour.
    """
    cut = _equal_parts(window, LONGEST)
    return window if len(cut) == 1 else part_of(window, cut[-1])


def liveliest_stretch(window: LoopWindow, longest: int) -> slice:
    """Return which samples of a recording show most: of stretches of ``longest`` where OP moves most.

    All of it where it is no longer, or has fewer than six swings of OP.
    """
    return _liveliest(window, _equal_parts(window, longest))


def part_of(window: LoopWindow, where: slice) -> LoopWindow:
    """Return the samples of a window in a slice as a window."""
    columns = ("op", "pv", "sp", "mv", "automatic")
    arrays = {name: getattr(window, name) for name in columns}
    kept = {name: values[where] for name, values in arrays.items() if values is not None}
    return replace(window, start=window.start + where.start * window.ts, **kept)


def _equal_parts(window: LoopWindow, longest: int) -> list[slice]:
    """Return the stretches into which a window is cut without a rest, in order of time."""
    n = len(window)
    count = math.ceil(n / max(longest, PERIODS * _period(window))) if n > longest else 1
    ends = np.linspace(0, n, count + 1).round().astype(int).tolist()
    return [slice(begin, end) for begin, end in pairwise(ends)]


def _period(window: LoopWindow) -> float:
    """Return the period in which OP swings, samples: of its highest line, or the mean between two reversals.

    The shorter one: the highest line of a loop that does not oscillate is one of the slowest.
    """
    known = int(np.count_nonzero(np.isfinite(window.op)))
    turns = significant_reversals(window.op)
    if known < 2 or turns == 0:
        return float(len(window))
    return min(dominant_period(bridge(window.op)), 2 * known / turns)


def _liveliest(window: LoopWindow, cut: list[slice]) -> slice:
    return max(cut, key=lambda each: _swing(window, each))


def _swing(window: LoopWindow, where: slice) -> float:
    """Return how much OP moves in a slice, OP units: its deviation, less where samples are missing."""
    known = window.valid[where]
    return float(np.std(window.op[where][known]) * known.mean()) if known.any() else 0.0

"""What the record says of each number: the range over all models that it cannot distinguish from the best.

The union over the basins that are left (``agent.identify.confidence_set``), widened by what the models do not
have.
"""

from __future__ import annotations

import math
from itertools import compress
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.loop.pi_controller import pi_controller
from agent.analysis.results import IntervalEstimate, ProcessIntervals, Profile, StictionEstimate
from agent.identify.objective import DELAY, J_RATIO, LOG_TAU, LOG_TAU2, SOPDT, S

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.quantify.free_run.found import Found
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.identify.fitted import Fitted
    from agent.identify.problem import Problem

LEAST_P = 0.1
"""p of a model from which it counts: intervals of 90 %."""
MARGIN_S = 0.0075
"""Added on each side of S, over the OP span: friction that the stem of the model does not have (simulated
loops, seeds 67000 to 67029)."""
MARGIN_J = 0.01
NARROW_S = 0.10
"""Width of the interval of S, over the OP span, up to which the record determines S."""
NARROW_J = 0.25
"""Likewise of J."""
EXACT = 1e-6
"""Share of the increments of OP that a PI law leaves unexplained up to which a record has every scan: of
records with a tenth of the scans or fewer it leaves 3e-6 and more."""
PROFILE_POINTS = 40


def alike(found: Found) -> list[Fitted]:
    """Return the models that the record cannot distinguish from the best, which is first."""
    return [found.best, *compress(found.others, found.p >= LEAST_P)]


def stiction_estimate(found: Found, problem: Problem, hidden: float = 0.0) -> StictionEstimate:
    """Return the bands of the best model with their intervals, OP units.

    ``hidden`` is ``hidden_movement``.
    """
    s, j = np.array([s_and_j(f) for f in alike(found)]).T
    span = problem.op_span
    s_estimate = interval(s, MARGIN_S * span + hidden / 2, above=hidden / 2)
    j_estimate = interval(j, MARGIN_J * span + hidden)
    margin = (MARGIN_S + MARGIN_J) / 2 * span + 3 / 4 * hidden
    return StictionEstimate(
        f_s=interval((s + j) / 2, margin, above=hidden / 4),
        f_d=interval((s - j) / 2, margin, above=hidden / 4),
        s=s_estimate,
        j=j_estimate,
        identifiable_s=width(s_estimate) <= NARROW_S * span,
        identifiable_j=width(j_estimate) <= NARROW_J * span,
    )


def s_and_j(fitted: Fitted) -> tuple[float, float]:
    """Return S and J of a model, OP units."""
    s = float(fitted.candidate[S])
    return s, s * float(fitted.candidate[J_RATIO])


def hidden_movement(window: LoopWindow) -> float:
    """Return by how much OP moves between two samples, where nothing is recorded, OP units.

    It is the median of the movements from one sample to the next. The turns of OP, and the noise that carries
    the stem over a threshold, lie between two samples, each cut off by up to half a movement, and a slip is
    known to half a sample: so S is up to one movement larger than it looks, and half of one smaller; J is
    up to one larger or smaller. Where the law of the controller holds from sample to sample, OP rests.
    """
    law = pi_controller(window)
    if law is not None and 1.0 - law.explained <= EXACT:
        return 0.0
    moves = np.abs(np.diff(window.op))
    moves = moves[moves > 0]  # NaN is not
    return float(np.median(moves)) if moves.size else 0.0


def interval(values: FloatArray, margin: float, above: float = 0.0) -> IntervalEstimate:
    """Return the first value with the range of all, widened by the margin, not below zero.

    ``above`` is added to the upper end.
    """
    low = max(0.0, float(values.min()) - margin)
    return IntervalEstimate(float(values[0]), low, float(values.max()) + margin + above)


def width(estimate: IntervalEstimate) -> float:
    """Return how wide an interval is."""
    return (estimate.high or 0.0) - (estimate.low or 0.0)


def process_intervals(
    found: Found, gains: list[float], reach: Mapping[str, float], ts: float
) -> ProcessIntervals:
    """Return the ranges of the process over the models alike that share the best one's structure.

    Widened by what the record leaves open behind each path of the valve.

    Args:
        found: The models.
        gains: Of ``same_structure(found)``, in its order.
        reach: Of the best one, ``process_reach``.
        ts: s.
    """
    candidates = np.array([f.candidate for f in same_structure(found)])
    integrates = found.best.structure not in (0, SOPDT)
    taus = np.exp(candidates[:, LOG_TAU]) * ts
    seconds = np.minimum(np.exp(candidates[:, LOG_TAU2]) * ts, taus)
    earliest, latest = _moved(candidates[:, DELAY] * ts, reach["delay"] * ts)
    return ProcessIntervals(
        gain=_moved(np.array(gains), np.abs(gains) * reach["gain"]),
        tau=None if integrates else _times(taus, reach["tau"]),
        delay=(max(earliest, ts), latest),
        tau2=_times(seconds, reach["tau2"]) if found.best.structure == SOPDT else None,
    )


def _moved(values: FloatArray, reach: FloatArray | float) -> tuple[float, float]:
    """Return the least and the largest, each ``reach`` farther."""
    return float(np.min(values - reach)), float(np.max(values + reach))


def _times(values: FloatArray, reach: float) -> tuple[float, float]:
    """Return the least and the largest, their logarithms ``reach`` farther."""
    return float(values.min()) * math.exp(-reach), float(values.max()) * math.exp(reach)


def same_structure(found: Found) -> list[Fitted]:
    """Return the models alike whose process has the best one's structure, the best first."""
    return [f for f in alike(found) if f.structure == found.best.structure]


def profile(found: Found, problem: Problem, ts: float) -> Profile:
    """Return the best model in each of some ranges of S."""
    step = problem.op_span / PROFILE_POINTS
    best: dict[int, tuple[float, Fitted]] = {}
    for p, fitted in zip(found.p, found.others, strict=True):
        place = math.floor(fitted.candidate[S] / step)
        if place not in best or p > best[place][0]:
            best[place] = (float(p), fitted)
    points = [best[place] for place in sorted(best)]
    fits = [fitted for _, fitted in points]
    return Profile(
        s=np.array([f.candidate[S] for f in fits]),
        p=np.array([p for p, _ in points]),
        delay=np.array([f.candidate[DELAY] * ts for f in fits]),
        j=np.array([s_and_j(f)[1] for f in fits]),
        limit=LEAST_P,
    )

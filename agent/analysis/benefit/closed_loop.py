"""A fitted loop run again: its controller, its valve with other friction, its process, its disturbance."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.record.reversals import significant_reversals

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.analysis.results import ProcessEstimate
    from agent.units import FrictionBands

HOUR = 3600.0
"""s"""
LARGEST = 1e6
"""OP or PV, over the span of the disturbance, beyond which a run counts as unstable."""


class Tuning(NamedTuple):
    """PI controller: dOP = kc (e(t) - e(t-1)) + ki e(t)."""

    kc: float
    """OP units per PV unit; below zero in a direct acting controller."""
    ki: float
    """The same a sample."""


@dataclass(frozen=True, slots=True)
class LoopRun:
    """What a loop did."""

    pv_variance: float
    """Of SP - PV, PV units squared."""
    travel: float
    """Way of OP an hour, OP units."""
    reversals: float
    """Reversals of OP an hour."""


class FittedLoop(NamedTuple):
    """All that a run needs."""

    process: ProcessEstimate
    disturbance: FloatArray
    """What of PV does not come from OP, PV units, (n,), finite."""
    set_point: FloatArray
    """SP, deviation from its mean, PV units, (n,)."""
    op: float
    """Where OP begins, OP units."""
    op_range: tuple[float, float]
    ts: float
    """s"""


def run(loop: FittedLoop, valve: FrictionBands, tuning: Tuning) -> LoopRun | None:
    """Run the loop over its own disturbance; None where it becomes unstable.

    The valve is that of He (2007): it rests until the force exceeds f_s, then it slips until f_d remains.
    """
    ts, process = loop.ts, loop.process
    delay = max(1, round(process.delay / ts))
    taus = [each for each in (process.tau, process.tau2) if each]
    keeps = [math.exp(-ts / each) for each in taus]
    levels = [0.0] * len(keeps)
    gain = process.gain if taus else process.gain * ts
    n = len(loop.disturbance)
    op, errors = np.empty(n), np.empty(n)
    flows = [0.0] * (n + delay)
    low, high = loop.op_range
    stem = u = loop.op
    volume = before = 0.0
    bound = LARGEST * (float(np.ptp(loop.disturbance)) + float(np.ptp(loop.set_point)) + 1e-12)
    for t, (rest, wanted) in enumerate(zip(loop.disturbance.tolist(), loop.set_point.tolist(), strict=True)):
        driven = flows[t]
        if keeps:
            for k, keep in enumerate(keeps):
                levels[k] = driven + (levels[k] - driven) * keep
                driven = levels[k]
        else:
            volume += driven
            driven = volume
        error = wanted - gain * driven - rest
        if not abs(error) < bound:
            return None
        u = min(max(u + tuning.kc * (error - before) + tuning.ki * error, low), high)
        before = error
        force = u - stem
        if abs(force) > valve.f_s:
            stem = u - math.copysign(valve.f_d, force)
        flows[t + delay] = stem - loop.op
        op[t], errors[t] = u, error
    late = slice(n // 5, None)  # the begin from balance passes
    hours = len(op[late]) * ts / HOUR
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        variance, way = float(np.var(errors[late])), float(np.abs(np.diff(op[late])).sum())
    if not (math.isfinite(variance) and math.isfinite(way)):
        return None
    return LoopRun(variance, way / hours, significant_reversals(op[late]) / hours)

"""What would a repair gain, and what a smaller gain of the controller? From the fitted loop, never written.

The loop is run three times over its own disturbance (measured PV less PV of the model): with the valve as it
is, with S = 0, and with the valve as it is and a controller by SIMC. Each run is repeated with the ends of
the intervals of S and of the process gain; the interval of a change holds all of them.

Source: S. Skogestad, "Simple analytic rules for model reduction and PID controller tuning", Journal of
Process Control 13 (2003) 291.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.benefit.closed_loop import HOUR, FittedLoop, LoopRun, Tuning, run
from agent.analysis.loop.pi_controller import pi_controller
from agent.analysis.record.least_step import op_range_of
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.results import IntervalEstimate, ProcessEstimate, Quantification

LAWFUL = 0.8
"""Share of the increments of OP that the PI law must give: another controller cannot be run again."""
REPEATS = 2.0
"""Factor within which the loop, run as it is, must repeat the measured variance and travel of OP. Where its
limit cycle does not arise, or is another one, its changes are not those of the plant."""
NONE = FrictionBands(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class ChangeRatio:
    """A number of the changed loop over that of the loop as it is, with the interval of all runs."""

    ratio: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Changed:
    """What one measure would do; each over the loop as it is, so 0.5 is half."""

    pv_variance: ChangeRatio
    travel: ChangeRatio
    reversals: ChangeRatio


@dataclass(frozen=True, slots=True)
class Benefit:
    """Both measures."""

    as_is: LoopRun
    """The loop as it is, simulated: to be compared with what was measured."""
    repaired: Changed | None
    """With S = 0; None where a run becomes unstable."""
    retuned: Changed | None
    """With the valve as it is and a controller by SIMC; None likewise."""
    tuning: Tuning
    """By SIMC."""


def benefit(window: LoopWindow, found: Quantification) -> Benefit | None:
    """Return what both measures would do.

    None where valve, process or controller are not known, or the loop as it is does not repeat the record.

    Args:
        window: The record.
        found: Of its valve, with stiction, process and the PV of the model.
    """
    law, process, stiction = pi_controller(window), found.process, found.stiction
    if law is None or law.explained < LAWFUL or law.kc * law.ki <= 0 or process is None or stiction is None:
        return None
    disturbance = None if found.model_pv is None else _bridged(window.pv - found.model_pv)
    if disturbance is None:
        return None
    now, other = Tuning(law.kc, law.ki), simc(process, window.ts)
    loops = [_loop(window, each, disturbance) for each in _processes(process)]
    valves = [_scaled(stiction.bands, s) for s in _ends(stiction.s)]
    cases = [(loop, valve) for loop in loops for valve in valves]
    first = run(*cases[0], now)
    if first is None or not _repeats(first, window):
        return None
    return Benefit(
        first,
        _changed([(run(loop, valve, now), run(loop, NONE, now)) for loop, valve in cases]),
        _changed([(run(loop, valve, now), run(loop, valve, other)) for loop, valve in cases]),
        other,
    )


def _repeats(as_is: LoopRun, window: LoopWindow) -> bool:
    """Whether a run of the loop as it is repeats the variance of the error and the travel of OP."""
    error = window.pv if window.sp is None else window.sp - window.pv
    op = window.op[np.isfinite(window.op)]
    hours = len(op) * window.ts / HOUR
    measured = float(np.nanvar(error)), float(np.abs(np.diff(op)).sum()) / hours
    own = as_is.pv_variance, as_is.travel
    return all(a <= REPEATS * b and b <= REPEATS * a for a, b in zip(own, measured, strict=True))


def simc(process: ProcessEstimate, ts: float) -> Tuning:
    """Return the PI controller by SIMC, closed loop as slow as the dead time (tau_c = delay)."""
    delay = process.delay + (process.tau2 or 0.0) / 2
    wanted = max(delay, ts)
    if process.tau is None:
        kc, ti = 1 / (process.gain * (wanted + delay)), 4 * (wanted + delay)
    else:
        tau = process.tau + (process.tau2 or 0.0) / 2
        kc, ti = tau / (process.gain * (wanted + delay)), min(tau, 4 * (wanted + delay))
    return Tuning(kc, kc * ts / ti)


def _changed(pairs: list[tuple[LoopRun | None, LoopRun | None]]) -> Changed | None:
    """Return the changes of all runs, the first pair being the likeliest; None where one is unstable."""
    known = [(a, b) for a, b in pairs if a is not None and b is not None]
    if len(known) < len(pairs):
        return None

    def change(name: str) -> ChangeRatio:
        ratios = [getattr(b, name) / max(getattr(a, name), 1e-300) for a, b in known]
        return ChangeRatio(ratios[0], min(ratios), max(ratios))

    return Changed(change("pv_variance"), change("travel"), change("reversals"))


def _loop(window: LoopWindow, process: ProcessEstimate, disturbance: FloatArray) -> FittedLoop:
    op = window.op[np.isfinite(window.op)]
    sp = np.zeros(len(window)) if window.sp is None else _bridged(window.sp)
    set_point = np.zeros(len(window)) if sp is None else sp - sp.mean()
    low, high = op_range_of(window)
    limits = (low, high) if high > low else (-np.inf, np.inf)
    return FittedLoop(process, disturbance, set_point, float(np.median(op)), limits, window.ts)


def _processes(process: ProcessEstimate) -> Iterator[ProcessEstimate]:
    yield process
    if process.intervals is not None:
        for gain in process.intervals.gain:
            if gain * process.gain > 0:
                yield replace(process, gain=gain)


def _ends(s: IntervalEstimate) -> Iterator[float]:
    yield s.value
    if s.low is not None and s.high is not None:
        yield from (s.low, s.high)


def _scaled(bands: FrictionBands, s: float) -> FrictionBands:
    factor = s / bands.s if bands.s > 0 else 0.0
    return FrictionBands(factor * bands.f_s, factor * bands.f_d)


def _bridged(values: FloatArray) -> FloatArray | None:
    """Return a signal (n,) less its mean, its gaps bridged by lines; None where it is lost."""
    known = np.flatnonzero(np.isfinite(values))
    if len(known) < 2:
        return None
    bridged = np.interp(np.arange(len(values)), known, values[known])
    return np.asarray(bridged - bridged.mean())

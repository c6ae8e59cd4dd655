"""The dead band of a valve from the integral of a PI controller, which has to cross it in each half cycle.

Source: T. Hägglund, "Automatic on-line estimation of backlash in control loops", Journal of Process Control
17 (2007) 489; reference ``methods.md`` 3.13 (companion). The paper estimates, and takes for granted that the
oscillation comes from the valve; the check that the error is a square is added.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.loop.pi_controller import PiController, pi_controller
from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.fitted_half_cycles import FEWEST_HALF_CYCLES, shape_signal
from agent.analysis.stiction.shapes.stretch import half_cycles, longest_stretch

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

LEAST_EXPLAINED = 0.8
"""Share of the increments of OP that a PI law must explain before its gains are believed."""
FEWEST_INTEGRAL_TIMES = 5.0
"""Half cycle over Ti; in shorter ones PV has not settled (Hägglund 2007)."""
HIGHEST_PEAK = 2.0
"""Peak over mean of the error in a half cycle; with higher ones something else moves PV (Hägglund 2007)."""
SQUARE_UP_TO = 1.5
"""Peak over mean up to which the error is a square. A sine has 1.57; of random_plants, seeds 0 to 39, with
half cycles long enough sticking valves have 1.15 to 1.48, swinging loads 1.57 and more."""


@dataclass(frozen=True, slots=True)
class Backlash:
    """What the detector measured."""

    error: FloatArray
    """Control error without trend, smoothed, PV units, (n,)."""
    half_cycles: tuple[slice, ...]
    """Those of ``error`` that count."""
    half_cycle: float
    """Mean duration (Delta t), s."""
    height: float
    """Mean of the absolute error (Delta y), PV units."""
    peak: float
    """Mean of its largest value in each half cycle, PV units."""
    integral_time: float
    """Ti of the controller, s."""
    dead_band: float
    """OP units; at most that, because the gain of the process is left out."""


@dataclass(frozen=True, slots=True)
class HagglundBacklash:
    """For self-regulating loops under PI control whose half cycles are long against the integral time.

    It estimates the dead band and never calls a valve sound: where its conditions do not hold it gives no
    verdict.
    """

    name: str = "hagglund_backlash"
    kind: MethodKind = "limit_cycle"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Estimate the dead band; the index is its part of the span of OP."""
        if window.hints.integrating:
            return MethodResult("not_applicable", None, "PV of an integrating loop never settles")
        controller = pi_controller(window)
        if controller is None or controller.explained < LEAST_EXPLAINED or controller.kc * controller.ki <= 0:
            return MethodResult("not_applicable", None, "a PI law does not explain OP")
        seen = backlash(window, oscillation, controller)
        if isinstance(seen, str):
            return MethodResult("not_applicable", None, seen)
        share = seen.dead_band / window.op_span
        most = f"at most {seen.dead_band:.3g} (OP units)"
        if seen.peak > SQUARE_UP_TO * seen.height:
            reason = f"the error is not a square wave; if the valve causes it, the dead band is {most}"
            return MethodResult("undecided", share, reason, seen)
        reason = f"the integral crosses a dead band of {most} in each half cycle"
        return MethodResult("stiction", share, reason, seen)


def _broken_condition(seen: Backlash) -> str | None:
    """Return as a text the published condition that does not hold."""
    times = seen.half_cycle / seen.integral_time
    if times < FEWEST_INTEGRAL_TIMES:
        return f"a half cycle lasts {times:.1f} integral times, {FEWEST_INTEGRAL_TIMES:.0f} are needed"
    if seen.peak > HIGHEST_PEAK * seen.height:
        return "the error has peaks, so a disturbance moves PV as well as the valve"
    return None


def backlash(window: LoopWindow, oscillation: Oscillation, controller: PiController) -> Backlash | str:
    """Measure the half cycles of the error; if a condition does not hold, return it as a text."""
    stretch = longest_stretch(window)
    found = shape_signal(stretch.error, stretch, window, oscillation)
    if isinstance(found, str):
        return found
    signal, period = found
    error = signal * np.max(np.abs(stretch.error))
    cycles = half_cycles(error, period)
    if len(cycles) < FEWEST_HALF_CYCLES:
        return f"only {len(cycles)} half cycles are 0.25 to 1 period long, {FEWEST_HALF_CYCLES} are needed"
    heights = [float(np.mean(np.abs(error[cycle]))) for cycle in cycles]
    samples = float(np.mean([cycle.stop - cycle.start for cycle in cycles]))
    height = float(np.mean(heights))
    seen = Backlash(
        error=error,
        half_cycles=tuple(cycles),
        half_cycle=samples * window.ts,
        height=height,
        peak=float(np.mean([np.max(np.abs(error[cycle])) for cycle in cycles])),
        integral_time=controller.kc / controller.ki * window.ts,
        dead_band=dead_band(samples, height, controller),
    )
    return _broken_condition(seen) or seen


def dead_band(samples: float, height: float, controller: PiController, gain: float = np.inf) -> float:
    """Return (K dt / Ti - 1/Kp) dy of Hägglund (2007), OP units.

    Args:
        samples: Duration of the half cycle dt, samples.
        height: Mean absolute error in it dy, PV units.
        controller: Its ``ki`` is K Ts / Ti.
        gain: Static gain of the process Kp, PV units per OP unit. A record alone does not show it; without it
            the result is an upper bound.
    """
    return (abs(controller.ki) * samples - 1 / abs(gain)) * height

"""Does a wave keep the time of OP's own cycle?

In the time of OP's cycle the loop may make a wave itself. A valve or a mass that sticks makes a wave at OP's
cycle and at its harmonics, and so does a load that drives the loop: OP then takes the load's time. Two things
distinguish a load from the loop: it keeps its own time where OP's cycle does not (the phase), or it is a pure
wave, while friction makes odd harmonics (the shape).
Source: reference ``missing_effect.md`` section 3, external sinusoid.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.sinusoid import Sinusoid
from agent.workbench.residual.line_spectrum import line_spectrum

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.predictor import Predictor
    from agent.workbench.residual.line_spectrum import Line

WORDS = "it keeps the time of OP's own cycle, as a wave that the loop makes itself would"
NEAR = 2.0
"""Lines of the record's spectrum within which a wave and a line are one."""
HARMONICS = (3, 5)
PURE = 1 / 30
"""Amplitude of any harmonic over the wave's, below which it is pure. A band behind one lag leaves 1/9 at the
third, behind two 1/27."""


def may_be_loops_own(smaller: tuple[Predictor, FloatArray] | None, larger: Fit) -> bool:
    """Return whether the last effect of a fit is a wave that the loop may make itself.

    Args:
        smaller: Predictions of the model without the effect, and where they are best; None: not known.
        larger: The model with it.
    """
    if smaller is None or not isinstance(larger.model.effects[-1], Sinusoid):
        return False
    predicts, best = smaller
    record = predicts.objective.record
    return keeps_time_of_loop(predicts.left(best), record.op, float(larger.values[-1]), record.facts.ts)


def keeps_time_of_loop(residual: FloatArray, op: FloatArray, frequency: float, ts: float) -> bool:
    """Return whether a wave in a residual is in step with OP's cycle and has not the shape of a load.

    Args:
        residual: Of the model without the wave, PV units, (n,), NaN where there is none.
        op: Without gaps, OP units, (n,).
        frequency: Of the wave, 1/s.
        ts: s.
    """
    found = line_spectrum(residual, op, ts)
    at = [] if found is None else near(found.lines, frequency, len(op) * ts)
    if not at or at[0].harmonic is None or at[0].kind == "coherent":
        return False
    return at[0].harmonic > 1 or not _is_pure(residual, at[0].frequency * ts)


def near(lines: tuple[Line, ...], frequency: float, duration: float) -> list[Line]:
    """Return the lines that are one with a wave of ``frequency``, 1/s, in a record of ``duration``, s."""
    return [each for each in lines if abs(each.frequency - frequency) * duration < NEAR]


def _is_pure(residual: FloatArray, frequency: float) -> bool:
    """Return whether a wave of ``frequency``, cycles a sample, has no harmonics that the record shows."""
    known = np.flatnonzero(np.isfinite(residual))
    weighted = (residual[known] - residual[known].mean()) * np.hanning(len(known))

    def amplitude(multiple: int) -> float:
        return float(np.abs(weighted @ np.exp(-2j * np.pi * multiple * frequency * known)))

    return max(amplitude(each) for each in HARMONICS) < PURE * amplitude(1)

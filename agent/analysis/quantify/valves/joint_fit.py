"""A valve and the process behind it, fitted to one record: what the searches over valves share.

Means are removed and nothing is filtered; the process comes from least squares, the error from simulation
(see ``output_error``); the valve starts without stored force.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.loop.delay import estimate_delay
from agent.analysis.quantify.processes.output_error import (
    FEWEST_ROWS,
    FIRST_ORDER,
    INTEGRATOR,
    SECOND_ORDER,
    fit_process,
    output_errors,
)
from agent.analysis.quantify.processes.process_estimate import process_estimate
from agent.analysis.quantify.valves.turns import turns
from agent.analysis.quantify.valves.valve_law import HE, stem_position, valve_position
from agent.analysis.results import MethodVerdict, Quantification, StictionEstimate
from agent.physics.processes.arx import Arx, simulate_arx
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopWindow

SHORT_DELAYS = 20
"""Delays always searched, samples."""
AROUND_ESTIMATE = 5
"""Delays searched on each side of the estimated one, samples."""

NO_STICTION = np.zeros(2)


@dataclass(frozen=True, slots=True)
class Model:
    """One valve with the best process behind it."""

    bands: FrictionBands
    structure: int
    process: Arx
    mv: FloatArray
    """Valve position, OP units, (n,)."""
    pv: FloatArray
    """Simulated output about the mean of PV, PV units, (n,)."""
    error: float
    """Mean squared error of that, PV units squared."""


@dataclass(frozen=True, slots=True)
class CentredRecord:
    """OP and PV as the objective uses them, PV about its mean."""

    op: FloatArray
    """OP units, (n,)."""
    pv: FloatArray
    """About its mean, PV units, (n,)."""
    pv_mean: float
    gain_sign: int
    """1 or -1 where the engineer gave the controller's action, else 0."""
    law: int
    """Of the valve, see ``valve_law``."""

    @classmethod
    def of(cls, window: LoopWindow, law: int = HE) -> CentredRecord:
        """Return the record of a window for which ``lack`` returns None."""
        op = np.where(np.isfinite(window.op), window.op, np.nan)
        pv = np.where(np.isfinite(window.pv), window.pv, np.nan)
        mean = float(np.nanmean(pv))
        sign = {"reverse": 1, "direct": -1, None: 0}[window.hints.acting]
        return cls(op, pv - mean, mean, sign, law)

    @property
    def variance(self) -> float:
        """Of PV, PV units squared: the error of a model that explains nothing."""
        return float(np.nanmean(self.pv**2))

    def percent(self, error: float) -> float:
        """Fit of a model with this mean squared error."""
        return float(100 * (1 - np.sqrt(error / self.variance)))

    def errors(self, bands: FloatArray, delays: NDArray[np.int64], structures: tuple[int, ...]) -> FloatArray:
        """Mean squared errors, shape (bands, structures, delays)."""
        return np.stack(
            [
                output_errors(self.op, self.pv, bands, delays, each, self.gain_sign, self.law)
                for each in structures
            ],
            axis=1,
        )

    def best_model(
        self, bands: FloatArray, delays: NDArray[np.int64], structures: tuple[int, ...]
    ) -> Model | None:
        """Return the best process behind a valve with ``bands`` (2,), or None where none is plausible."""
        errors = self.errors(bands[None, :], delays, structures)[0]
        row, column = np.unravel_index(np.argmin(errors), errors.shape)
        error, structure = float(errors[row, column]), structures[row]
        if not np.isfinite(error):
            return None
        f_s, f_d = float(bands[0]), float(bands[1])
        mv = valve_position(self.op, f_s, f_d, self.law)
        process = fit_process(mv, self.pv, int(delays[column]), structure)
        return Model(
            bands=FrictionBands(f_s, f_d),
            structure=structure,
            process=process,
            mv=stem_position(self.op, f_s, f_d, self.op[np.isfinite(self.op)][0], self.law),
            pv=simulate_arx(process, mv, self.pv),
            error=error,
        )


def answer(
    name: str,
    window: LoopWindow,
    record: CentredRecord,
    best: Model | None,
    linear: Model | None,
    threshold: float,
) -> Quantification:
    """Return the verdict on the best valve against the best model without stiction.

    Args:
        name: Of the quantifier.
        window: The record as it came.
        record: The same as it was fitted.
        best: The best model over all valves; None where no process is plausible.
        linear: The best model without stiction; where there is none its rival is the mean of PV.
        threshold: Evidence above which the valve is said to stick.
    """
    if best is None:
        return failed(name, "no process with a real lag and a steady gain follows PV from OP")
    linear_error = min(record.variance, np.inf if linear is None else linear.error)
    evidence = max(1.0, linear_error / max(best.error, 1e-12 * record.variance))
    return Quantification(
        quantifier=name,
        stiction=StictionEstimate.of(best.bands) if best.bands.f_s > 0 else None,
        process=process_estimate(best.process, best.structure, window.ts),
        free_run_percent=record.percent(best.error),
        linear_percent=record.percent(linear_error),
        evidence=evidence,
        decision=_decision(best, evidence, threshold),
        model_pv=best.pv + record.pv_mean,
        model_mv=best.mv,
    )


def _decision(best: Model, evidence: float, threshold: float) -> MethodVerdict:
    if best.bands.f_s == 0 or evidence <= threshold:
        return "no_stiction"
    return "stiction" if turns(best.mv) > 0 else "undecided"


def structures_to_try(window: LoopWindow) -> tuple[int, ...]:
    """Return the processes to try, the simplest first; it stays where the next is no better."""
    if window.hints.integrating:
        return (INTEGRATOR,)
    if window.hints.order is not None:
        return (FIRST_ORDER if window.hints.order == 1 else SECOND_ORDER,)
    return (FIRST_ORDER, SECOND_ORDER)


def free_delays(window: LoopWindow, structures: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the delays to search: the short ones, and about the paper's estimate from OP to PV.

    In a sticking loop that estimate is often far off, so it only adds to them.
    """
    longest = max(1, len(window) // 10)
    delays = set(range(1, SHORT_DELAYS + 1))
    for order in {max(FIRST_ORDER, structure) for structure in structures}:
        estimate = estimate_delay(window.op, window.pv, order=order, longest=longest)
        if estimate is not None:
            delays |= set(range(estimate - AROUND_ESTIMATE, estimate + AROUND_ESTIMATE + 1))
    return np.array(sorted(delay for delay in delays if 1 <= delay <= longest), dtype=np.int64)


def lack(window: LoopWindow) -> str | None:
    """Return as a text what a window lacks for a fit; None where it lacks nothing."""
    known = int(np.count_nonzero(window.valid))
    if known < 2 * FEWEST_ROWS:
        return f"only {known} samples have both OP and PV, at least {2 * FEWEST_ROWS} are needed"
    if window.op_span == 0:
        return "OP does not move"
    if np.ptp(window.pv[np.isfinite(window.pv)]) == 0:
        return "PV does not move"
    return None


def failed(name: str, why: str) -> Quantification:
    """Return a quantification that failed, and why."""
    return Quantification(
        quantifier=name,
        stiction=None,
        process=None,
        free_run_percent=None,
        linear_percent=None,
        evidence=None,
        decision="not_applicable",
        failure=why,
    )

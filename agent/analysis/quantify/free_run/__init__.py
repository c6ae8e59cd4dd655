"""Our quantifier: simulate valve and process from OP, free run, and search everything jointly.

It differs from the paper's method (``lee2008``) in what is searched: the force on the stem at the start of
the record, a fractional delay and the time constants together with S and J, on the error of the simulated PV,
with gain, level, drift and start-up in closed form. Design facts 1, 2, 4; ``methods.md`` 0.3 to 0.6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    J_RATIO,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    S,
    fit_gain,
    process_response,
    valve_position,
)
from agent.analysis.quantify.free_run.problem import Problem, pose
from agent.analysis.quantify.free_run.search import Fitted, best_linear, best_stiction
from agent.analysis.quantify.turns import turns
from agent.analysis.results import MethodVerdict, ProcessEstimate, Quantification, StictionEstimate
from agent.units import FrictionBands

if TYPE_CHECKING:
    from agent.analysis.recording import FloatArray, LoopWindow

STICKS_ABOVE = 1.5
"""Evidence (linear over sticking error) above which the valve is said to stick."""
SLIDES_BELOW = 1.25
"""Evidence below which it is said not to; between the two it is undecided.

Both are read off simulated loops, not off recordings: see docs/methods/free_run.md.
"""
LEAST_S = 0.01
"""S below this share of the OP span is no stiction that a record can show."""
LEAST_FIT = 50.0
"""Fit percent below which a model explains too little of PV to accuse a valve; sixty simulated sticking loops
with up to 30 % noise gave at least 55."""

KIND = {FOPDT: "fopdt", SOPDT: "sopdt", INTEGRATOR: "integrator"}


@dataclass(frozen=True, slots=True)
class FreeRun:
    """Joint free-run fit of valve and process."""

    name: str = "free_run"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Return the better of the sticking and the linear model; failure is a field, never an exception."""
        problem = pose(window)
        if isinstance(problem, str):
            return unanswered(self.name, problem)
        sticking = best_stiction(problem, window.hints)
        linear = best_linear(problem, window.hints, sticking)
        if not math.isfinite(linear.error):
            return unanswered(self.name, "no process within bounds follows OP")
        evidence = 1.0 if sticking is None else max(1.0, linear.error / max(sticking.error, 1e-300))
        best = sticking if sticking is not None and evidence > 1.0 else linear
        decision = decide(evidence, sticking, window, problem)
        chosen = best if decision == "stiction" else linear
        model_pv, model_mv = simulate(chosen, problem)
        return Quantification(
            quantifier=self.name,
            stiction=bands(best) if best.sticks else None,
            process=process(chosen, problem, window.ts),
            free_run_percent=fit_percent(best, window, problem),
            linear_percent=fit_percent(linear, window, problem),
            evidence=evidence,
            decision=decision,
            model_pv=model_pv + slow_part(window, problem, model_pv),
            model_mv=model_mv,
        )


def unanswered(name: str, failure: str) -> Quantification:
    """Return the answer of a fit that could not be made."""
    return Quantification(name, None, None, None, None, None, "not_applicable", failure=failure)


def decide(evidence: float, sticking: Fitted | None, window: LoopWindow, problem: Problem) -> MethodVerdict:
    """Return the verdict that the errors support, the valve's turns allow and the fit deserves."""
    if sticking is None or evidence < SLIDES_BELOW:
        return "no_stiction"
    if sticking.candidate[S] < LEAST_S * problem.op_span:
        return "no_stiction"
    sees_it = turns(valve_position(sticking.candidate, problem)) > 0
    explains = fit_percent(sticking, window, problem) >= LEAST_FIT
    return "stiction" if evidence >= STICKS_ABOVE and sees_it and explains else "undecided"


def bands(fitted: Fitted) -> StictionEstimate:
    """Return the friction bands of a candidate, OP units."""
    s = float(fitted.candidate[S])
    return StictionEstimate.of(FrictionBands.from_s_j(s, s * float(fitted.candidate[J_RATIO])))


def position_of(fitted: Fitted, problem: Problem) -> FloatArray:
    """Return the simulated valve position, OP units, (n,)."""
    return valve_position(fitted.candidate, problem)


def process(fitted: Fitted, problem: Problem, ts: float) -> ProcessEstimate:
    """Return the process in engineering units."""
    response = process_response(position_of(fitted, problem), fitted.candidate, fitted.structure)
    _, gain, _ = fit_gain(response, fitted.candidate, fitted.structure, problem)
    tau = math.exp(fitted.candidate[LOG_TAU]) * ts
    integrates = fitted.structure == INTEGRATOR
    tau2 = min(math.exp(fitted.candidate[LOG_TAU2]) * ts, tau) if fitted.structure == SOPDT else None
    return ProcessEstimate(
        kind=KIND[fitted.structure],
        gain=gain / ts if integrates else gain,
        tau=None if integrates else tau,
        delay=float(fitted.candidate[DELAY]) * ts,
        tau2=tau2,
    )


def simulate(fitted: Fitted, problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Return PV without level and drift (PV units) and the valve position (OP units), each (n,)."""
    position = position_of(fitted, problem)
    response = process_response(position, fitted.candidate, fitted.structure)
    _, gain, startup = fit_gain(response, fitted.candidate, fitted.structure, problem)
    free_run = gain * response
    if startup:
        lag = math.exp(fitted.candidate[LOG_TAU])
        elapsed = np.maximum(0.0, np.arange(len(position)) + 1 - fitted.candidate[DELAY])
        free_run += startup * np.exp(-np.floor(elapsed) / lag)
    return free_run, position


def slow_part(window: LoopWindow, problem: Problem, free_run: FloatArray) -> FloatArray:
    """Return the level and drift that lie between the free run and PV, PV units, (n,)."""
    rest = np.where(problem.weight > 0, window.pv - free_run, 0.0)
    return np.asarray(problem.basis @ (problem.basis.T @ rest))


def fit_percent(fitted: Fitted, window: LoopWindow, problem: Problem) -> float:
    """Return 100 (1 - ||PV - model|| / ||PV - mean PV||) over the samples that count."""
    known = window.pv[problem.weight > 0]
    spread = float(np.sum((known - known.mean()) ** 2))
    return 100.0 * (1.0 - math.sqrt(max(fitted.error, 0.0) / spread))

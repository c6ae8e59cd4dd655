"""Our quantifier: simulate valve and process from OP, free run, and search everything jointly.

It differs from the paper's method (``lee2008``) in what is searched: where the valve stands at the start of
the record, a fractional delay and the time constants together with S and J, on the error of the simulated PV,
with gain, level, slope and start-up in closed form. The search is ``agent.identify.search``.
Design facts 1, 2, 4; ``methods.md`` 0.3 to 0.6.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.quantify.free_run.found import SLIDES_BELOW, Found, find
from agent.analysis.quantify.free_run.intervals import (
    LEAST_P,
    hidden_movement,
    process_intervals,
    profile,
    s_and_j,
    same_structure,
    stiction_estimate,
)
from agent.analysis.quantify.free_run.problem import pose, structures
from agent.analysis.quantify.free_run.process_reach import process_reach
from agent.analysis.quantify.free_run.quick_evidence import quick_evidence
from agent.analysis.quantify.valves.turns import turns
from agent.analysis.results import (
    LeastErrorValve,
    MethodVerdict,
    ProcessEstimate,
    ProcessIntervals,
    Quantification,
    SimulatedModel,
)
from agent.identify.fitted import Fitted
from agent.identify.free_run_error import response_to
from agent.identify.objective import (
    DELAY,
    FOPDT,
    INTEGRATOR,
    LOG_TAU,
    LOG_TAU2,
    SOPDT,
    S,
    fit_gain,
    process_response,
    valve_position,
)
from agent.identify.problem import Problem, bridge, high_pass, nuisance_of
from agent.identify.search.linear import best_linear

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

STICKS_ABOVE = 1.75
"""Evidence (linear over sticking error) above which the valve is said to stick.

This and ``SLIDES_BELOW`` are read off simulated loops (seeds 2000 to 2079): see docs/methods/free_run.md.
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
        found = find(window, problem)
        linear = best_linear(problem, structures(window.hints), found.best if found else None)
        if linear is None:
            return unanswered(self.name, "no process within bounds follows OP")
        return answer(self.name, found, linear, problem, window)


def answer(
    name: str, found: Found | None, linear: Fitted, problem: Problem, window: LoopWindow
) -> Quantification:
    """Return what a search found as the answer of a quantifier.

    Args:
        name: Of the quantifier.
        found: Models of a sticking valve; None where no candidate moves it.
        linear: The best model whose valve follows OP.
        problem: What the window poses.
        window: The record.
    """
    evidence = evidence_of(found, linear)
    spent = found is not None and found.ended == "spent"
    decision = decide(evidence, found, problem, spent=spent)
    if evidence == 1.0:
        found = None
    best = found.best if found else linear
    least_error = least_error_valve(found.least_error, problem) if found else None
    chosen = linear if decision == "no_stiction" else best
    of_process = process_intervals_of(found, window.ts) if found and chosen is best else None
    model_pv, model_mv = simulate(chosen, problem, window)
    other = None
    if found and chosen is not best:
        of_best = process(best, found.view, window.ts, process_intervals_of(found, window.ts))
        other = SimulatedModel(of_best, *simulate(best, problem, window))
    return Quantification(
        quantifier=name,
        stiction=stiction_estimate(found, problem, hidden_movement(window)) if found else None,
        process=process(chosen, found.view if found and chosen is best else problem, window.ts, of_process),
        free_run_percent=fit_percent(best, problem),
        linear_percent=fit_percent(linear, problem),
        evidence=evidence,
        decision=decision,
        model_pv=model_pv,
        model_mv=model_mv,
        profile=profile(found, problem, window.ts) if found else None,
        quick_evidence=quick_evidence(window, found.least_error) if found else 1.0,
        turns=turns(least_error.mv) if least_error else 0,
        search_spent=spent,
        sticking=other,
        least_error=least_error,
    )


def evidence_of(found: Found | None, linear: Fitted) -> float:
    """Return the linear over the sticking error, at least 1."""
    return max(1.0, linear.error / max(found.least_error.error, 1e-300)) if found else 1.0


def least_error_valve(fitted: Fitted, problem: Problem) -> LeastErrorValve:
    """Return the valve of a model with its stem."""
    return LeastErrorValve(*s_and_j(fitted), valve_position(fitted.candidate, problem))


def unanswered(name: str, failure: str) -> Quantification:
    """Return the answer of a fit that could not be made."""
    return Quantification(name, None, None, None, None, None, "not_applicable", failure=failure)


def decide(evidence: float, found: Found | None, problem: Problem, *, spent: bool) -> MethodVerdict:
    """Return the verdict that the errors support, the valve's turns allow and the fit deserves.

    Args:
        evidence: Linear over sticking error.
        found: Models of a sticking valve; None where no candidate moves it.
        problem: What the window poses.
        spent: Whether the search spent its budget, so that it may have missed the valve.
    """
    if found is None:
        return "no_stiction"
    if evidence < SLIDES_BELOW:
        return "undecided" if spent else "no_stiction"
    if found.least_error.candidate[S] < LEAST_S * problem.op_span:
        return "no_stiction"
    sees_it = turns(valve_position(found.least_error.candidate, problem)) > 0
    explains = fit_percent(found.least_error, problem) >= LEAST_FIT
    return "stiction" if evidence >= STICKS_ABOVE and sees_it and explains else "undecided"


def fitted_gain(fitted: Fitted, problem: Problem) -> float:
    """Return the gain, PV units per OP unit (per OP unit and sample for an integrator)."""
    position = valve_position(fitted.candidate, problem)
    response = response_to(position, fitted.candidate, fitted.structure, problem)
    return float(fit_gain(response, fitted.candidate, fitted.structure, problem)[1])


def process_intervals_of(found: Found, ts: float) -> ProcessIntervals:
    """Return the ranges of the process over the models that fit alike, engineering units."""
    per = ts if found.best.structure == INTEGRATOR else 1.0
    gains = [fitted_gain(fitted, found.view) / per for fitted in same_structure(found)]
    return process_intervals(found, gains, process_reach(found.best, found.view, LEAST_P), ts)


def process(
    fitted: Fitted, problem: Problem, ts: float, intervals: ProcessIntervals | None
) -> ProcessEstimate:
    """Return the process in engineering units, its gain solved in a view of the record."""
    gain = fitted_gain(fitted, problem)
    tau = math.exp(fitted.candidate[LOG_TAU]) * ts
    integrates = fitted.structure == INTEGRATOR
    tau2 = min(math.exp(fitted.candidate[LOG_TAU2]) * ts, tau) if fitted.structure == SOPDT else None
    return ProcessEstimate(
        kind=KIND[fitted.structure],
        gain=gain / ts if integrates else gain,
        tau=None if integrates else tau,
        delay=float(fitted.candidate[DELAY]) * ts,
        tau2=tau2,
        intervals=intervals,
    )


def simulate(fitted: Fitted, problem: Problem, window: LoopWindow) -> tuple[FloatArray, FloatArray]:
    """Return PV (PV units) and the valve position (OP units), each (n,).

    What the fit does not count is taken from the record: what is slower than the oscillation, and level and
    slope behind the filter, where the drift of a process that integrates stands.
    """
    position = valve_position(fitted.candidate, problem)
    no_filter = 1.0
    model = fitted_gain(fitted, problem) * process_response(
        position, fitted.candidate, fitted.structure, 1, no_filter
    )
    rest = bridge(window.pv) - model
    keep = problem.keep ** (1 / problem.block)
    counts = np.zeros(len(rest), dtype=np.bool_)
    counted = np.repeat(problem.weight > 0, problem.block)
    counts[: len(counted)] = counted
    passed = high_pass(rest, keep)
    slow = rest - passed + nuisance_of(passed, counts, keep)
    return model + slow, position


def fit_percent(fitted: Fitted, problem: Problem) -> float:
    """Return 100 (1 - ||PV - model|| / ||PV - mean PV||) over the blocks that count, high-passed."""
    return 100.0 * (1.0 - math.sqrt(fitted.error / max(float(np.sum(problem.pv**2)), 1e-300)))

"""The response of a candidate behind the filters of a record, and the free-run error that it leaves."""

from __future__ import annotations

import numpy as np

from agent.identify.arrays import FloatArray
from agent.identify.noise.prediction_filter import unpredicted
from agent.identify.objective import IMPOSSIBLE, fit_gain, in_bounds, process_response, valve_position
from agent.identify.problem import Problem
from agent.jit import kernel


@kernel
def response_to(position: FloatArray, candidate: FloatArray, structure: int, problem: Problem) -> FloatArray:
    """Return the response of gain one to the valve position (n,), as PV of the record is filtered, (m,).

    OP units. Filters may change places with the process, so the autoregression comes last.
    """
    response = process_response(position, candidate, structure, problem.block, problem.keep)
    if problem.whitening.size == 0:
        return response
    whitened: FloatArray = unpredicted(response.reshape(1, -1), problem.whitening)[0]
    return whitened


@kernel
def free_run_error(candidate: FloatArray, structure: int, problem: Problem) -> float:
    """Return the sum of squares of PV minus its free run, PV units squared; infinite out of bounds."""
    if not in_bounds(candidate, problem):
        return IMPOSSIBLE
    return process_error(valve_position(candidate, problem), candidate, structure, problem)


@kernel
def free_run_errors(candidates: FloatArray, structure: int, problem: Problem) -> FloatArray:
    """Return the errors of many candidates (k, SIZE), (k,); handing over a problem takes as long as one."""
    errors = np.empty(len(candidates))
    for i in range(len(candidates)):
        errors[i] = free_run_error(candidates[i], structure, problem)
    return errors


@kernel
def process_error(position: FloatArray, candidate: FloatArray, structure: int, problem: Problem) -> float:
    """Return the same of a candidate whose valve is at ``position``, OP units, (n,)."""
    if not in_bounds(candidate, problem):
        return IMPOSSIBLE
    response = response_to(position, candidate, structure, problem)
    return max(0.0, fit_gain(response, candidate, structure, problem)[0])

"""One step of a load beside a process: what a stem that slips once must beat.

A slip comes at an instant that only the valve knows, but so does a step of the load. One of them leaves in PV
what the other would; several slips are tied to each other by OP, and steps of a load are not.
"""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft

from agent.analysis.innovations.process_search import refitted
from agent.analysis.innovations.whitened import Fit, fitted, log_likelihood
from agent.identify.free_run_error import response_to
from agent.identify.objective import DELAY, LOG_TAU, LOG_TAU2
from agent.identify.search.linear import process_grid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.identify.problem import Problem

EVALUATIONS = 25
LEAST_ENERGY = 0.05
"""Of the whole response to a step: one that ends with the record sooner is not looked at."""
ALIKE = 1e-3
"""Part of the response to a step that OP must leave, to distinguish the two."""


class LoadStep(NamedTuple):
    """A step of the load, and the process that answers to OP and to it."""

    taken: float
    """Sum of squares that both take from PV, PV units squared."""
    at: int
    """Block of the step at the end of the dead time."""
    height: float
    """What PV goes by in the end, PV units (per block for an integrator)."""
    candidate: FloatArray


class Shape(NamedTuple):
    """The answer to a step of the load, for every block that it may begin at."""

    energy: FloatArray
    """Sum of squares of what the record sees of it, (m,)."""
    usable: NDArray[np.bool_]
    """Whether that is enough, (m,)."""
    transform: NDArray[np.complex128]
    """Conjugate of its Fourier transform."""
    of_pv: FloatArray
    """Its covariance with PV, (m,)."""


def with_load_step(linear: Fit, whitened: Sequence[Problem]) -> float:
    """Return the log likelihood (nats, less a constant) of a process whose load steps once.

    Gain and height are solved together for every instant and every process of a grid: fitted one after the
    other, the process would first bend to the step.

    Args:
        linear: The best process without a valve; its structure is kept.
        whitened: The record behind each filter.
    """
    likely = []
    for problem in whitened[::2]:
        step = _best_step(linear, problem)
        for noise, behind in enumerate(whitened):
            less = _without(behind, linear.structure, step)
            fit = fitted(step.candidate, linear.structure, less, noise, EVALUATIONS)
            likely.append((fit.score, fit, less))
    _, fit, less = max(likely, key=itemgetter(0))
    return log_likelihood(refitted(fit, less), less)


def _best_step(linear: Fit, problem: Problem) -> LoadStep:
    """Return the step that together with OP explains most of PV behind one filter."""
    candidates = process_grid(problem, linear.candidate[LOG_TAU2] - linear.candidate[LOG_TAU])
    answers: list[FloatArray] = []
    by_lag: dict[float, Shape] = {}
    for candidate in candidates:
        candidate[DELAY] = problem.fixed_delay or candidate[DELAY]
        answer = response_to(problem.op, candidate, linear.structure, problem)
        answer = answer * problem.weight
        answers.append(answer - problem.basis @ (problem.basis.T @ answer))
        lag = float(candidate[LOG_TAU])
        if lag not in by_lag:  # a step may come at any time: its shape has no delay of its own
            by_lag[lag] = _shape(_response(candidate, linear.structure, problem), problem)
    # All at once: of several hundred short transforms most of the time is not the transforms'.
    shapes = [by_lag[float(candidate[LOG_TAU])] for candidate in candidates]
    of_answers = _covariances(np.array(answers), np.array([shape.transform for shape in shapes]))
    beside = zip(answers, shapes, of_answers, candidates, strict=True)
    return max((_beside(problem.pv, *each) for each in beside), key=lambda step: step.taken)


def _shape(response: FloatArray, problem: Problem) -> Shape:
    """Return what is compared with PV and with answers to OP, from the answer to a step, (m,)."""
    energy = np.cumsum(response * response)[::-1]
    transform = rfft(response, _length(response)).conj()
    of_pv = _covariances(problem.pv[np.newaxis], transform[np.newaxis])[0]
    return Shape(energy, energy > LEAST_ENERGY * energy[0], transform, of_pv)


def _beside(
    pv: FloatArray, answer: FloatArray, shape: Shape, of_answer: FloatArray, candidate: FloatArray
) -> LoadStep:
    """Return the best step beside the answer to OP of gain one, (m,), OP units.

    ``of_answer`` (m,) are the covariances of that answer with the step's shape.
    """
    answers, gains = float(answer @ answer), float(answer @ pv)
    if answers <= 0:
        return LoadStep(0.0, 0, 0.0, candidate)
    left = shape.energy - of_answer**2 / answers
    usable = shape.usable & (left > ALIKE * shape.energy)
    rest = shape.of_pv - of_answer * gains / answers
    height = np.where(usable, rest, 0.0) / np.where(usable, left, 1.0)
    taken = height * rest
    at = int(np.argmax(taken))
    return LoadStep(float(taken[at]) + gains**2 / answers, at, float(height[at]), candidate)


def _length(signal: FloatArray) -> int:
    """Return how long a transform is of what is shifted by up to its length."""
    return int(next_fast_len(2 * signal.shape[-1] - 1, real=True))


def _covariances(signals: FloatArray, transforms: NDArray[np.complex128]) -> FloatArray:
    """Return the covariance of signals (k, m) with shapes begun at each block, row by row, (k, m)."""
    length = _length(signals)
    product = rfft(signals, length) * transforms
    return np.asarray(irfft(product, length)[:, : signals.shape[1]], dtype=np.float64)


def _response(candidate: FloatArray, structure: int, problem: Problem) -> FloatArray:
    """Return the filtered answer to a step of one OP unit at the first block, gain one, (m,)."""
    at_once = candidate.copy()
    at_once[DELAY] = 1.0
    load = np.ones(len(problem.pv) * problem.block)
    load[: problem.block] = 0.0
    return response_to(load, at_once, structure, problem)


def _without(problem: Problem, structure: int, step: LoadStep) -> Problem:
    """Return the problem whose PV is less the answer to the step."""
    shape = np.zeros(len(problem.pv))
    shape[step.at :] = _response(step.candidate, structure, problem)[: len(shape) - step.at]
    pv = (problem.pv - step.height * shape) * problem.weight
    return problem._replace(pv=(pv - problem.basis @ (problem.basis.T @ pv)) * problem.weight)

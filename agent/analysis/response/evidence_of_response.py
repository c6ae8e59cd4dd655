"""How much more likely a record is if PV does not respond to OP than if it does.

Both models have the same noise: an autoregression about a line, which also stands for loads. With a response,
a process takes its part of PV first. Only its static gain is held to what is known; its shape is free among
lags and delays about the known ones. So a process that differs a little from the known one does not pass for
no response, and neither does a loop in which nothing but PV itself moves OP: there some shape fits as well as
none. What remains is evidence: OP moved by itself, and nothing of any shape followed.

The record may have several parts, each at a level of its own: PV that jumps between two of them (a slip, or
the step of a load) is left out of both models. The line is one for all: a load that ramps does not turn just
where OP does, and PV of a stem that stands does not turn at all.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.signal import lfilter

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.analysis.response.candidates import LikelyProcess

ORDER = 6
"""Of the autoregression."""
LAGS = (0.5, 1.0, 2.0)
"""Time constants of the shapes, over the known one."""
LATER = (1.0, 2.0)
"""Delays of the shapes, over the known one."""
WIDEST = 2.0
"""Standard deviations to both sides over which the logarithm of the gain is integrated."""
STEP = 0.25
"""Between two points of this integral, at most: a gain that is wrong by an eighth still fits."""
FEWEST_GAINS = 9
"""Points of this integral, at least."""
ROUNDS = 3
"""Alternations between the shape and the autoregression."""
RIDGE = 1e-9
"""Share of the mean square of what is weighted that is added to it: two shapes may be alike."""
LEAST_SHARE = 1e-9
"""Mean square of the innovations below which they are rounding, over that which OP would have caused."""


class ResponseEvidence(NamedTuple):
    """What a record says of the response."""

    log_ratio: float
    """Log likelihood without a response less that with one, nats."""
    expected: float
    """Span that OP would have given PV through the likeliest process in the longest part, PV units."""
    deviations: float
    """The same in standard deviations: by how many PV would have left what is predicted from its own past."""
    free: int = 0
    """Weights of shapes that were fitted beside the gain."""


NOTHING = ResponseEvidence(-math.inf, 0.0, 0.0)
"""Of numbers that nothing can be computed of."""


def evidence_of_response(
    op: FloatArray,
    pv: FloatArray,
    tried: Sequence[LikelyProcess],
    parts: Sequence[slice] = (),
    enough: float = -math.inf,
) -> ResponseEvidence:
    """Compare both models on a record without gaps; of the processes tried the likeliest counts.

    Args:
        op: Shape (n,), OP units.
        pv: Shape (n,), PV units.
        tried: Processes that the loop may have, one at least.
        parts: Stretches that are compared, more than ``ORDER`` samples each; empty: the whole record.
        enough: Log ratio that is needed; the first process that falls short of it ends the comparison.
    """
    these = parts or (slice(0, len(pv)),)
    least = _compared(op, pv, tried[0], these)
    for process in tried[1:]:
        if least.log_ratio < enough:
            break
        least = min(least, _compared(op, pv, process, these), key=lambda found: found.log_ratio)
    return least


def filtered(op: FloatArray, tau: float | None, delay: int) -> FloatArray:
    """Return what OP (n,) gives behind a process of gain 1 that begins in balance, (n,).

    Args:
        op: OP units.
        tau: Time constant, samples; None: it integrates.
        delay: Samples.
    """
    late = np.concatenate((np.full(min(delay, len(op)), op[0]), op[: max(len(op) - delay, 0)]))
    if tau is None:
        return np.cumsum(late - late.mean())
    keep = math.exp(-1.0 / tau)
    return np.asarray(lfilter([1 - keep], [1.0, -keep], late - late[0]), dtype=np.float64)


def _compared(
    op: FloatArray, pv: FloatArray, process: LikelyProcess, parts: Sequence[slice]
) -> ResponseEvidence:
    taus = [None] if process.tau is None else [each * process.tau for each in LAGS]
    delays = dict.fromkeys(max(1, round(each * process.delay)) for each in LATER)
    rows = sum(each.stop - each.start - ORDER for each in parts)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        shapes = [process.gain * filtered(op, tau, delay) for delay in delays for tau in taus]
        products = _products([pv - pv.mean(), *shapes], parts)
    if not np.isfinite(products).all():
        return NOTHING
    moved = float(np.mean([products[k, 0, k, 0] for k in range(1, len(shapes) + 1)]))
    least = LEAST_SHARE * moved + 1e-300

    def log_likelihood(weights: FloatArray, white: FloatArray) -> FloatArray:
        error = np.einsum("ga,gab,gb->g", white, _mixed(products, weights), white)
        return np.asarray(-0.5 * rows * np.log(np.maximum(error, least)))

    nothing = np.zeros((1, len(shapes)))
    whites = _white(_mixed(products, nothing))
    without, alone = float(log_likelihood(nothing, whites)[0]), whites[0]
    sd = process.log_gain_sd
    z = np.linspace(-WIDEST, WIDEST, max(FEWEST_GAINS, 1 + math.ceil(2 * WIDEST * sd / STEP)))
    with_one = log_likelihood(*_likeliest_shapes(products, np.exp(sd * z), alone))
    prior = np.exp(-0.5 * z**2)
    top = float(with_one.max())
    integral = top + math.log(float(np.sum(prior * np.exp(with_one - top)) / prior.sum()))
    middle = len(shapes) // 2
    sigma = math.sqrt(max(float(alone @ products[0, :, 0, :] @ alone), least) / rows)
    caused = math.sqrt(max(float(alone @ products[middle + 1, :, middle + 1, :] @ alone), 0.0))
    longest = max(parts, key=lambda each: each.stop - each.start)
    span = float(np.ptp(shapes[middle][longest]))
    return ResponseEvidence(without - integral, span, caused / sigma, len(shapes) - 1)


def _products(signals: list[FloatArray], parts: Sequence[slice]) -> FloatArray:
    """Return the inner products of signals and lags, less level and line: (k, ORDER + 1, k, ORDER + 1)."""
    rows = np.concatenate([np.arange(each.start + ORDER, each.stop) for each in parts])
    levels = [np.full(each.stop - each.start - ORDER, k) for k, each in enumerate(parts)]
    which = np.concatenate(levels)[:, None] == np.arange(len(parts))
    line = (rows - rows.mean()) / max(float(np.ptp(rows)), 1.0)
    basis, _ = np.linalg.qr(np.column_stack((which, line)))
    lagged = np.array([x[rows - lag] for x in signals for lag in range(ORDER + 1)])
    lagged -= (lagged @ basis) @ basis.T
    count = len(signals)
    return np.asarray((lagged @ lagged.T).reshape(count, ORDER + 1, count, ORDER + 1))


def _mixed(products: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the products of the lags of PV less the weighted shapes, (g, ORDER + 1, ORDER + 1)."""
    mix = np.column_stack((np.ones(len(weights)), -weights))
    return np.asarray(np.einsum("gi,iajb,gj->gab", mix, products, mix))


def _likeliest_shapes(
    products: FloatArray, gains: FloatArray, alone: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return weights of the shapes (g, k) that add up to each gain (g,), and the filters of their noise."""
    count = len(products) - 1
    weights = np.repeat(gains[:, None] / count, count, axis=1)
    white = np.repeat(alone[None], len(gains), axis=0)
    for _ in range(ROUNDS):
        if count > 1:
            weights = _weights(np.einsum("ga,iajb,gb->gij", white, products, white), gains)
        white = _white(_mixed(products, weights))
    return weights, white


def _weights(gram: FloatArray, gains: FloatArray) -> FloatArray:
    """Return the weights of least squares (g, k) that add up to the gains."""
    count = gram.shape[1] - 1
    size = np.trace(gram[:, 1:, 1:], axis1=1, axis2=2) / count
    inner = gram / np.where(size > 0, size, 1.0)[:, None, None]
    system = np.ones((len(gram), count + 1, count + 1))
    system[:, :count, :count] = inner[:, 1:, 1:] + RIDGE * np.eye(count)
    system[:, count, count] = 0.0
    right = np.concatenate((inner[:, 1:, 0], gains[:, None]), axis=1)
    return np.asarray(np.linalg.solve(system, right[:, :, None])[:, :count, 0])


def _white(gram: FloatArray) -> FloatArray:
    """Return the filters (g, ORDER + 1) that leave the innovations of signals with these products of lags."""
    size = RIDGE * np.trace(gram, axis1=1, axis2=2) / (ORDER + 1) + 1e-300
    inner = gram[:, 1:, 1:] + size[:, None, None] * np.eye(ORDER)
    past = np.linalg.solve(inner, gram[:, 1:, 0][:, :, None])[:, :, 0]
    return np.column_stack((np.ones(len(gram)), -past))

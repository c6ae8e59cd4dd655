"""How much more likely a record is if PV does not respond to OP than if it does.

Both models have the same noise: an autoregression about a line, which also stands for loads. With a response,
a process takes its part of PV first. Only its static gain is held to what is known; its shape is free among
lags and delays about the known ones. So a process that differs a little from the known one does not pass for
no response, and neither does a loop in which nothing but PV itself moves OP: there some shape fits as well as
none. What remains is evidence: OP moved by itself, and nothing of any shape followed.
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
GAINS = np.linspace(-2.0, 2.0, 9)
"""Points of the integral over the logarithm of the gain, standard deviations."""
ROUNDS = 3
"""Alternations between the shape and the autoregression."""
LEAST_SHARE = 1e-9
"""Mean square of the innovations below which they are rounding, over that which OP would have caused."""


class ResponseEvidence(NamedTuple):
    """What a record says of the response."""

    log_ratio: float
    """Log likelihood without a response less that with one, nats."""
    expected: float
    """Span that OP would have given PV through the likeliest process, PV units."""
    deviations: float
    """The same in standard deviations: by how many PV would have left what is predicted from its own past."""


NOTHING = ResponseEvidence(-math.inf, 0.0, 0.0)
"""Of numbers that nothing can be computed of."""


def evidence_of_response(op: FloatArray, pv: FloatArray, tried: Sequence[LikelyProcess]) -> ResponseEvidence:
    """Compare both models on a record without gaps; of the processes tried the likeliest counts.

    Args:
        op: Shape (n,), OP units.
        pv: Shape (n,), PV units.
        tried: Processes that the loop may have, one at least.
    """
    return min((_compared(op, pv, each) for each in tried), key=lambda found: found.log_ratio)


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


def _compared(op: FloatArray, pv: FloatArray, process: LikelyProcess) -> ResponseEvidence:
    taus = [None] if process.tau is None else [each * process.tau for each in LAGS]
    delays = dict.fromkeys(max(1, round(each * process.delay)) for each in LATER)
    rows = len(pv) - ORDER
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        shapes = [process.gain * filtered(op, tau, delay) for delay in delays for tau in taus]
        products = _products([pv - pv.mean(), *shapes], rows)
    if not np.isfinite(products).all():
        return NOTHING
    moved = float(np.mean([products[k, 0, k, 0] for k in range(1, len(shapes) + 1)]))
    least = LEAST_SHARE * moved + 1e-300

    def log_likelihood(weights: FloatArray, white: FloatArray) -> float:
        error = float(white @ _mixed(products, weights) @ white)
        return -0.5 * rows * math.log(max(error, least))

    nothing = np.zeros(len(shapes))
    alone = _white(_mixed(products, nothing))
    without = log_likelihood(nothing, alone)
    fits = [_likeliest_shape(products, math.exp(process.log_gain_sd * z), alone) for z in GAINS]
    with_one = np.array([log_likelihood(*each) for each in fits])
    prior = np.exp(-0.5 * GAINS**2)
    top = float(with_one.max())
    integral = top + math.log(float(np.sum(prior * np.exp(with_one - top)) / prior.sum()))
    middle = len(shapes) // 2
    sigma = math.sqrt(max(float(alone @ products[0, :, 0, :] @ alone), least) / rows)
    caused = math.sqrt(max(float(alone @ products[middle + 1, :, middle + 1, :] @ alone), 0.0))
    return ResponseEvidence(without - integral, float(np.ptp(shapes[middle])), caused / sigma)


def _products(signals: list[FloatArray], rows: int) -> FloatArray:
    """Return the inner products of signals and lags, less their lines: (k, ORDER + 1, k, ORDER + 1)."""
    line = np.stack((np.ones(rows), np.linspace(-1.0, 1.0, rows)), axis=1)
    basis, _ = np.linalg.qr(line)
    lagged = np.array([x[ORDER - lag : ORDER - lag + rows] for x in signals for lag in range(ORDER + 1)])
    lagged -= (lagged @ basis) @ basis.T
    count = len(signals)
    return np.asarray((lagged @ lagged.T).reshape(count, ORDER + 1, count, ORDER + 1))


def _mixed(products: FloatArray, weights: FloatArray) -> FloatArray:
    """Return the products of the lags of PV less the weighted shapes, (ORDER + 1, ORDER + 1)."""
    mix = np.concatenate(([1.0], -weights))
    return np.asarray(np.einsum("i,iajb,j->ab", mix, products, mix))


def _likeliest_shape(products: FloatArray, gain: float, white: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the weights of the shapes (k,) that add up to ``gain``, and the filter of their noise."""
    count = len(products) - 1
    weights = np.full(count, gain / count)
    for _ in range(ROUNDS):
        if count > 1:
            weights = _weights(np.einsum("a,iajb,b->ij", white, products, white), gain)
        white = _white(_mixed(products, weights))
    return weights, white


def _weights(gram: FloatArray, gain: float) -> FloatArray:
    """Return the weights of least squares that add up to ``gain``."""
    count = len(gram) - 1
    ridge = 1e-9 * np.trace(gram[1:, 1:]) / count + 1e-300
    system = np.ones((count + 1, count + 1))
    system[:count, :count] = gram[1:, 1:] + ridge * np.eye(count)
    system[count, count] = 0.0
    return np.asarray(np.linalg.lstsq(system, np.append(gram[1:, 0], gain), rcond=None)[0][:count])


def _white(gram: FloatArray) -> FloatArray:
    """Return the filter (ORDER + 1,) that leaves the innovations of a signal with these products of lags."""
    inner = gram[1:, 1:] + (1e-9 * np.trace(gram) / len(gram) + 1e-300) * np.eye(ORDER)
    return np.concatenate(([1.0], -np.linalg.solve(inner, gram[1:, 0])))

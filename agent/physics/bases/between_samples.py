"""The continuous process that does what a sampled model does, for an input that is held.

Pole by pole: of a sampled pole its logarithm, and of its share of the response the residue of which
``held_modes.py`` makes it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.bases.steiglitz_mcbride import sampled_models

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.bases.steiglitz_mcbride import Sampled

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]

APART = 1e-4
"""Part by which real poles are moved apart that would be the same."""
FASTEST = 0.05
"""Time constant, samples, of a pole that no held process has."""


def first_values(op: FloatArray, pv: FloatArray, order: int, ts: float) -> FloatArray:
    """Return values of linear processes from OP to PV, both (n,), fitted in turns, (m, 2 order), best first.

    Of order two delay, tau, damping and zero; of order three the second zero and the lag as well.
    """
    found = [values_of(each, ts) for each in sampled_models(op, pv, order)]
    return np.array([each for each in found if np.isfinite(each).all()]).reshape(-1, 2 * order)


def values_of(sampled: Sampled, ts: float) -> FloatArray:
    """Return the values of a process that does what a sampled model of order 2 or 3 does; ``ts`` in s."""
    top, bottom, delay = sampled
    kept = np.roots(bottom).astype(np.complex128)
    real = kept.imag == 0.0
    kept[real] = np.maximum(kept[real].real, np.exp(-1.0 / FASTEST))
    kept[real] *= 1.0 + APART * np.arange(np.count_nonzero(real))
    poles = np.log(kept)
    over = np.zeros(len(poles))
    for i, (there, pole) in enumerate(zip(kept, poles, strict=True)):
        share = np.polyval(top, there) / np.prod(there - np.delete(kept, i))
        over = over + (share * pole / np.expm1(pole) * np.poly(np.delete(poles, i))).real
    with np.errstate(divide="ignore", invalid="ignore"):
        zeros = over[-2::-1] / over[-1]
    pair, lone = _pair(poles)
    tau = 1.0 / float(np.sqrt(abs(np.prod(pair))))
    damping = -0.5 * float(np.sum(pair).real) * tau
    scaled = [each / tau ** (k + 1) for k, each in enumerate(zeros)]
    return np.array(((1 + delay) * ts, tau * ts, damping, *scaled, *(-ts / lone.real)))


def _pair(poles: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the pair that rings, or the two nearest to each other, and the third, (0,) or (1,)."""
    if np.any(poles.imag != 0.0) or len(poles) == 2:
        order = np.argsort(-np.abs(poles.imag))
    else:
        order = np.argsort(np.abs(poles))
        first, second, third = np.log(np.abs(poles[order]))
        order = order if second - first < third - second else order[::-1]
    return poles[order[:2]], poles[order[2:]]

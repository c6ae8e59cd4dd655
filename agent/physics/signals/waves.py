"""Cosine and sine of a wave and its harmonics, sample by sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel

FloatArray = NDArray[np.float64]
PART = 32
"""Samples that are turned together by angles that are known: a product takes a hundredth of a cosine."""


@kernel
def waves(first: float, step: float, count: int, harmonics: int) -> FloatArray:
    """Return cosine and sine of the angle and of its multiples.

    By the sum of two angles, the first sample of each part and the place in the part, so that no error adds
    up over the record.

    Args:
        first: Angle of the first sample, rad.
        step: From sample to sample, rad.
        count: Samples, n.
        harmonics: Multiples, the angle itself included.

    Returns:
        (2 harmonics, n): cosine and sine of the angle, then of twice the angle, and so on.
    """
    out = np.empty((2 * harmonics, count))
    cosine, sine = np.empty(PART), np.empty(PART)
    for multiple in range(1, harmonics + 1):
        for i in range(PART):
            cosine[i], sine[i] = np.cos(multiple * step * i), np.sin(multiple * step * i)
        x, y = out[2 * multiple - 2], out[2 * multiple - 1]
        for start in range(0, count, PART):
            angle = multiple * (first + step * start)
            a, b = np.cos(angle), np.sin(angle)
            for i in range(min(PART, count - start)):
                x[start + i] = a * cosine[i] - b * sine[i]
                y[start + i] = b * cosine[i] + a * sine[i]
    return out

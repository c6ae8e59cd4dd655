"""The exact filter of a linear process between samples, for an input that is held.

By partial fractions: a pole p with its residue r turns an input that is held for a part of a sample, and ends
at another part s before its end, into r e^(p s) (e^(p part) - 1) / p.
Source: K. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., 2.3 (a delay of part of a sample).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]
    ComplexArray = NDArray[np.complex128]


def held_filter(poles: ComplexArray, residues: ComplexArray, late: float) -> tuple[FloatArray, FloatArray]:
    """Return numerator, (k + 1,), and denominator, (k + 1,), of the filter from the sample before on.

    Args:
        poles: One over a sample, (k,), real or in pairs, no two the same.
        residues: Of each pole, one over a sample, (k,).
        late: Part of a sample by which the input comes late, for which the one before it still counts.
    """
    new = residues * np.expm1(poles * (1.0 - late)) / poles
    old = residues * np.exp(poles * (1.0 - late)) * np.expm1(poles * late) / poles
    kept = np.exp(poles)
    top = np.zeros(len(poles) + 1, dtype=np.complex128)
    for i, both in enumerate(zip(new, old, strict=True)):
        top += np.convolve(both, np.poly(np.delete(kept, i)))
    return np.ascontiguousarray(top.real), np.ascontiguousarray(np.poly(kept).real)

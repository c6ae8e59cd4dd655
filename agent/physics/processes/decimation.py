"""Fewer samples of a record, after the valve and never before it.

Every move of OP affects where the stem slips, and holding block means shifts the dead time. So run valve and
process at the rate of the record, then take block means of the response and of PV. Reference ``methods.md``
0.7; docs/methods/decimation.md.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray


@kernel
def block_means(signal: NDArray[np.float64], factor: int) -> NDArray[np.float64]:
    """Return the mean of each whole block of ``factor`` samples, same unit, shape (n // factor,).

    A block with a missing sample (NaN) is NaN; samples after the last whole block are left out.

    Args:
        signal: Shape (n,).
        factor: Samples a block, >= 1.

    Raises:
        ValueError: ``factor`` is below 1.
    """
    if factor < 1:
        raise ValueError("a block must have at least one sample")
    means = np.empty(signal.size // factor)
    for block in range(means.size):
        total = 0.0
        for t in range(block * factor, (block + 1) * factor):
            total += signal[t]
        means[block] = total / factor
    return means

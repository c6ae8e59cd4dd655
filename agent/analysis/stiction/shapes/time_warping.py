"""Dynamic time warping: how far two curves are apart when one may lag the other a little.

Source: H. Sakoe, S. Chiba, "Dynamic programming algorithm optimization for spoken word recognition", IEEE
Transactions on Acoustics, Speech and Signal Processing 26 (1978) 43.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


@kernel
def warped_distances(curves: FloatArray, templates: FloatArray, band: int) -> FloatArray:
    """Return the distance of each curve from each template along the cheapest path, (m, k).

    Args:
        curves: (m, n).
        templates: (k, n).
        band: Points that the path may be off the diagonal.

    Returns:
        Sum of the squared differences along the path over n, squared units of the curves.
    """
    m, n = curves.shape
    k = templates.shape[0]
    distances = np.empty((m, k))
    for a in range(m):
        for b in range(k):
            before = np.full(n + 1, np.inf)
            before[0] = 0.0
            for i in range(n):
                row = np.full(n + 1, np.inf)
                for j in range(max(0, i - band), min(n, i + band + 1)):
                    step = (curves[a, i] - templates[b, j]) ** 2
                    row[j + 1] = step + min(before[j], before[j + 1], row[j])
                before = row
            distances[a, b] = before[n] / n
    return distances

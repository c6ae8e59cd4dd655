"""The smallest effect that could have been confirmed on a record.

The verdict ``none`` means little where nothing could have been confirmed.
"""

from __future__ import annotations

import math

from agent.workbench.paired_blocks import LEAST_PERCENT
from agent.workbench.residual.very_strong import VERY_STRONG

NUMBERS = 2
"""Of the simplest effects: how large it is, and one number that is searched."""


def smallest_reduction(samples: int, candidates: int) -> float:
    """Return the smallest reduction of a white residual's squares, %, that would have been confirmed.

    Of n samples a reduction by the share r makes the record likelier by n ln(1 / (1 - r)), twice a logarithm.
    That must pay Schwarz's price of the numbers and of being one of the candidates, and be very strong. Under
    a load that wanders it is that of the innovations.

    Args:
        samples: That count.
        candidates: How many effects were scored, at least 1.
    """
    price = VERY_STRONG + 2 * math.log(candidates) + NUMBERS * math.log(samples)
    return max(LEAST_PERCENT, -100 * math.expm1(-price / samples))

"""From where on the innovations support one model of two very strongly."""

from __future__ import annotations

import math

VERY_STRONG = 10.0
"""Evidence for one of two models, twice a logarithm (Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773)."""


def very_strong(criterion: float, candidates: int) -> bool:
    """Return whether ``Evidence.criterion`` of one of some candidates is, each as likely before."""
    return criterion - 2 * math.log(candidates) > VERY_STRONG

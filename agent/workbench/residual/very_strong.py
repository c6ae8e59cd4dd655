"""From where on the innovations support one model of two strongly, and very strongly."""

from __future__ import annotations

import math

STRONG = 6.0
"""Evidence for one of two models that are both able to explain the record, twice a logarithm: odds of 20."""
VERY_STRONG = 10.0
"""The same where one may explain nothing: odds of 150 (Kass and Raftery, J. Am. Stat. Assoc. 90 (1995)
773)."""


def odds_of(criterion: float, candidates: int) -> float:
    """Return ``Evidence.criterion`` of one of some candidates less the price of being one of them."""
    return criterion - 2 * math.log(candidates)


def very_strong(criterion: float, candidates: int) -> bool:
    """Return whether ``Evidence.criterion`` of one of some candidates is, each as likely before."""
    return odds_of(criterion, candidates) > VERY_STRONG

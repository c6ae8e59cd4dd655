"""How well numbers rank what is so before what is not."""

from __future__ import annotations

from collections.abc import Sequence


def area(positive: Sequence[float], negative: Sequence[float]) -> float:
    """Return the probability that a positive one ranks before a negative one; equal ones count half.

    It is the area under the curve of true against false positives (Hanley and McNeil 1982).
    """
    pairs = [(a > b) + 0.5 * (a == b) for a in positive for b in negative]
    return sum(pairs) / len(pairs) if pairs else float("nan")

"""Numbers as text, picture and report print them: the same number has the same digits everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.results import IntervalEstimate

SMALLEST_P = 1e-3
"""Below which p has no digits."""


def percent_words(value: float) -> str:
    """Return a share or a fit."""
    return f"{value:.3g} %"


def p_words(p: float) -> str:
    """Return a probability by chance; smaller ones than a thousandth are no better evidence to a reader."""
    return "p < 0.001" if p < SMALLEST_P else f"p = {p:.2g}"


def interval_words(estimate: IntervalEstimate) -> str:
    """Return the ends of an interval; empty where it is not known."""
    known = estimate.low is not None and estimate.high is not None
    return f"{estimate.low:.4g} to {estimate.high:.4g}" if known else ""


def value_words(estimate: IntervalEstimate) -> str:
    """Return a value with its interval in brackets, where it is known."""
    ends = interval_words(estimate)
    return f"{estimate.value:.4g} ({ends})" if ends else f"{estimate.value:.4g}"


def band_words(name: str, estimate: IntervalEstimate) -> str:
    """Return a named value with its interval."""
    return f"{name} = {value_words(estimate)}"

"""Numbers as text, picture and report print them: the same number has the same digits everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.results import IntervalEstimate

SMALLEST_P = 1e-3
"""Below which p has no digits."""
EXPONENTS = 3, 99
"""Powers of ten from which on odds have no other digits, and no further power."""


def percent_words(value: float) -> str:
    """Return a share or a fit."""
    return f"{value:.3g} %"


def tenths(value: float) -> str:
    """Return a number with one decimal; what rounds to zero has no sign."""
    return f"{round(value, 1) + 0.0:.1f}"


def share_words(share: float) -> str:
    """Return a share, 0 to 1, in whole per cent; one below a per cent with its first digit."""
    return f"{100 * share:.0f} %" if share >= 0.01 or share == 0 else f"{100 * share:.1g} %"


def p_words(p: float) -> str:
    """Return a probability by chance; smaller ones than a thousandth are no better evidence to a reader."""
    return "p < 0.001" if p < SMALLEST_P else f"p = {p:.2g}"


def odds_words(exponent: float) -> str:
    """Return how much likelier than not something is, of its odds as a power of ten."""
    if exponent <= 0.0:
        return "no likelier with it"
    if exponent < EXPONENTS[0]:
        return f"odds {10.0**exponent:.0f} to 1"
    above = "above " if exponent > EXPONENTS[1] else ""
    return f"odds {above}1e{min(round(exponent), EXPONENTS[1])} to 1"


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

"""Stiction quantifiers, one a file."""

from __future__ import annotations

from agent.analysis.quantify.free_run import FreeRun
from agent.analysis.quantify.lee2008 import Lee2008
from agent.analysis.quantify.quantifier import Quantifier

__all__ = ["QUANTIFIERS", "Quantifier", "quantifier"]

QUANTIFIERS: tuple[Quantifier, ...] = (FreeRun(), Lee2008("grid"), Lee2008("random"))


def quantifier(name: str) -> Quantifier:
    """Return the quantifier of that name.

    Raises:
        ValueError: There is none; the message lists those there are.
    """
    for candidate in QUANTIFIERS:
        if candidate.name == name:
            return candidate
    raise ValueError(f"no quantifier {name!r}; there are {', '.join(each.name for each in QUANTIFIERS)}")

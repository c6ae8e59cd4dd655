"""The least fit of a verdict: a model that explains little of PV may be the better one but proves nothing."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.results import Quantification

LEAST_FIT = 50.0
"""Fit percent that a sticking valve must reach. Of 40 simulated sticking loops 39 reach 63 with the valve of
Kano and a walking bias, of 40 loops with a drifting load 2 exceed 46 (``random_plants``, seeds 0 to 39)."""


def undecided_below_least_fit(found: Quantification) -> Quantification:
    """Return the result, undecided where its model of a sticking valve explains too little."""
    if found.decision == "stiction" and (found.free_run_percent or 0.0) < LEAST_FIT:
        return replace(found, decision="undecided")
    return found

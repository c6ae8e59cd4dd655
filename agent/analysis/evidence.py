"""All methods weighed against each other: how probable is it that the valve sticks?

Log odds: each witness adds its weight times what it says. The weights are a logistic regression on simulated
loops, none below zero, so that no method counts against its own word (``evidence_weights``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.evidence_weights import BIAS, DETECTORS, FREE_RUN, FREE_RUN_QUICK, WITH_STEM

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.results import MethodResult, MethodVerdict, Quantification

SAYS: dict[MethodVerdict, int] = {"stiction": 1, "no_stiction": -1}
ENOUGH_EVIDENCE = math.e
"""Evidence beyond which more does not count: how well a model fits is then a matter of noise."""
ENOUGH_TURNS = 10
"""Turns of the valve beyond which more do not count."""
MOST = math.log(99)
"""Log odds beyond which the calibration has too few simulated loops to speak: 99 %."""


@dataclass(frozen=True, slots=True)
class Witness:
    """A method that has something to say."""

    name: str
    log_odds: float
    """What it adds to the log odds that the valve sticks."""


@dataclass(frozen=True, slots=True)
class Weighed:
    """What all witnesses say together."""

    probability: float
    """That the valve sticks, calibrated on simulated loops."""
    witnesses: tuple[Witness, ...]
    """The strongest first; without those that add nothing."""


def weigh(found: Quantification, methods: Mapping[str, MethodResult], *, stem_measured: bool) -> Weighed:
    """Weigh the fit of ``free_run`` and the detectors.

    Args:
        found: Answer of ``free_run``, with evidence, quick evidence and turns.
        methods: Answers of the detectors by name; one that no weight is known of adds nothing.
        stem_measured: Whether the window has MV, which tells more than PV can.
    """
    weights = DETECTORS | WITH_STEM if stem_measured else DETECTORS
    said = [
        Witness(name, weights.get(name, 0.0) * SAYS.get(each.verdict, 0)) for name, each in methods.items()
    ]
    said.append(
        Witness(
            found.quantifier,
            sum(w * x for w, x in zip((FREE_RUN, FREE_RUN_QUICK), features(found), strict=True)),
        )
    )
    log_odds = min(max(BIAS + sum(each.log_odds for each in said), -MOST), MOST)
    told = sorted((each for each in said if each.log_odds), key=lambda each: -abs(each.log_odds))
    return Weighed(1 / (1 + math.exp(-log_odds)), tuple(told))


def features(found: Quantification) -> tuple[float, float]:
    """Return what ``free_run`` says, 0 to 1 each: its evidence and its quick evidence over the valve's turns.

    A valve that never turns says nothing: any load that the controller cancels looks like its dead band.
    """
    turns = math.log1p(min(found.turns or 0, ENOUGH_TURNS)) / math.log1p(ENOUGH_TURNS)
    return turns * _capped(found.evidence), turns * _capped(found.quick_evidence)


def _capped(evidence: float | None) -> float:
    return math.log(min(max(evidence or 1.0, 1.0), ENOUGH_EVIDENCE))

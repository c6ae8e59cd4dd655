"""All methods weighed against each other: how probable is it that the valve sticks?

Log odds: each witness adds its weight times what it says. The weights are a logistic regression on simulated
loops, none below zero, so that no method counts against its own word (``evidence_weights``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agent.analysis.evidence.weights import (
    BIAS,
    DETECTORS,
    FREE_RUN,
    FREE_RUN_QUICK,
    INNOVATIONS,
    INNOVATIONS_OVER_TURNS,
    WITH_STEM,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.results import MethodResult, MethodVerdict, Quantification

SAYS: dict[MethodVerdict, int] = {"stiction": 1, "no_stiction": -1}
ENOUGH_EVIDENCE = math.e
"""Evidence beyond which more does not count: how well a model fits is then a matter of noise."""
ENOUGH_TURNS = 10
"""Turns of the valve beyond which more do not count."""
LITTLE_LIKELIHOOD, ENOUGH_LIKELIHOOD = 10.0, 100.0
"""Log likelihood ratios (nats) up to which one grows as its worth, since a search among many valves finds
some by chance; and beyond which more does not count."""
SURE = 0.8
"""Probability from which stiction is reported, or excluded: none of 187 simulated sound loops exceeds it, if
weighed with weights fitted to the others."""
SHOWN = 0.77
"""Mean chance that a loop of those that the weights were learnt on would show a valve that sticks (all
346 of them)."""
MOST = math.log(99)
"""Log odds beyond which the calibration has too few simulated loops to speak: 99 %."""
COARSE, FINE = 12.0, 30.0
"""Samples a period of the coarsest records that are judged, and from which records count as fine."""
MOST_OF_COARSE = math.log(19)
"""As ``MOST``, for the coarsest records: 95 %. The weights were learnt on finer ones, and some sixty records
at such rates (``benchmarks.sampling_rate``), none judged wrongly, exclude one wrong verdict in twenty."""


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
    would_show: float | None = None
    """How likely PV would show a valve that sticks, 0 to 1; None: not known, the stem is measured, or the
    probability takes it into account."""


def weigh(
    found: Quantification,
    methods: Mapping[str, MethodResult],
    *,
    stem_measured: bool,
    samples_per_period: float | None = None,
) -> Weighed:
    """Weigh the fit of ``free_run``, the innovations and the detectors.

    Args:
        found: Answer of ``free_run``, with evidence, quick evidence, turns and log likelihood ratio.
        methods: Answers of the detectors by name; one that no weight is known of adds nothing.
        stem_measured: Whether the window has MV, which shows more than PV can.
        samples_per_period: Of the record; None where nothing oscillates.
    """
    weights = DETECTORS | WITH_STEM if stem_measured else DETECTORS
    said = [
        Witness(name, weights.get(name, 0.0) * SAYS.get(each.verdict, 0)) for name, each in methods.items()
    ]
    evidence, quick, over_turns, likelihood = features(found)
    said.append(Witness(found.quantifier, FREE_RUN * evidence + FREE_RUN_QUICK * quick))
    said.append(Witness("innovations", INNOVATIONS_OVER_TURNS * over_turns + INNOVATIONS * likelihood))
    most = most_log_odds(samples_per_period)
    log_odds = min(max(BIAS + sum(each.log_odds for each in said), -most), most)
    told = sorted((each for each in said if each.log_odds), key=lambda each: -abs(each.log_odds))
    would_show = None if stem_measured else found.would_show
    return Weighed(1 / (1 + math.exp(-log_odds)), tuple(told), would_show)


def sound_as_far_as_shown(probability: float, would_show: float | None) -> float:
    """Return the probability that a valve of which nothing is seen is sound, both kinds being as likely.

    A valve that sticks and is not shown looks as a sound one: if a part w is shown, with some odds, all have
    1 - w + w odds. ``probability`` was learnt on loops of which ``SHOWN`` is shown; where less is, the odds
    are higher by the ratio of the two. They are never lower: nothing was learnt of more.

    Args:
        probability: That it sticks, as weighed, below one half.
        would_show: How likely the record would show a valve that sticks, 0 to 1; None: not known.
    """
    odds = probability / (1 - probability)
    shown = SHOWN if would_show is None else min(would_show, SHOWN)
    return 1 / (1 + odds * (1 - shown + shown * odds) / (1 - SHOWN + SHOWN * odds))


def most_log_odds(samples_per_period: float | None) -> float:
    """Return the log odds beyond which nothing is believed of a record with so many samples a period."""
    if samples_per_period is None:
        return MOST
    share = (samples_per_period - COARSE) / (FINE - COARSE)
    return MOST_OF_COARSE + min(max(share, 0.0), 1.0) * (MOST - MOST_OF_COARSE)


def features(found: Quantification) -> tuple[float, float, float, float]:
    """Return what the models say, 0 to 1 each.

    Over the turns of the valve, for the travel of one that never turns is also that of a load which the
    controller cancels: evidence, quick evidence and log likelihood ratio; and the latter as it is.
    """
    turns = math.log1p(min(found.turns or 0, ENOUGH_TURNS)) / math.log1p(ENOUGH_TURNS)
    ratio = min(max(found.log_likelihood_ratio or 0.0, 0.0), ENOUGH_LIKELIHOOD)
    likelihood = math.log1p(ratio / LITTLE_LIKELIHOOD) / math.log1p(ENOUGH_LIKELIHOOD / LITTLE_LIKELIHOOD)
    evidence, quick = worths(found)
    return turns * evidence, turns * quick, turns * likelihood, likelihood


def worths(found: Quantification) -> tuple[float, float]:
    """Return the worth of the evidence and of the quick one, 0 to 1; none where the load is one wave."""
    return (0.0, 0.0) if found.load_wave else (capped(found.evidence), capped(found.quick_evidence))


def capped(evidence: float | None) -> float:
    """Return the worth of an evidence, 0 to 1: its logarithm."""
    return math.log(min(max(evidence or 1.0, 1.0), ENOUGH_EVIDENCE))

"""What several recordings of one valve say together: they are weighed as one long record would be."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from agent.analysis.evidence.weighing import ENOUGH_LIKELIHOOD, SAYS, Weighed, weigh, worths
from agent.analysis.results import MethodResult

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import MethodVerdict, Quantification

SEARCH = 4.0
"""Nats that each further record must bring before it speaks for a sticking valve: its search is one more
chance to find some in a sound one. On simulated valves 0 accuses a sound one of eight recordings that 2 does
not, and 6 misses one more that sticks."""


def weigh_together(diagnoses: Sequence[Diagnosis], *, stem_measured: bool) -> Weighed:
    """Weigh the recordings of one valve as one record.

    Args:
        diagnoses: One at least, each with the answer of ``free_run``, and no event twice.
        stem_measured: Whether all of them have MV.
    """
    found = [each.quantification for each in diagnoses if each.quantification is not None]
    said = majority([each.methods for each in diagnoses])
    rates = [each.samples_per_period for each in diagnoses if each.samples_per_period is not None]
    finest = max(rates, default=None)
    return weigh(joined(found), said, stem_measured=stem_measured, samples_per_period=finest)


def joined(found: Sequence[Quantification]) -> Quantification:
    """Return what ``free_run`` and the innovations would say of all records in one.

    Log likelihood ratios add up, each but one less ``SEARCH``, and none counts for more than it may alone:
    one record that is wrong must not outweigh many. The turns of the valve add up as well. The evidence is
    the geometric mean, for the likelihood of records with noise of their own goes with the product. A valve
    that sticks would be shown by the record that shows most.
    """
    evidence, quick = zip(*map(worths, found), strict=True)
    ratios = [min(each.log_likelihood_ratio or 0.0, ENOUGH_LIKELIHOOD) for each in found]
    return replace(
        found[0],
        log_likelihood_ratio=max(0.0, sum(ratios) - SEARCH * (len(ratios) - 1)),
        turns=sum(each.turns or 0 for each in found),
        evidence=_mean(evidence),
        quick_evidence=_mean(quick),
        would_show=max((each.would_show for each in found if each.would_show is not None), default=None),
        load_wave=False,
        slip_scatter=None,
    )


def majority(answers: Sequence[Mapping[str, MethodResult]]) -> dict[str, MethodResult]:
    """Return for each detector what more of its answers say than the contrary; else ``undecided``."""
    votes: dict[str, int] = defaultdict(int)
    for methods in answers:
        for name, each in methods.items():
            votes[name] += SAYS.get(each.verdict, 0)
    return {name: MethodResult(_verdict(vote), None) for name, vote in votes.items()}


def _verdict(votes: int) -> MethodVerdict:
    if votes == 0:
        return "undecided"
    return "stiction" if votes > 0 else "no_stiction"


def _mean(worth: Sequence[float]) -> float:
    return math.exp(sum(worth) / len(worth))

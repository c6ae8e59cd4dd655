"""Whether a valve sticks as it did before: the likelihood of a record with its known S over that with none.

A loop whose valve was repaired is quiet: no limit cycle, few reversals, nothing that a search for S can use.
But OP still moves by less than S, and PV responds. Two models are compared behind the process that other
windows showed, its gain as sure as they agree: the stem follows OP, or it is that of a valve with the known S
(He 2007), which stands for most of the time. Each is compared with a PV that nothing moves
(``evidence_of_response``), so the noise, which is fitted with each, is the same. No search is needed.

Behind a sound valve PV may also look as if nothing moved it: the controller cancels a load that wanders, and
what it knew of the load between two samples is not in the record. So a sound valve has the likelier of both,
and a stem that stands because OP moves by less than S says nothing.

S is known within some tenths, J and where the stem rests before the record are not: the likelihood is the
mean over some. An S that is a tenth too large alone turns a clear record of few slips: it has none of them.
The shape of the process has free weights, which take half a nat each from noise alone (Wilks); a stem that
stands has none, so that much is given back: a valve that never moves must not pass for a repaired one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.gates.record import MIN_SAMPLES
from agent.analysis.response.candidates import candidates
from agent.analysis.response.evidence_of_response import evidence_of_response
from agent.analysis.response.stretches import longest_true
from agent.physics.valves.he2007 import he2007
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.response.candidates import LikelyProcess

SHARES = (0.7, 0.85, 1.0, 1.15)
"""S over the known one that are tried: what a former S may be wrong by."""
J_RATIOS = (0.0, 0.6)
"""J over S that are tried: a dead band, and stems that jump."""
RESTS = (-0.8, -0.4, 0.0, 0.4, 0.8)
"""OP less the stem before the record that are tried, over f_S."""

CANCELLED = 0.0
"""Log likelihood of a PV that nothing moves over itself, nats."""
FREE = 0.5
"""What a free weight takes from noise alone, nats: half the mean of a chi-square distribution."""


@dataclass(frozen=True, slots=True)
class AsBefore:
    """How the known S of a valve agrees with one record of it."""

    s: float
    """The known S, OP units."""
    log_ratio: float
    """Log likelihood with that S less that of a sound valve, whose loads the controller may cancel, nats."""


def as_before(window: LoopWindow) -> AsBefore | None:
    """Return how the known S agrees with a record; None where the valve is not known.

    Args:
        window: The record; its hints have the valve as other windows showed it.
    """
    valve = window.hints.known_valve
    if valve is None:
        return None
    here = longest_true(window.valid)
    if here.stop - here.start < MIN_SAMPLES:
        return None
    op, pv = window.op[here], window.pv[here]
    if not np.ptp(op) or not np.ptp(pv):
        return None
    tried = candidates(window, valve.process, None)
    sound = max(_gain(op, pv, tried), CANCELLED)
    sticks = [_gain(stem, pv, tried) for stem in _stems(op, valve.s)]
    ratios = np.array(sticks) - sound
    if not np.isfinite(ratios).all():
        return None  # numbers of which nothing can be computed
    top = float(ratios.max())
    return AsBefore(valve.s, top + math.log(float(np.exp(ratios - top).mean())))


def _gain(moves: FloatArray, pv: FloatArray, tried: Sequence[LikelyProcess]) -> float:
    """Return the log likelihood of PV (n,) behind what moves it (n,), less that of one that nothing moves.

    It is without what free weights take from noise.
    """
    if not np.ptp(moves):
        return 0.0
    found = evidence_of_response(moves, pv, tried)
    return -found.log_ratio - FREE * found.free


def _stems(op: FloatArray, s: float) -> Iterator[FloatArray]:
    """Yield the stem of a valve behind OP (n,), OP units, (n,), for each S, J and rest."""
    for share, ratio in product(SHARES, J_RATIOS):
        bands = FrictionBands.from_s_j(share * s, ratio * share * s)
        for rest in RESTS:
            yield he2007(op, bands.f_s, bands.f_d, float(op[0]) - rest * bands.f_s)

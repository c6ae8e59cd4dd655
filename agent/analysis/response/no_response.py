"""The finding that PV does not respond to OP: how far OP travelled, and what PV would have done.

Two ways lead to it. PV that is exactly constant for long while OP travels is no measurement of a process: no
load cancels a travel of OP to the last digit. Where the noise of PV is alive, the likelihood decides
(``evidence_of_response``): a load that the controller cancels holds PV as well, so the finding needs what a
load does not do, an OP that moves by itself (steps of the set point, noise that the controller passes on).
See docs/methods/no_response.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.gates.pv import longest_rest
from agent.analysis.gates.record import MIN_SAMPLES
from agent.analysis.record.least_step import op_range_of
from agent.analysis.response.candidates import candidates, known_law
from agent.analysis.response.evidence_of_response import evidence_of_response
from agent.analysis.response.stretches import (
    longest_true,
    longest_within,
    next_stand,
    slow_noise_of,
    smoothed,
    stand_before,
    travelled,
)
from agent.analysis.response.why_not import Standing, near_zero, why_not

if TYPE_CHECKING:
    from collections.abc import Iterator

    from agent.analysis.loop.pi_controller import PiController
    from agent.analysis.record.known_process import KnownProcess
    from agent.analysis.record.recording import FloatArray, LoopWindow
    from agent.analysis.response.candidates import LikelyProcess
    from agent.analysis.response.why_not import NoResponseCause

FAR = 0.05
"""Travel of OP, part of its range, below which nothing is said of a response: five times the resolution that
ISA-75.25 tests, and more than the dead band of most valves that stick."""
LONG = 0.3
"""Part of the record for which PV must stand at least, as for ``pv_frozen``."""
INTEGRAL_TIMES = 5.0
"""Integral times of the controller for which PV must stand: a dead time is shorter (SIMC)."""
STANDS = 0.3
"""Travel of PV over that which OP would have given it, up to which PV stands."""
NOISES = 8.0
"""And besides, its noise: so many standard deviations to both sides together."""
ZERO_SAMPLES = 25
"""Samples of which the median is compared with zero, fewer than ``MIN_SAMPLES``."""
LEAST_PART = 30
"""Samples for which PV stands before and after, at least, where that is compared; a level is fitted to it."""
STARTS = 4
"""Times at which the fault may begin in a stand, evenly spread: PV that responded may stand before it."""
BEFORE = math.log(0.01)
"""Log odds of a loop that does not respond, before its record is looked at: one window in a hundred in which
OP travels far."""
ENOUGH = math.log(9.0)
"""Log odds from which it is stated: nine in ten."""


@dataclass(frozen=True, slots=True)
class NoResponse:
    """PV does not respond to OP."""

    cause: NoResponseCause
    begin: int
    end: int
    """Samples of the record between which it does not respond."""
    level: float
    """Where PV stands, PV units."""
    op_travel: float
    """Travel of OP meanwhile, OP units."""
    op_spans: float
    """The same over the range of OP."""
    expected: float | None
    """Span that OP would have given PV, PV units; None: nothing is known of the process."""
    deviations: float | None
    """The same in standard deviations of what PV does by itself; None likewise, or PV is exactly constant."""
    probability: float
    """That PV does not respond."""


class _Found(NamedTuple):
    begin: int
    end: int
    exact: bool
    log_odds: float
    expected: float | None
    deviations: float | None
    tried: tuple[LikelyProcess, ...]


def no_response(window: LoopWindow) -> NoResponse | None:
    """Return the finding; None where PV responds, where that is not certain, and where OP hardly moves.

    Args:
        window: The record; its hints have the process where other windows showed it.
    """
    known = window.hints.known
    valid = window.valid
    if np.count_nonzero(valid) < MIN_SAMPLES:
        return None
    low, high = op_range_of(window)
    span = high - low
    if span <= 0 or travelled(window.op[valid]) < FAR * span:
        return None
    ways = (_constant, _at_zero, _by_likelihood)
    found = next((each for way in ways if (each := way(window, span, known)) is not None), None)
    if found is None:
        return None
    here = slice(found.begin, found.end)
    op = window.op[here][valid[here]]
    standing = Standing(window.pv, found.begin, found.end, found.exact, _wanted(op, found.tried))
    return NoResponse(
        why_not(standing),
        found.begin,
        found.end,
        standing.level,
        travelled(op),
        travelled(op) / span,
        found.expected,
        found.deviations,
        1 / (1 + math.exp(-found.log_odds)),
    )


def _constant(window: LoopWindow, span: float, known: KnownProcess | None) -> _Found | None:
    """Return a stretch in which PV is exactly constant while OP travels far."""
    places = np.flatnonzero(window.valid)
    pv = window.pv[places]
    stretch = places[longest_rest(pv)]
    begin, end = int(stretch[0]), int(stretch[-1]) + 1
    law = known_law(window, slice(begin, end))
    least = _least_samples(window, law)
    op = window.op[stretch]
    far = np.flatnonzero(np.abs(op - op[0]) >= FAR * span)
    if len(op) < least or not far.size or len(op) - far[0] < 0.5 * least:
        return None  # a dead time may pass
    tried = candidates(window, known, law)
    travel = travelled(op)
    expected = min((abs(each.gain) * travel for each in tried if each.tau is not None), default=None)
    steps = np.diff(np.unique(pv))
    if steps.size and expected is not None and expected < 3 * float(steps.min()):
        return None  # the converter would not show it
    return _Found(begin, end, True, -BEFORE, expected, None, tried)


def _at_zero(window: LoopWindow, span: float, known: KnownProcess | None) -> _Found | None:
    """Return a stretch in which PV is at zero although OP pulled it up by far, before or meanwhile.

    Loads do not hold PV there; a valve that the controller closed does, and then OP went the other way.
    """
    whole = longest_true(window.valid)
    if whole.stop - whole.start < MIN_SAMPLES:
        return None
    mostly = smoothed(window.pv, ZERO_SAMPLES)  # noise that is cut off at zero leaves it sample by sample
    here = longest_true(near_zero(mostly, slow_noise_of(window.pv[whole])) & window.valid)
    law = known_law(window, here)
    tried = candidates(window, known, law)
    least = _least_samples(window, law)
    if here.stop - here.start < max(least, MIN_SAMPLES) or not tried:
        return None
    pull = np.sign(tried[0].gain) * window.op
    before = pull[max(0, here.start - int(least)) : here.stop]
    lowest = int(np.nanargmin(before)) + max(0, here.start - int(least))
    far = np.flatnonzero(pull[lowest : here.stop] >= pull[lowest] + FAR * span)
    if not far.size or here.stop - (lowest + far[0]) < 0.5 * least:
        return None
    travel = travelled(window.op[lowest : here.stop][np.isfinite(window.op[lowest : here.stop])])
    expected = min(_response(each, travel, here.stop - lowest) for each in tried)
    return _Found(min(here.start, lowest), here.stop, False, -BEFORE, expected, None, tried)


def _by_likelihood(window: LoopWindow, span: float, known: KnownProcess | None) -> _Found | None:
    """Return the first of the longest stretches with live noise in which PV likely does not respond."""
    whole = longest_true(window.valid)
    if whole.stop - whole.start < MIN_SAMPLES:
        return None
    smooth = smoothed(window.pv[whole])
    noise = slow_noise_of(window.pv[whole])
    law = known_law(window, whole)
    # A load that wanders behind an integrator is not the noise of these models: they accused sound loops.
    tried = tuple(each for each in candidates(window, known, law) if each.tau is not None)
    if not tried:
        return None
    would = min(_response(each, FAR * span, len(smooth)) for each in tried)
    least = max(MIN_SAMPLES, _least_samples(window, law))
    op, pv = window.op[whole], window.pv[whole]
    for band in (NOISES * noise, NOISES * noise + STANDS * would):
        for parts, price in _parts(smooth, longest_within(smooth, band), NOISES * noise, least):
            begin, end = whole.start + parts[0].start, whole.start + parts[0].stop
            if travelled(op[parts[0]]) < FAR * span:
                continue
            says = evidence_of_response(op, pv, tried, parts, ENOUGH - BEFORE + price)
            log_odds = min(BEFORE + says.log_ratio - price, -BEFORE)
            if log_odds >= ENOUGH:
                return _Found(begin, end, False, log_odds, says.expected, says.deviations, tried)
    return None


def _parts(
    smooth: FloatArray, stands: slice, band: float, least: float
) -> Iterator[tuple[tuple[slice, ...], float]]:
    """Yield where PV stands, with the price in nats of having looked for it.

    The whole stand comes first, then with where PV stands before and after, then its later parts.
    """
    spare = stands.stop - stands.start - math.ceil(least)
    if spare < 0:
        return
    yield (stands,), 0.0
    around = stand_before(smooth, stands, band), next_stand(smooth, stands, band)
    long = [each for each in around if each.stop - each.start >= LEAST_PART]
    if long:
        yield (stands, *long), 0.0
    if spare >= STARTS:
        for k in range(1, STARTS):
            yield (slice(stands.start + k * spare // (STARTS - 1), stands.stop),), math.log(STARTS)


def _response(process: LikelyProcess, travel: float, samples: int) -> float:
    """Return what a travel of OP gives PV in the end, PV units; where it integrates, within the record."""
    return abs(process.gain) * travel * (samples if process.tau is None else 1.0)


def _least_samples(window: LoopWindow, law: PiController | None) -> float:
    share = LONG * len(window)
    return share if law is None else max(share, INTEGRAL_TIMES * law.kc / law.ki)


def _wanted(op: FloatArray, tried: tuple[LikelyProcess, ...]) -> float:
    """Return to which side OP pulled PV at last, 1 or -1; 0: the sign of the gain is not known."""
    if not tried:
        return 0.0
    return float(np.sign(tried[0].gain) * np.sign(op[-1] - np.mean(op)))

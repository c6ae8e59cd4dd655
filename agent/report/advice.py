"""What to do next about a loop, in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.report.parts.no_response_words import CHECKS

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.results import StictionClass, StictionEstimate

RECORD_AGAIN = (
    "record the loop again: in automatic mode, with OP between its limits and the raw value of every scan"
)
REPAIRS: dict[StictionClass, str] = {
    "weak": "repair can wait: less integral action makes the oscillation slower, only a repair ends it",
    "dead_band": "check linkage, shaft and plug for play, then the dead band of the positioner",
    "stick_slip": "check the packing (too tight, dried out), then the positioner and the air supply",
    "dead_band_stick_slip": "check the packing (too tight, dried out), the linkage and the positioner",
}
TRIALS = "1, 2, 5 and 10 % of its range"
"""Steps of a bump test where nothing is known of S, after ISA-75.25."""


def advice(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return what to do, the most useful first."""
    verdict, found, oscillation = diagnosis.verdict, diagnosis.quantification, diagnosis.oscillation
    if diagnosis.no_response is not None and verdict != "stiction":
        return (CHECKS[diagnosis.no_response.cause],)
    if verdict == "not_testable":
        return (RECORD_AGAIN,)
    causes = {each.cause for each in diagnosis.causes}
    words = []
    if verdict in ("stiction", "undecided"):
        step = 0.0 if diagnosis.record is None else diagnosis.record.least_step
        words.append(bump_test(None if found is None else found.stiction, step))
    if diagnosis.stiction_class is not None:
        words.append(REPAIRS[diagnosis.stiction_class])
    if "tight_tuning" in causes:
        words.append("halve the gain of the controller and check whether the oscillation decays")
    if "external_disturbance" in causes:
        period = oscillation.period if oscillation is not None else None
        swing = "" if period is None else f" that oscillate with a period of {period:.4g} s"
        words.append(
            f"look upstream for loops and machines{swing}; the one that leads in phase is the nearest"
        )
    return tuple(words)


def bump_test(stiction: StictionEstimate | None, least_step: float = 0.0) -> str:
    """Return the steps of a bump test: a valve responds to a reversal only beyond S (ISA-75.25).

    Args:
        stiction: How much the valve sticks; None: not known.
        least_step: Smallest step that can be made, OP units. A test with a smaller one is not proposed.
    """
    start = "bump test (ISA-75.25), in manual mode: step OP in one direction until PV responds, then back by"
    if stiction is None or stiction.s.value <= 0:
        return f"{start} {TRIALS}"
    low = stiction.s.low or stiction.s.value
    high = stiction.s.value if stiction.s.high is None else stiction.s.high
    if 1.5 * high < least_step:
        return (
            f"no bump test: S is at most {high:.3g} OP units, steps below {least_step:.3g} are not resolved; "
            "compare the position of the stem with OP at the valve"
        )
    if low / 2 < least_step:
        return f"{start} {1.5 * high:.3g}: a valve that sticks does not respond before"
    return f"{start} {low / 2:.3g} (a sticking valve does not respond), then by {1.5 * high:.3g} in total"

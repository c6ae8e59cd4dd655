"""What to do next about a loop, in plain words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.analysis.stiction_class import stiction_class
from agent.units import FrictionBands

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import Cause, Oscillation, StictionClass, StictionEstimate, Verdict

REPAIRS: dict[StictionClass, str] = {
    "weak": "it may wait: less integral action makes the swing slower, a repair ends it",
    "dead_band": "look for slack in linkage, shaft and plug, then at the positioner's dead band",
    "stick_slip": "look at the packing (too tight, dried out), then at positioner and air supply",
    "dead_band_stick_slip": "look at the packing (too tight, dried out), at the linkage and the positioner",
}
TRIALS = "1, 2, 5 and 10 % of its range"
"""Steps of a bump test where nothing is known of S, after ISA-75.25."""


def advice(
    verdict: Verdict,
    causes: Iterable[Cause],
    stiction: StictionEstimate | None,
    oscillation: Oscillation,
    window: LoopWindow,
) -> tuple[str, ...]:
    """Return what to do, the most useful first.

    Args:
        verdict: On the valve.
        causes: Of the oscillation.
        stiction: What was found of it, also where the verdict is not `stiction`.
        oscillation: Of the loop.
        window: The record.
    """
    if verdict == "not_testable":
        return ("take another record: in automatic, OP between its limits, raw values of each scan",)
    words = []
    if verdict in ("stiction", "undecided"):
        words.append(bump_test(stiction))
    if verdict == "stiction" and stiction is not None:
        bands = FrictionBands(stiction.f_s.value, stiction.f_d.value)
        words.append(REPAIRS[stiction_class(bands, window.op_span)])
    if "tight_tuning" in causes:
        words.append("halve the controller's gain and see whether the swing dies out")
    if "external_disturbance" in causes:
        period = "" if oscillation.period is None else f" that swing with {oscillation.period:.4g} s"
        words.append(
            f"look upstream for loops and machines{period}; the one that leads in phase is the nearest"
        )
    return tuple(words)


def bump_test(stiction: StictionEstimate | None) -> str:
    """Return how large its steps should be: a valve answers a reversal only beyond S (ISA-75.25)."""
    start = "bump test (ISA-75.25), in manual: step OP one way until PV answers, then back"
    if stiction is None or stiction.s.value <= 0:
        return f"{start} by {TRIALS}"
    low = stiction.s.low or stiction.s.value
    high = stiction.s.value if stiction.s.high is None else stiction.s.high
    return f"{start} by {low / 2:.3g}, which PV does not answer if it sticks, then by {1.5 * high:.3g} in all"

"""Dead time behind a sample-and-hold: which held positions act on PV from one sample to the next.

A position is set at a sample, just after PV was measured there, and held to the next. The delay
D = whole + part counts this hold (samples, D >= 1). From sample t - 1 to t the process sees
position(t - whole - 1) for the first ``part`` of the way and position(t - whole) for the rest: y(t) depends
first on position(t - whole). Source: Astrom and Wittenmark, Computer-Controlled Systems (3rd ed., 1997),
chapter 2, sampling a system with time delay.
"""

from __future__ import annotations

from agent.jit import kernel


@kernel
def split_delay(delay: float) -> tuple[int, float]:
    """Return the whole samples of a delay and the remaining part, 0 <= part < 1."""
    whole = int(delay)
    return whole, delay - whole

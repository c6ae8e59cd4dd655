"""Where the log odds of windows lie in valves that stick and in sound ones, and how far they scatter.

Made by ``python -m benchmarks memory_rates``, never on recordings: 40 valves in a simulated week (seeds 92001
to 92040) and 60 in six weeks (92141 to 92200), two of five stick and half move seldom; and 346 loops that
move in each window.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Middles:
    """Of the valves of one kind: a normal distribution of log odds."""

    mean: float
    sd: float


SOUND = Middles(mean=-2.02, sd=0.34)
"""Middles of sound valves."""
MOST_RISE = 13.72
"""By how much the middle is higher at most in valves that stick: each rise up to it is as probable."""
STUCK = ((0.093, 5.49), (0.012, 8.2))
"""Parameters of the Beta distribution of a valve's part of windows with the outcome ``stuck``, where it
sticks and where it is sound: of 20 valves (92001 to 92020), and none of 160 (``no_response``)."""
SCATTERS: Mapping[float, float] = {0.35: 0.147, 0.7: 0.456, 1.4: 0.323, 2.8: 0.073}
"""Standard deviation of the log odds of windows about the middle of their valve, and its share of the valves.
It is alike in both kinds: how much windows differ says nothing of the valve by itself."""
MIMICS = 0.022
"""Part of the sound valves whose windows look like those of a valve that sticks, all of them: something that
the models lack passes for friction every day. One of 50 in ``benchmarks.one_valve``, half of which have
something that the models lack, one of 20 in earlier weeks, and none of 60 in these; with Jeffreys' prior."""
HIDDEN = 0.100
"""Part of the valves that stick whose windows are those of a sound one, all of them: OP moves less than S, or
noise and loads hide what a slip does to PV. Three of 37 in these weeks, by their likelihood."""

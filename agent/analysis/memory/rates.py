"""Rates with which windows have which outcome: Dirichlet parameters, for sticking and for sound valves.

Made by ``python -m benchmarks memory_rates``, never on recordings: 40 valves in simulated weeks (seeds 92001
to 92040, each second of 28 windows in seven days), half of which move seldom, together with the calibration
of the log odds of a window on 346 loops that move in each window.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.memory.outcome import Outcome

STICKS: Mapping[Outcome, float] = {
    "against": 0.474,
    "hardly": 0.298,
    "weak": 0.306,
    "fair": 0.526,
    "strong": 1.129,
    "very_strong": 2.760,
    "stuck": 0.093,
}
SOUND: Mapping[Outcome, float] = {
    "against": 4.970,
    "hardly": 1.790,
    "weak": 0.735,
    "fair": 0.357,
    "strong": 0.250,
    "very_strong": 0.123,
    "stuck": 0.012,
}
MIMICS = 0.030
"""Part of the sound valves whose windows look like those of a valve that sticks, all of them: something that
the models lack passes for friction every day. One of 50 in ``benchmarks.one_valve``, half of which have
something that the models lack, one of 20 in earlier weeks, and none of 20 in these; with Jeffreys' prior."""
HIDDEN = 0.260
"""Part of the valves that stick whose windows look like those of a sound one, all of them: OP moves less than
S, or noise and loads hide what a slip does to PV. Five of 20 in these weeks, by their likelihood. Their true
stem shows no more: docs/methods/memory.md."""

"""Rates with which windows have which outcome: Dirichlet parameters, for sticking and for sound valves.

Made by ``python -m benchmarks memory_rates``, never on recordings. How often valves have an outcome, and how
alike the windows of one are (the sum), come from simulated weeks of 40 valves (even seeds, six windows
each); how many of those with an outcome stick, from the calibration of the log odds of a window on 346 loops.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.memory.outcome import Outcome

STICKS: Mapping[Outcome, float] = {
    "against": 0.070,
    "hardly": 0.026,
    "weak": 0.035,
    "fair": 0.109,
    "strong": 0.096,
    "very_strong": 0.475,
    "stuck": 0.058,
}
SOUND: Mapping[Outcome, float] = {
    "against": 1.459,
    "hardly": 0.316,
    "weak": 0.172,
    "fair": 0.153,
    "strong": 0.024,
    "very_strong": 0.023,
    "stuck": 0.017,
}
MIMICS = 0.025
"""Part of the sound valves whose windows look like those of a valve that sticks, all of them: something that
the models lack passes for friction every day. One of 58 simulated sound valves does, half of them with
something that the models lack (30 and 20 of ``benchmarks.one_valve``, 8 of ``memory_rates``); with Jeffreys'
prior that is 1.5 of 59."""

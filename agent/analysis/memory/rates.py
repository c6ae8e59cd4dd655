"""Rates with which windows have which outcome: Dirichlet parameters, for sticking and for sound valves.

Fitted by ``python -m benchmarks memory_rates`` on simulated weeks (``simulators.draws.valve_weeks``, even
seeds 0 to 14, 16 valves with six windows), never on recordings.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.memory.outcome import Outcome

STICKS: Mapping[Outcome, float] = {
    "against": 0.112,
    "hardly": 0.150,
    "weak": 0.363,
    "fair": 0.440,
    "strong": 0.380,
    "very_strong": 1.064,
    "stuck": 0.061,
}
SOUND: Mapping[Outcome, float] = {
    "against": 14.935,
    "hardly": 4.312,
    "weak": 0.458,
    "fair": 0.458,
    "strong": 0.458,
    "very_strong": 0.458,
    "stuck": 0.458,
}
MIMICS = 0.025
"""Part of the sound valves whose windows look like those of a valve that sticks, all of them: something that
the models lack passes for friction every day. One of 58 simulated sound valves does, half of them with
something that the models lack (30 and 20 of ``benchmarks.one_valve``, 8 of ``memory_rates``); with Jeffreys'
prior that is 1.5 of 59."""

"""Rates with which windows have which outcome: Dirichlet parameters, for sticking and for sound valves.

Made by ``python -m benchmarks memory_rates``, never on recordings: 40 valves in simulated weeks (even seeds,
six windows each), half of which move seldom, together with the calibration of the log odds of a window on 346
loops that move in each window. The search of ``free_run`` was that of decision 57; rates learnt with the
present one are no better on fresh valves (decision 79).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.memory.outcome import Outcome

STICKS: Mapping[Outcome, float] = {
    "against": 0.215,
    "hardly": 0.047,
    "weak": 0.085,
    "fair": 0.196,
    "strong": 0.292,
    "very_strong": 0.328,
    "stuck": 0.014,
}
SOUND: Mapping[Outcome, float] = {
    "against": 2.447,
    "hardly": 0.843,
    "weak": 0.253,
    "fair": 0.163,
    "strong": 0.104,
    "very_strong": 0.060,
    "stuck": 0.004,
}
MIMICS = 0.037
"""Part of the sound valves whose windows look like those of a valve that sticks, all of them: something that
the models lack passes for friction every day. One of 50 in ``benchmarks.one_valve``, half of which have
something that the models lack, and one of the weeks; with Jeffreys' prior."""

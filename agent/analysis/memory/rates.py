"""Rates with which windows have which outcome: Dirichlet parameters, for sticking and for sound valves.

Fitted by ``python -m benchmarks memory_rates`` on simulated weeks (``simulators.draws.valve_weeks``, even
seeds), never on recordings. The sum of each says how alike the valves of a kind are: a small one, that the
windows of a valve resemble each other more than those of other valves, so that many say little more than few.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.memory.outcome import Outcome

STICKS: Mapping[Outcome, float] = {
    "quiet": 0.607,
    "against": 0.072,
    "hardly": 0.077,
    "weak": 0.158,
    "fair": 0.180,
    "strong": 0.224,
    "very_strong": 0.548,
    "stuck": 0.040,
}
SOUND: Mapping[Outcome, float] = {
    "quiet": 0.580,
    "against": 1.773,
    "hardly": 0.488,
    "weak": 0.066,
    "fair": 0.066,
    "strong": 0.066,
    "very_strong": 0.066,
    "stuck": 0.066,
}

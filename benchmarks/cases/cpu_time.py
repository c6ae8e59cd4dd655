"""CPU time of one core, in this process."""

from __future__ import annotations

import time
from collections.abc import Callable
from statistics import median

from agent.analysis.diagnose import diagnose
from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import LoopWindow

REPEATS = 3


def seconds(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the median CPU time of ``work`` that was run once before, s."""
    work()
    times = []
    for _ in range(repeats):
        started = time.process_time()
        work()
        times.append(time.process_time() - started)
    return median(times)


def quantifier_seconds(window: LoopWindow, method: str, repeats: int = REPEATS) -> float:
    """Return the median CPU time of a quantifier alone, s."""
    return seconds(lambda: quantifier(method).quantify(window), repeats)


def diagnosis_seconds(window: LoopWindow, method: str, repeats: int = REPEATS) -> float:
    """Return the median CPU time of a whole diagnosis, s."""
    return seconds(lambda: diagnose(window, quantifier=quantifier(method)), repeats)

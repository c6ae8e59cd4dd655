"""The process of a loop as its windows show it: each an opinion with an interval; their middle counts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.known_process import KnownProcess
from agent.analysis.results import NORMAL_90

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.diagnosis import Diagnosis

LEAST_FIT = 50.0
"""Part of the movement of PV that the model must explain before its process is believed, %."""
WIDEST = math.log(3.0)
"""Widest interval of the gain, logarithm of its ends' ratio, that says anything."""
FEWEST = 2
"""Windows that must agree."""
MOST_SCATTER = 0.7
"""Standard deviation of the logarithm of the gain from window to window beyond which they do not agree."""
LEAST_SCATTER = 0.1
"""And below which two windows agree by chance."""


@dataclass(frozen=True, slots=True)
class ProcessSeen:
    """The process of one window."""

    time: float
    """End of the window, s UTC."""
    gain: float
    """As ``KnownProcess.gain``."""
    log_gain_sd: float
    tau: float | None
    """s; all lags together; None: it integrates."""
    delay: float
    """s"""


def process_seen(diagnosis: Diagnosis, time: float) -> ProcessSeen | None:
    """Return the process of a window; None where it does not show it clearly."""
    found = diagnosis.quantification
    if found is None or found.process is None or found.failure is not None:
        return None
    fit = max(found.free_run_percent or 0.0, found.linear_percent or 0.0)
    process, intervals = found.process, found.process.intervals
    if fit < LEAST_FIT or intervals is None or not process.gain:
        return None
    low, high = sorted(abs(each) for each in intervals.gain)
    width = math.log(high / low) if low > 0 and intervals.gain[0] * intervals.gain[1] > 0 else math.inf
    if width > WIDEST:
        return None
    tau = None if process.tau is None else process.tau + (process.tau2 or 0.0)
    return ProcessSeen(time, process.gain, max(width / (2 * NORMAL_90), 0.01), tau, process.delay)


def known_from(seen: Sequence[ProcessSeen], most: float = MOST_SCATTER) -> KnownProcess | None:
    """Return what windows agree on; None where they are too few or do not agree.

    Kind and sign of the gain go by majority, numbers by the median, which one wrong window does not move.
    Their scatter says how sure the gain is: intervals of single windows leave out what all models lack.

    Args:
        seen: Of the newest windows.
        most: Standard deviation of the logarithm of the gain up to which they agree.
    """
    integrates = [each.tau is None for each in seen]
    kind = sum(integrates) > len(integrates) / 2
    same = [each for each in seen if (each.tau is None) == kind]
    sign = math.copysign(1.0, sum(math.copysign(1.0, each.gain) for each in same) or 1.0)
    same = [each for each in same if each.gain * sign > 0]
    if len(same) < FEWEST or 2 * len(same) <= len(seen):
        return None
    logs = np.log([abs(each.gain) for each in same])
    middle = float(np.median(logs))
    scatter = 1.4826 * float(np.median(np.abs(logs - middle)))
    own = float(np.median([each.log_gain_sd for each in same]))
    sd = max(scatter, own, LEAST_SCATTER)
    if sd > most:
        return None
    taus = [each.tau for each in same if each.tau is not None]
    tau = None if kind else float(np.median(taus))
    return KnownProcess(sign * math.exp(middle), tau, float(np.median([each.delay for each in same])), sd)

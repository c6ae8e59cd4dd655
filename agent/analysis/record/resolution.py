"""What a record cannot show of a signal: steps of a converter, bands of an exception report.

A value that is repeated is known to its step only. Taken as it is, it makes errors of nothing: a stem that
stands then explains a held PV perfectly, and one window brings thousands of nats.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray


def resolution(values: FloatArray) -> float:
    """Return the least change from sample to sample, unit of ``values`` (n,); 0 where there is none."""
    changes = np.abs(np.diff(values))
    changes = changes[np.isfinite(changes) & (changes > 0)]
    return float(changes.min()) if changes.size else 0.0


def dithered(values: FloatArray) -> FloatArray:
    """Return ``values`` (n,) with even noise of one step: errors are then no smaller than what is known.

    The noise is the same for the same number of samples, so that a record gives the same answer again.
    """
    return values + resolution(values) * np.random.default_rng(0).uniform(-0.5, 0.5, len(values))

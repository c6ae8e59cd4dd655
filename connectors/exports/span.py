"""What a user states about loops that were read: a span of time, words of the mode."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions, RecordedLoop


def stated(loop: RecordedLoop, options: ReadOptions) -> RecordedLoop:
    """Return a loop with the words of its mode and within the span that the user states.

    Raises:
        RecordingError: It has no sample in the span.
    """
    known = replace(loop, modes=options.modes) if options.modes else loop
    return known if options.span is None else within(known, *options.span)


def within(loop: RecordedLoop, start: float, end: float) -> RecordedLoop:
    """Return what was recorded from ``start`` up to ``end``, which does not count, s UTC.

    Raises:
        RecordingError: Nothing was.
    """
    kept = slice(*np.searchsorted(loop.time, (start, end)).tolist())
    if not loop.time[kept].size:
        raise RecordingError(f"{loop.path}: {loop.name} has no sample in the span")
    return replace(
        loop,
        time=loop.time[kept],
        op=loop.op[kept],
        pv=loop.pv[kept],
        sp=None if loop.sp is None else loop.sp[kept],
        mv=None if loop.mv is None else loop.mv[kept],
        mode=None if loop.mode is None else loop.mode[kept],
    )

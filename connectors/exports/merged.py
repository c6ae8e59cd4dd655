"""Series of the roles of one loop as one recording."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from connectors.exports.fault import RecordingError
from connectors.exports.recorded import RecordedLoop
from connectors.exports.series import Series, on_common_times

if TYPE_CHECKING:
    from connectors.exports.cells.times import Times
    from connectors.exports.tables.sheet import FloatArray, Sheet

MOST_CUT_OFF = 0.3
"""Share of samples, other than the one before at the same time, from which the times are too coarse."""
FEWEST = 20
"""Samples from which that share says anything."""
SUMMER_TIME = (3540.0, 3660.0)
"""Step back of local time when summer time ends, s; half an hour of Lord Howe Island is not known."""


def merged(
    sheet: Sheet,
    name: str,
    series: Mapping[str, Series],
    tags: Mapping[str, str],
    bad: int,
    times: Times | None,
) -> RecordedLoop:
    """Return the recording on the times of PV.

    Raises:
        RecordingError: Times of a role run backward.
    """
    for role, each in series.items():
        _rises(sheet, role, each, times)
    values = on_common_times(series)
    time = series["pv"].time
    if not time.size:
        raise RecordingError(f"{sheet.path}: {name} has no sample of PV")
    keep = np.concatenate(([True], np.diff(time) > 0))
    _refuse_coarse_times(sheet, name, time, keep, values["op"], values["pv"])
    words = series["mode"].words if "mode" in series else ()
    return RecordedLoop(
        name=name,
        path=sheet.path,
        time=np.ascontiguousarray(time[keep]),
        op=values["op"][keep],
        pv=values["pv"][keep],
        sp=values["sp"][keep] if "sp" in values else None,
        mv=values["mv"][keep] if "mv" in values else None,
        mode=tuple(_word(words, index) for index in values["mode"][keep].tolist())
        if "mode" in values
        else None,
        duplicates=int(np.count_nonzero(~keep)),
        tags=dict(tags),
        bad=bad,
    )


def _refuse_coarse_times(
    sheet: Sheet, name: str, time: FloatArray, keep: NDArray[np.bool_], op: FloatArray, pv: FloatArray
) -> None:
    """Raise RecordingError where many samples share a time although they differ: its digits were cut off."""
    first = np.maximum.accumulate(np.where(keep, np.arange(len(time)), 0))
    differ = ~keep & ((op != op[first]) | (pv != pv[first])) & np.isfinite(op) & np.isfinite(pv)
    if len(time) < FEWEST or np.count_nonzero(differ) < MOST_CUT_OFF * len(time):
        return
    places = int(np.count_nonzero(keep))
    step = (time[-1] - time[0]) / max(places - 1, 1) * places / len(time)
    hint = f"--ts {step:.3g}, if they are evenly spaced" if step > 0 else "--ts SECONDS"
    raise RecordingError(
        f"{sheet.path}: {len(time)} samples of {name} have {places} different times, as where seconds or "
        f"their fractions were cut off: export them with the times, or give the sampling time by {hint}"
    )


def _word(words: tuple[str, ...], index: float) -> str:
    return "" if index != index else words[int(index)]  # noqa: PLR0124 - NaN


def _rises(sheet: Sheet, role: str, series: Series, times: Times | None) -> None:
    time = series.time
    backward = np.flatnonzero(np.diff(time) < 0)
    if not backward.size:
        return
    row = int(backward[0]) + 1
    step = time[row - 1] - time[row]
    place = None if series.rows is None else int(series.rows[row])
    where = f"{sheet.path}, sample {row + 1} of {role.upper()}" if place is None else sheet.where(place)
    hint = ""
    if times is not None and not times.stated and times.zone and SUMMER_TIME[0] <= step <= SUMMER_TIME[1]:
        hint = "; it looks like the end of summer time: name the zone by --zone"
    raise RecordingError(f"{where}: time runs backward by {step:g} s, expected rising times{hint}")

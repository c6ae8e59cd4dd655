"""Series of the roles of one loop as one recording."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from connectors.exports.fault import RecordingError
from connectors.exports.recorded import RecordedLoop
from connectors.exports.series import Series, on_common_times

if TYPE_CHECKING:
    from connectors.exports.cells.times import Times
    from connectors.exports.tables.sheet import FloatArray, Sheet

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
        _rises(sheet, role, each.time, times)
    values = on_common_times(series)
    time = series["pv"].time
    if not time.size:
        raise RecordingError(f"{sheet.path}: {name} has no sample of PV")
    keep = np.concatenate(([True], np.diff(time) > 0))
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


def _word(words: tuple[str, ...], index: float) -> str:
    return "" if index != index else words[int(index)]  # noqa: PLR0124 - NaN


def _rises(sheet: Sheet, role: str, time: FloatArray, times: Times | None) -> None:
    backward = np.flatnonzero(np.diff(time) < 0)
    if not backward.size:
        return
    row = int(backward[0]) + 1
    step = time[row - 1] - time[row]
    where = (
        sheet.where(row)
        if len(sheet.lines) == len(time)
        else f"{sheet.path}, sample {row + 1} of {role.upper()}"
    )
    hint = ""
    if times is not None and not times.stated and times.zone and SUMMER_TIME[0] <= step <= SUMMER_TIME[1]:
        hint = "; it looks like the end of summer time: name the zone by --zone"
    raise RecordingError(f"{where}: time runs backward by {step:g} s, expected rising times{hint}")

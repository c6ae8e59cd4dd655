"""A finding as JSON and back: a survey keeps thousands on disk until all are ranked."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from agent.analysis.data_quality import DataQuality
from agent.analysis.results import IntervalEstimate
from agent.report.fleet.rows import RecordFinding
from agent.report.fleet.thumbnail import Thumbnail

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.analysis.record.recording import FloatArray

DIGITS = 5
"""Of a value in a small picture, 64 px high."""


def finding_json(finding: RecordFinding) -> dict[str, object]:
    """Return a finding as JSON."""
    found = asdict(finding)
    small = finding.thumbnail
    if small is not None:
        found["thumbnail"] |= {"op": _short(small.op), "pv": _short(small.pv)}
    return _without_nan(found)


def finding_from(stored: Mapping[str, Any]) -> RecordFinding:
    """Return the finding of which ``stored`` is the JSON."""
    s, small, quality = stored["s"], stored["thumbnail"], stored["quality"]
    return RecordFinding(
        **{
            **stored,
            "s": None if s is None else IntervalEstimate(**s),
            "quality": DataQuality(**{**quality, "flaws": tuple(quality["flaws"])}),
            "thumbnail": None if small is None else _picture(small),
        }
    )


def _picture(small: Mapping[str, Any]) -> Thumbnail:
    return Thumbnail(small["start"], small["end"], _values(small["op"]), _values(small["pv"]))


def _short(values: FloatArray) -> list[float | None]:
    return [float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None for value in values.tolist()]


def _values(stored: list[float | None]) -> FloatArray:
    return np.array([np.nan if value is None else value for value in stored], np.float64)


def _without_nan(found: dict[str, Any]) -> dict[str, object]:
    """Return it with null in place of numbers that JSON does not have."""
    return {
        key: _without_nan(value)
        if isinstance(value, dict)
        else None
        if isinstance(value, float) and not np.isfinite(value)
        else value
        for key, value in found.items()
    }

"""What was understood of a file: loops, columns, sampling time, gaps, and what is missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.compression import DESTROYS, compression_factor
from agent.counted import counted
from agent.durations import duration_words

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import LoopWindow


WISHED = {
    "SP": "no set point: whether it moved is not seen",
    "mode": "no mode: stretches in manual are not cut out",
}
"""Columns that may be absent -> what is lost without them."""


@dataclass(frozen=True, slots=True)
class LoopSummary:
    """One loop of a file."""

    loop: str
    columns: dict[str, str]
    """Role -> column or tag that it was read from."""
    ts: float
    """Sampling time, s."""
    samples: int
    """On the uniform grid, gaps included."""
    start: str | None
    """First time, ISO 8601 UTC; None where times count from an unknown start."""
    gaps: int
    """Stretches in which OP or PV is missing."""
    missing: int
    """Samples in them."""
    bad: int
    """Values that are no number, or whose quality forbids their use."""
    compression: float | None
    """Factor by which the historian compressed PV; None where it cannot be estimated."""
    manual_percent: float | None = None
    """Share of the samples that were not in automatic, %; None where the mode is not known."""
    unknown_modes: tuple[str, ...] = ()
    """Modes of which no table knows whether they are automatic."""


def loop_summary(window: LoopWindow, columns: dict[str, str], bad: int, *, dated: bool) -> LoopSummary:
    """Return the summary of a loop.

    Args:
        window: The recording on its grid.
        columns: Role -> column or tag.
        bad: Values that were rejected.
        dated: Whether its times are dates.
    """
    automatic = window.automatic
    lost = ~window.valid if automatic is None else ~window.valid & automatic
    return LoopSummary(
        loop=window.loop,
        columns=columns,
        ts=window.ts,
        samples=len(window),
        start=_iso(window.start) if dated else None,
        gaps=_stretches(lost),
        missing=int(np.count_nonzero(lost)),
        bad=bad,
        compression=_rounded(compression_factor(window.pv)),
        manual_percent=None if automatic is None else float(round(100 * np.mean(~automatic), 1)),
        unknown_modes=window.unknown_modes,
    )


def _iso(seconds: float) -> str:
    moment = datetime.fromtimestamp(round(seconds, 3), UTC)
    form = "milliseconds" if moment.microsecond else "seconds"
    return moment.isoformat(timespec=form).replace("+00:00", "Z")


def _stretches(lost: NDArray[np.bool_]) -> int:
    edges = np.diff(np.concatenate(([0], lost.astype(np.int8))))
    return int(np.count_nonzero(edges == 1))


def _rounded(factor: float | None) -> float | None:
    return None if factor is None else round(factor, 2)


def problems_of(summaries: Sequence[LoopSummary]) -> list[str]:
    """Return a line for each loop that a historian has spoilt, or that was not always in automatic."""
    spoilt = [
        f"{each.loop}: PV was compressed by about {each.compression:.0f}: lines between few points "
        "hide stiction; export raw values"
        for each in summaries
        if each.compression is not None and each.compression >= DESTROYS
    ]
    manual = [
        f"{each.loop}: not in automatic for {each.manual_percent:g} % of the record, which is cut out"
        for each in summaries
        if each.manual_percent
    ]
    unknown = [
        f"{each.loop}: mode {mode} is not known, so it is taken for manual; "
        f"--modes {mode}=automatic if it is automatic"
        for each in summaries
        for mode in each.unknown_modes
    ]
    return spoilt + manual + unknown


def absent_words(summaries: Sequence[LoopSummary]) -> list[str]:
    """Return a line for each column that no loop has and a verdict is better with."""
    there = {role for each in summaries for role in each.columns}
    return [words for role, words in WISHED.items() if role not in there] if summaries else []


def summary_json(
    file: str, layout: str, zone: str, summaries: Sequence[LoopSummary], problems: Sequence[str]
) -> dict[str, object]:
    """Return the object of ``slipjump import --preview --json``."""
    return {
        "file": file,
        "format": layout,
        "zone": zone or None,
        "loops": [
            {
                "loop": each.loop,
                "columns": each.columns,
                "ts": each.ts,
                "samples": each.samples,
                "start": each.start,
                "gaps": each.gaps,
                "missing": each.missing,
                "bad": each.bad,
                "compression": each.compression,
                "manual_percent": each.manual_percent,
            }
            for each in summaries
        ],
        "problems": [*problems],
    }


def summary_rows(summaries: Sequence[LoopSummary]) -> list[list[str]]:
    """Return a table of the loops, its header first."""
    header = ["loop", "Ts s", "samples", "lasts", "start", "gaps", "bad", "historian", "PV", "OP", "others"]
    return [header, *(_row(each) for each in summaries)]


def _row(each: LoopSummary) -> list[str]:
    others = " ".join(f"{role}={name}" for role, name in each.columns.items() if role not in {"PV", "OP"})
    gaps = f"{each.gaps} ({counted(each.missing, 'sample')})" if each.gaps else "0"
    factor = each.compression
    raw = "not known" if factor is None else "raw" if factor < DESTROYS else f"compressed {factor:.0f} to 1"
    lasts = duration_words(each.ts * each.samples)
    counts = [f"{each.ts:g}", str(each.samples), lasts, each.start or "not dated", gaps, str(each.bad), raw]
    return [each.loop, *counts, each.columns["PV"], each.columns["OP"], others or "-"]

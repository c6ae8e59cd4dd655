"""A recording on its own times, as a window on a uniform time grid."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from agent.analysis.record.grid import uniform_grid
from agent.analysis.record.mode import automatic_share, unknown_modes
from agent.analysis.record.recording import FloatArray, LoopHints, LoopWindow

NO_HINTS = LoopHints()


class Recorded(Protocol):
    """One recorded loop, as ``connectors.recording.RecordedLoop``; arrays have shape (n,), NaN is a gap."""

    @property
    def name(self) -> str:
        """Name of the loop."""
        ...

    @property
    def time(self) -> FloatArray:
        """Time of each row, s, never decreasing."""
        ...

    @property
    def op(self) -> FloatArray:
        """Controller output, OP units."""
        ...

    @property
    def pv(self) -> FloatArray:
        """Process variable, PV units."""
        ...

    @property
    def sp(self) -> FloatArray | None:
        """Set point, PV units."""
        ...

    @property
    def mv(self) -> FloatArray | None:
        """Measured valve position or flow, its own unit."""
        ...

    @property
    def mode(self) -> Sequence[str] | None:
        """Controller mode of each row; empty where it was not recorded."""
        ...

    @property
    def modes(self) -> Mapping[str, bool]:
        """Words of the mode that the user adds to the table -> whether they mean automatic."""
        ...

    @property
    def duplicates(self) -> int:
        """Rows that were discarded because an earlier row had the same timestamp."""
        ...


def loop_window(loop: Recorded, hints: LoopHints = NO_HINTS) -> LoopWindow:
    """Return the whole recording on a uniform grid.

    Args:
        loop: The recording.
        hints: Prior knowledge about the loop.

    Raises:
        ValueError: The times cannot be put on a grid; the text names the index.
    """
    columns = {"op": loop.op, "pv": loop.pv}
    if loop.sp is not None:
        columns["sp"] = loop.sp
    if loop.mv is not None:
        columns["mv"] = loop.mv
    if loop.mode is not None:
        columns["automatic"] = automatic_share(loop.mode, loop.modes)
    grid = uniform_grid(loop.time, columns)
    automatic = grid.columns.get("automatic")
    return LoopWindow(
        loop=loop.name,
        start=grid.start,
        ts=grid.ts,
        op=grid.columns["op"],
        pv=grid.columns["pv"],
        sp=grid.columns.get("sp"),
        mv=grid.columns.get("mv"),
        automatic=None if automatic is None else automatic != 0,  # a mode that was not recorded is no manual
        unknown_modes=() if loop.mode is None else unknown_modes(set(loop.mode), loop.modes),
        hints=hints,
        duplicates=loop.duplicates + grid.duplicates,
    )

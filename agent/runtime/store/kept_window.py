"""The values of a window of interest, as the history keeps them beside its verdict."""

from __future__ import annotations

import json
import math
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.memory.sticks import is_suspected

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow

COLUMNS = ("op", "pv", "sp", "mv", "automatic")
"""What a window may have, in the order of a recording; ``automatic`` is 1 or 0."""
QUICKLY = 1
"""Level of zlib: the values of instruments shrink as well by the quickest."""


def is_of_interest(diagnosis: Diagnosis, *, alarmed: bool) -> bool:
    """Return whether somebody may want to see the values.

    The valve sticks or is suspected, the window alone says that it sticks, or there is an alarm.

    Args:
        diagnosis: Of the window.
        alarmed: Whether the alarm was active before or after it.
    """
    sticks = diagnosis.verdict == "stiction" or diagnosis.contradicted
    return alarmed or sticks or is_suspected(diagnosis)


@dataclass(frozen=True, slots=True, eq=False)
class KeptWindow:
    """Values on a uniform time grid; NaN where there was no good or uncertain one."""

    start: float
    """Time of the first sample, s UTC."""
    ts: float
    """Sampling time, s."""
    columns: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    """Name (of ``COLUMNS``) -> (n,) values, as the rings hold them; empty where the file had no room."""

    @classmethod
    def of(cls, window: LoopWindow) -> KeptWindow:
        """Return what is kept of a window."""
        columns = {name: getattr(window, name) for name in COLUMNS}
        there = {name: np.asarray(c, dtype=np.float32) for name, c in columns.items() if c is not None}
        return cls(window.start, window.ts, there)

    def __len__(self) -> int:
        """Return the number of samples; 0 where they were lost."""
        return len(self.columns["pv"]) if self.columns else 0

    @property
    def end(self) -> float:
        """Time of the last sample, s UTC."""
        return self.start + self.ts * max(len(self) - 1, 0)

    def without_values(self) -> KeptWindow:
        """Return what remains of a window for which there is no room."""
        return KeptWindow(self.start, self.ts)

    def packed(self) -> bytes:
        """Return the columns as bytes; empty where they were lost."""
        if not self.columns:
            return b""
        names = json.dumps(list(self.columns)).encode()
        values = b"".join(column.astype("<f4").tobytes() for column in self.columns.values())
        return zlib.compress(names + b"\n" + values, QUICKLY)

    @classmethod
    def unpacked(cls, start: float, ts: float, content: bytes) -> KeptWindow:
        """Return the window of which ``packed`` made the bytes."""
        if not content:
            return cls(start, ts)
        head, _, values = zlib.decompress(content).partition(b"\n")
        names = json.loads(head)
        table = np.frombuffer(values, dtype="<f4").reshape(len(names), -1).astype(np.float32)
        return cls(start, ts, dict(zip(names, table, strict=True)))


@dataclass(frozen=True, slots=True)
class ListedWindow:
    """A window that can be read back."""

    loop: str
    end: float
    """Time of its verdict, s UTC."""
    start: float
    """s UTC"""
    ts: float
    """s"""
    samples: int

    @property
    def id(self) -> str:
        """Loop and end: what ``slipjump history --window`` takes."""
        return window_id(self.loop, self.end)


def window_id(loop: str, end: float) -> str:
    """Return the name of a window that ended at ``end``, s UTC."""
    time = np.datetime64(round(1e6 * end), "us") if math.isfinite(end) else end
    return f"{loop}@{str(time).removesuffix('.000000')}Z"

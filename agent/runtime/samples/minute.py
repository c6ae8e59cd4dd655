"""One minute of one loop: gathered sample by sample, then a table by time."""

from __future__ import annotations

import json
import math
from array import array
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from connectors.base import Quality

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from agent.runtime.intake.rows import ValueRows
    from connectors.base import Sample

MINUTE = 60
"""s"""
FINE = 1_000_000
"""Parts of a second to which a time is kept: a database has microseconds."""
GOOD, UNCERTAIN, BAD = range(3)
"""Qualities in order: the worst is the largest."""
NUMBERS = ("op", "pv", "sp", "mv")
"""Roles that are numbers; the mode is text."""


class OpenMinute:
    """What has come in of a minute: nine bytes a sample."""

    __slots__ = ("_modes", "_numbers", "loop", "number", "touched")

    def __init__(self, loop: str, number: int) -> None:
        """Begin the minute ``number`` since 1970."""
        self.loop, self.number = loop, number
        self.touched = -math.inf
        """Monotonic time of the newest arrival, s."""
        self._numbers: dict[str, tuple[array[int], array[float], array[int]]] = {}
        self._modes: list[tuple[int, str, int]] = []

    def put(self, sample: Sample, arrival: float) -> None:
        """Take a sample of this minute that arrived at ``arrival`` (monotonic, s)."""
        self.touched = arrival
        at = min(round((sample.time - self.number * MINUTE) * FINE), MINUTE * FINE - 1)
        role, quality = sample.tag.role, GOOD
        if sample.quality is not Quality.GOOD:
            quality = UNCERTAIN if sample.quality is Quality.UNCERTAIN else BAD
        if role not in NUMBERS:
            self._modes.append((at, str(sample.value), quality))
            return
        held = self._held(role)
        usable = quality != BAD and not isinstance(sample.value, str)
        held[0].append(at)
        held[1].append(float(sample.value) if usable else math.nan)
        held[2].append(quality)

    def take(self, rows: ValueRows, which: slice) -> None:
        """Take some of the rows, all of this minute and good, as ``put`` does one by one."""
        self.touched = float(rows.times.arrivals[which][-1])
        offsets = (rows.times.source[which] - self.number * MINUTE) * FINE
        at = np.minimum(np.rint(offsets).astype(np.int64), MINUTE * FINE - 1).astype(np.int32)
        for role, values, short in zip(rows.roles, rows.values, rows.short[:, 1:], strict=True):
            if role not in NUMBERS:
                pairs = zip(at.tolist(), values[which].tolist(), strict=True)
                self._modes += [(when, str(value), GOOD) for when, value in pairs]
                continue
            held = self._held(role)
            held[0].frombytes(at.tobytes())
            held[1].frombytes(short[which].tobytes())
            held[2].frombytes(bytes(len(at)))

    def _held(self, role: str) -> tuple[array[int], array[float], array[int]]:
        held = self._numbers.get(role)
        if held is None:
            held = self._numbers[role] = array("i"), array("f"), array("b")
        return held

    def table(self) -> Minute:
        """Return all by time; of two values of a role at one time the last counts."""
        times = [np.frombuffer(held[0], dtype=np.int32) for held in self._numbers.values()]
        modes = np.array([at for at, _, _ in self._modes], dtype=np.int32)
        at = np.unique(np.concatenate([*times, modes]))
        columns, quality = {}, np.zeros(len(at), dtype=np.int16)
        for (role, held), when in zip(self._numbers.items(), times, strict=True):
            place = np.searchsorted(at, when)
            values = np.ma.MaskedArray(np.empty(len(at), dtype=np.float32), np.ones(len(at), dtype=np.bool_))
            values[place] = np.frombuffer(held[1], dtype=np.float32)
            columns[role] = values
            np.maximum.at(quality, place, np.frombuffer(held[2], dtype=np.int8))
        texts: list[str | None] = [None] * len(at)
        for place, (_, text, poor) in zip(np.searchsorted(at, modes), self._modes, strict=True):
            texts[place] = text
            quality[place] = max(quality[place], poor)
        return Minute(
            self.loop,
            float(self.number * MINUTE),
            at,
            columns,
            tuple(texts) if self._modes else None,
            quality if quality.any() else None,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Minute:
    """A minute of a loop, by time."""

    loop: str
    start: float
    """s UTC"""
    at: NDArray[np.int32]
    """Source times, microseconds from the start, (n,), ascending."""
    columns: Mapping[str, np.ma.MaskedArray[tuple[int], np.dtype[np.float32]]]
    """Role -> (n,) values; masked where the role was not reported at that time, NaN where it was bad."""
    mode: tuple[str | None, ...] | None
    """(n,) modes as they came; None where the loop has none."""
    quality: NDArray[np.int16] | None
    """(n,) the worst of what was reported then: 0 good, 1 uncertain, 2 bad; None: all was good."""

    def packed(self) -> bytes:
        """Return all but loop and start as bytes."""
        head = {"n": len(self.at), "roles": list(self.columns), "mode": self.mode}
        parts = [json.dumps(head | {"quality": self.quality is not None}).encode(), b"\n"]
        parts.append(self.at.astype("<i4").tobytes())
        for column in self.columns.values():
            parts.append(column.filled(np.nan).astype("<f4").tobytes())
            parts.append(np.ma.getmaskarray(column).tobytes())
        if self.quality is not None:
            parts.append(self.quality.astype("<i2").tobytes())
        return b"".join(parts)

    @classmethod
    def unpacked(cls, loop: str, start: float, content: bytes) -> Minute:
        """Return the minute of which ``packed`` made the bytes."""
        first, _, rest = content.partition(b"\n")
        head = json.loads(first)
        n, place = head["n"], 0

        def taken(kind: str) -> NDArray[np.generic]:
            nonlocal place
            values = np.frombuffer(rest, dtype=kind, count=n, offset=place)
            place += values.nbytes
            return values

        at = taken("<i4").astype(np.int32)
        columns = {}
        for role in head["roles"]:
            values, masked = taken("<f4").astype(np.float32), taken("?").astype(np.bool_)
            columns[role] = np.ma.MaskedArray(values, masked)
        quality = taken("<i2").astype(np.int16) if head["quality"] else None
        mode = None if head["mode"] is None else tuple(head["mode"])
        return cls(loop, start, at, columns, mode, quality)

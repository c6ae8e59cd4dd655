"""Raw samples of one loop as rows of a recording, each role held until it was reported again."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Protocol

import numpy as np

from agent.runtime.samples.minute import FINE, MINUTE, NUMBERS

if TYPE_CHECKING:
    from agent.runtime.samples.minute import Minute
    from agent.runtime.samples.sample_file import SampleGap


class Samples(Protocol):
    """Where minutes lie: the agent's file, or the database."""

    def minutes(self, loop: str, since: float, before: float) -> Iterator[Minute]:
        """Yield the minutes of a loop that begin from ``since`` to before ``before`` (s UTC), by time."""
        ...

    def gaps(self, since: float, before: float) -> tuple[SampleGap, ...]:
        """Return the gaps that overlap that time, of whatever loop."""
        ...


@dataclass(frozen=True, slots=True)
class RecalledRow:
    """What was known of a loop at a time at which one of its roles was reported."""

    time: float
    """s UTC"""
    values: Mapping[str, float]
    """Role -> value; NaN where its quality was bad. A role that is not known yet is not there."""
    mode: str
    """As it came; empty where it is not known."""


def roles_of(samples: Samples, loop: str, since: float, before: float) -> tuple[str, ...]:
    """Return the roles that were reported of a loop, in the order of a recording; ``mode`` is the last."""
    found: set[str] = set()
    for minute in samples.minutes(loop, _minute(since), before):
        found.update(minute.columns)
        if minute.mode is not None:
            found.add("mode")
    return tuple(role for role in (*NUMBERS, "mode") if role in found)


def rows_of(samples: Samples, loop: str, since: float, before: float) -> Iterator[RecalledRow]:
    """Yield what came from ``since`` to before ``before``, s UTC, by source time.

    A role that was not reported at a time has not changed since it was; behind a gap nothing is known until
    it is reported again.
    """
    gaps = samples.gaps(since, before)
    values: dict[str, float] = {}
    mode, last = "", -math.inf
    for start, same in groupby(samples.minutes(loop, _minute(since), before), lambda each: each.start):
        if any(gap.since < start and gap.until > last for gap in gaps):
            values, mode = {}, ""
        last = start
        minutes = tuple(same)
        for at in np.unique(np.concatenate([each.at for each in minutes])).tolist():
            for minute in minutes:
                mode = _taken(minute, at, values) or mode
            time = start + at / FINE
            if since <= time < before:
                yield RecalledRow(time, dict(values), mode)


def _taken(minute: Minute, at: int, values: dict[str, float]) -> str:
    """Put what was reported at a time of a minute into ``values``; return the mode, else nothing."""
    place = int(np.searchsorted(minute.at, at))
    if place == len(minute.at) or minute.at[place] != at:
        return ""
    for role, column in minute.columns.items():
        if not np.ma.getmaskarray(column)[place]:
            values[role] = float(column.data[place])
    return "" if minute.mode is None else minute.mode[place] or ""


def _minute(time: float) -> float:
    """Return the start of the minute of a time."""
    return time if math.isinf(time) else MINUTE * math.floor(time / MINUTE)

"""Where the rows of a loop come from: a simulated plant or a recording."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import count
from typing import TYPE_CHECKING, Protocol

import numpy as np

from simulators.plant import Row, rows

if TYPE_CHECKING:
    from connectors.recording import RecordedLoop
    from simulators.scenario import Scenario

FOR_EVER = 1e10
"""Duration that nobody sees the end of, s."""


class Source(Protocol):
    """A loop that can be played."""

    @property
    def loop(self) -> str:
        """Name of the loop."""
        ...

    @property
    def ts(self) -> float:
        """Sampling time, s."""
        ...

    def rows(self) -> Iterator[Row]:
        """All rows from the first on, in order of time."""
        ...


class PlantSource:
    """A simulated loop."""

    def __init__(self, scenario: Scenario) -> None:
        self._scenario = scenario

    @property
    def loop(self) -> str:
        """Name of the loop."""
        return self._scenario.loop

    @property
    def ts(self) -> float:
        """Sampling time, s."""
        return self._scenario.ts

    def rows(self) -> Iterator[Row]:
        """All rows from the first on; each call starts the plant anew."""
        return rows(self._scenario)


class EndlessSource:
    """A simulated loop that goes on for ever, from a time of its own.

    A scenario without events goes on; one with set-point steps, load steps or changes of gain begins anew
    when its duration is over, each time with other noise.
    """

    def __init__(self, scenario: Scenario, start: float) -> None:
        """Make it.

        Args:
            scenario: The loop.
            start: Time of the first row, s UTC.
        """
        self._scenario = scenario.model_copy(update={"start": start})

    @property
    def loop(self) -> str:
        """Name of the loop."""
        return self._scenario.loop

    @property
    def ts(self) -> float:
        """Sampling time, s."""
        return self._scenario.ts

    def rows(self) -> Iterator[Row]:
        """All rows from the first on, without end."""
        once = self._scenario
        if not (once.set_points or once.load_steps or once.gain_steps):
            yield from rows(once.model_copy(update={"duration": FOR_EVER}))
            return
        length = once.samples * once.ts
        for run in count():
            yield from rows(
                once.model_copy(update={"start": once.start + run * length, "seed": once.seed + run})
            )


class RecordingSource:
    """A recorded loop, with the gaps it has."""

    def __init__(self, recording: RecordedLoop) -> None:
        self._recording = recording

    @property
    def loop(self) -> str:
        """Name of the loop."""
        return self._recording.name

    @property
    def ts(self) -> float:
        """Median distance of the samples, s; 1 where there is but one."""
        time = self._recording.time
        return float(np.median(np.diff(time))) if time.size > 1 else 1.0

    def rows(self) -> Iterator[Row]:
        """All rows from the first on; only the roles that were recorded.

        One more row follows the last: its numbers are unknown, because the recording ends there. On a bus
        that reports changes only, it shows a reader that the last values held to the end.
        """
        recording = self._recording
        columns = {"pv": recording.pv, "op": recording.op, "sp": recording.sp, "mv": recording.mv}
        for i, time in enumerate(recording.time):
            values: dict[str, float | str] = {
                role: float(column[i]) for role, column in columns.items() if column is not None
            }
            if recording.mode is not None:
                values["mode"] = recording.mode[i]
            yield Row(float(time), values)
        if recording.time.size:
            ended: dict[str, float | str] = {
                role: math.nan for role, column in columns.items() if column is not None
            }
            if recording.mode is not None:
                ended["mode"] = recording.mode[-1]
            yield Row(float(recording.time[-1]) + self.ts, ended)

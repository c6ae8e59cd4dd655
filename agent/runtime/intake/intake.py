"""What comes of one loop: times checked against the clocks, values into the window, one by one or in rows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

from agent.runtime.intake.usable import UsableValues
from agent.runtime.intake.window import RollingWindow

if TYPE_CHECKING:
    from collections.abc import Callable

    from agent.runtime.intake.cut import DueStretch
    from agent.runtime.intake.rows import ValueRows
    from agent.runtime.intake.source_clock import SourceClock
    from agent.runtime.samples.recorder import SampleRecorder
    from agent.settings import LoopSettings
    from connectors.base import Sample


KEPT_WITHIN = 10.0
"""s for which readings wait where raw samples are kept: their minute is over after 15 s of silence."""


class WaitingReadings(Protocol):
    """Readings that wait until loops take them in."""

    def settle(self) -> None:
        """Have the loops take in what waits."""

    def hurry(self) -> None:
        """Take the next readings in at once."""


class Intake:
    """``push`` takes samples; ``settle`` is called by whoever looks at what they made."""

    def __init__(
        self,
        settings: LoopSettings,
        came_due: Callable[[DueStretch, float], None],
        clock: SourceClock | None = None,
        recorder: SampleRecorder | None = None,
        stagger: float = 0.0,
    ) -> None:
        """Make it.

        Args:
            settings: Of the loop.
            came_due: Takes what is due, and since when, monotonic, s.
            clock: Which times are believed; None: all.
            recorder: Keeps raw samples; None: nobody does.
            stagger: Hops by which the first window comes due later than it could, 0 to 1.
        """
        self.window = RollingWindow(settings, stagger)
        self.usable = UsableValues(settings.name)
        self.clock = clock
        self.heard: float | None = None
        """Monotonic time at which anything arrived, also what was known already, s."""
        self.came_due = came_due
        self.gathering: WaitingReadings | None = None
        """Where readings of this loop wait; None while there were none."""
        self.longest_wait = math.inf if recorder is None else KEPT_WITHIN
        """For which readings may wait, s."""
        self._recorder = recorder

    def push(self, sample: Sample, arrival: float) -> None:
        """Take a sample that arrived at ``arrival`` (monotonic, s), after all that waits."""
        if self.gathering is not None:
            self.gathering.settle()
            self.gathering.hurry()
        self.push_one(sample, arrival)

    def settle(self) -> None:
        """Take in what waits."""
        if self.gathering is not None:
            self.gathering.settle()

    def take(self, rows: ValueRows) -> bool:
        """Take rows in at once; return False, and take nothing, where one needs a look of its own."""
        if not self.usable.well(rows.roles):
            return False
        places = self.window.places_for(rows)
        if places is None or not (self.clock is None or self.clock.follows(rows)):
            return False
        if self._recorder is not None:
            self._recorder.take(self.usable.loop, rows)
        due = self.window.take(rows, places)
        self.heard = float(rows.times.arrivals[-1])
        if due is not None:
            self.came_due(due, self.heard)
        return True

    def push_one(self, sample: Sample, arrival: float) -> None:
        """Take a sample, whatever waits."""
        self.heard = arrival
        self.usable.see(sample, arrival)
        counts = sample if self.clock is None else self.clock.checked(sample, arrival)
        if counts is None:
            return
        if self._recorder is not None:
            self._recorder.put(counts, arrival)
        due = self.window.push(counts, arrival)
        if due is not None:
            self.came_due(due, arrival)

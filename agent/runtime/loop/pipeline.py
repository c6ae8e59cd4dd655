"""One loop's way from sample to alarm: window, diagnosis in a worker, alarm, publication."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NoReturn

from agent.alarms import Alarm, Announcement, Command, Delay
from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.memory.sticks import with_memory
from agent.analysis.memory.value_of_fit import worth_of_fit
from agent.analysis.memory.valve_memory import ValveMemory, hints_from, remember
from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.routine import (
    Diagnose,
    Routine,
    first_look,
    fitted,
    full_diagnosis,
    routine_diagnosis,
)
from agent.analysis.seen import Seen
from agent.runtime.intake.intake import Intake
from agent.runtime.intake.usable import LOGGED_AGAIN
from agent.runtime.link.outbox import Outbox
from agent.runtime.loop.due import Due, GoneError, Judging, with_window
from agent.runtime.loop.judged import Judged, Observer
from agent.runtime.loop.kept_fit import KeptFit, without_curves
from agent.runtime.loop.pace import Pace
from agent.runtime.loop.turns import LONGEST_PATIENCE
from agent.runtime.loop.workers import Executor
from agent.runtime.store.change import Change
from agent.runtime.store.journal import Journal
from agent.settings import AlarmSettings, LoopSettings
from connectors.base import Publication, Sample

if TYPE_CHECKING:
    from agent.runtime.intake.cut import CutWindow, DueStretch
    from agent.runtime.intake.source_clock import SourceClock
    from agent.runtime.intake.usable import UsableValues
    from agent.runtime.intake.window import RollingWindow
    from agent.runtime.samples.recorder import SampleRecorder

LOG = logging.getLogger(__name__)
USUAL = 0.9
"""Time that a fit should take where none was made yet, s: their median on two cores."""


class LoopPipeline:
    """All that the agent does for one loop.

    ``push`` takes samples at any rate; ``run`` diagnoses the windows that come due, one at a time.
    """

    def __init__(
        self,
        settings: LoopSettings,
        executor: Executor,
        outboxes: Sequence[Outbox] = (),
        observers: Sequence[Observer] = (),
        diagnose: Diagnose = diagnose,
        journal: Journal | None = None,
        clock: SourceClock | None = None,
        base_rate: float = BASE_RATE,
        recorder: SampleRecorder | None = None,
        stagger: float = 0.0,
    ) -> None:
        self.settings = settings
        self.intake = Intake(settings, self._came_due, clock, recorder, stagger)
        """Takes what the bus sends."""
        delay = Delay(settings.alarm.on_delay, settings.alarm.off_delay)
        advises = settings.alarm.advisory == "active"
        self.alarm = Alarm(settings.name, settings.alarm.priority, delay, advises=advises)
        self.memory = ValveMemory()
        """What all windows of the valve said."""
        self.diagnosis: Diagnosis | None = None
        """Of the newest window, without the curves of its fit."""
        self.fitted: KeptFit | None = None
        """The window of ``diagnosis`` and the curves on its samples, where it got a fit."""
        self.superseded = 0
        """Windows that were never diagnosed, because a newer one came due before their turn."""
        self._executor = executor
        self._outboxes = outboxes
        self._observers = observers
        self._diagnose = diagnose
        self._journal = journal or Journal()
        self._base_rate = base_rate
        self.began: float | None = None
        """Monotonic time at which ``run`` began, s."""
        self.judged_at: float | None = None
        """Monotonic time of the newest verdict, s."""
        self._waiting: Due | None = None
        self._judging: Judging | None = None
        """The window that a worker has, or that waits for its fit."""
        self._cost = 0.0
        """Time that the newest diagnosis took where it had a fit, s: what the next should take."""
        self._fitted_until: float | None = None
        """End of the newest window that got a fit, s UTC."""
        self._pace = Pace()
        self._clocks_logged = -math.inf
        self._due = asyncio.Event()

    @property
    def window(self) -> RollingWindow:
        """The newest stretch of the loop."""
        self.intake.settle()
        return self.intake.window

    @property
    def usable(self) -> UsableValues:
        """Whether PV and OP have values that can be used."""
        self.intake.settle()
        return self.intake.usable

    @property
    def heard(self) -> float | None:
        """Monotonic time at which anything arrived, s."""
        self.intake.settle()
        return self.intake.heard

    def push(self, sample: Sample, arrival: float) -> None:
        """Take a sample that arrived at ``arrival`` (monotonic, s)."""
        self.intake.push(sample, arrival)

    def _came_due(self, stretch: DueStretch, arrival: float) -> None:
        self._say_clocks_differ(self.intake.window.clocks.apart, arrival)
        self.superseded += self._waiting is not None
        self._waiting = Due(stretch, arrival, stretch.end(self.settings.ts))
        self._due.set()

    def _say_clocks_differ(self, apart: float, arrival: float) -> None:
        if apart and arrival - self._clocks_logged >= LOGGED_AGAIN:
            self._clocks_logged = arrival
            text = "%s: the clock of PV is %.0f s ahead of that of OP; no verdict is made until they agree"
            LOG.warning(
                text, self.settings.name, apart, extra={"event": "clocks", "loop": self.settings.name}
            )

    def resume(self, kept: Alarm | None, memory: ValveMemory | None = None) -> None:
        """Go on from the alarm and the memory that the store kept; None where it kept none."""
        self.memory = memory or self.memory
        self._follow(self.alarm if kept is None else self.alarm.resumed(kept), ())

    def take_over(self, former: LoopPipeline) -> None:
        """Go on from where a pipeline with other settings was.

        Its alarm stays in any case, its window where the settings that it is made with are the same.
        """
        if _of_the_window(self.settings) == _of_the_window(former.settings):
            former.intake.settle()
            self.intake = former.intake
            self.intake.came_due = self._came_due
            self.diagnosis, self.fitted, self.superseded = former.diagnosis, former.fitted, former.superseded
            self.judged_at = former.judged_at
            self._waiting, self._cost, self._pace = former._waiting, former._cost, former._pace
            self._fitted_until = former._fitted_until
            if self._waiting is not None:
                self._due.set()
        self.resume(former.alarm, former.memory)

    def publish_again(self, now: float) -> None:
        """Publish the state as it stands at ``now``, s UTC: a server of our own starts empty."""
        self._follow(self.alarm, (Announcement("state", self.alarm, now),))

    def obey(self, command: Command) -> None:
        """Do what a person decided about the alarm; the next flush of the journal writes it."""
        self._follow(*self.alarm.on_command(command))

    def look_at_clock(self, now: float) -> None:
        """End shelving when its time is over at ``now``, s UTC."""
        if self.alarm.until is not None and now >= self.alarm.until:
            self._follow(*self.alarm.on_clock(now))

    @property
    def busy(self) -> bool:
        """Whether a window waits for its diagnosis or has it made."""
        return self._judging is not None or self._waiting is not None

    async def run(self) -> NoReturn:
        """Diagnose what comes due, until cancelled."""
        if self.began is None:
            self.began = asyncio.get_running_loop().time()
        while True:
            await self._due.wait()
            self._due.clear()
            if self._waiting is not None:
                await asyncio.sleep(self._pace.wait(asyncio.get_running_loop().time()))
                try:
                    await self._judge()
                finally:
                    self._judging = None

    async def _judge(self) -> None:
        """Look at the newest window as soon as there is a worker, and fit it when its turn comes."""
        seen = None
        try:
            if self.settings.quantify != "always":
                found = await self._executor.run_in_turn(0.0, self._look)
                if isinstance(found, Routine):
                    return await self._decide(found)
                seen = found
            work, expected = partial(self._fit, seen), self._cost or USUAL
            await self._decide(await self._executor.run_in_turn(expected, work, self._worth()))
        except TimeoutError:
            self._cost = LONGEST_PATIENCE
            raise
        except GoneError:
            self.superseded += 1

    def _worth(self) -> float:
        """Return what the answer on the window that waits is worth: little where nothing would change."""
        newest = self._waiting or self._judging
        now = 0.0 if newest is None else newest.end
        since = 0.0 if self._fitted_until is None else max(0.0, now - self._fitted_until)
        return worth_of_fit(self.memory, self.settings.alarm.priority, since, now, self._base_rate)

    async def _decide(self, found: Routine) -> None:
        """Follow the diagnosis of the window that a worker had."""
        if self._judging is None:
            return
        cut, since = self._judging.cut, self._judging.since
        alone, end = found.diagnosis, cut.last
        if found.fitted:
            self._cost, self._fitted_until = alone.seconds, end
        self.memory = remember(self.memory, alone, cut.begin_of(alone.record), cut.end)
        whole = with_memory(alone, self.memory, self._base_rate)
        self._journal.note(Change(memories={self.settings.name: self.memory}))
        self.fitted = KeptFit.of(cut.open(), whole) if found.fitted else None
        self.diagnosis = diagnosis = without_curves(whole)
        self.judged_at = asyncio.get_running_loop().time()
        if diagnosis.oscillation is not None:
            self.window.period = diagnosis.oscillation.period if diagnosis.oscillation.detected else None
        alarmed = self.alarm.state.active
        self._follow(*self.alarm.on_diagnosis(diagnosis, end))
        alarmed = alarmed or self.alarm.state.active
        await self._journal.flush()
        took = self.judged_at - since
        for observer in self._observers:
            observer.judged(Judged(diagnosis, end, took, found.fitted, cut, alarmed))

    def _look(self) -> Callable[[], Routine | Seen]:
        return partial(with_window, first_look, self._newest())

    def _fit(self, seen: Seen | None) -> Callable[[], Routine]:
        """Return the fit of the window that was seen, or of a newer one that came due before its turn."""
        if seen is None:
            return partial(with_window, full_diagnosis, self._newest(), self._diagnose)
        if self._waiting is None and self._judging is not None:
            return partial(with_window, fitted, self._judging.cut, seen, self._diagnose)
        self.superseded += 1
        return partial(with_window, routine_diagnosis, self._newest(), self._diagnose)

    def _newest(self) -> CutWindow:
        """Cut what waits; what came due while a worker was waited for has replaced what was due before.

        Raises GoneError.
        """
        due, self._waiting = self._waiting, None
        if due is None:
            raise RuntimeError("no window waits")
        self._due.clear()
        if (cut := self.window.cut(due.stretch)) is None:
            raise GoneError
        cut = replace(cut, hints=hints_from(self.memory, cut.hints))
        self._judging = Judging(cut, due.since)
        self._pace.begin(asyncio.get_running_loop().time())
        return cut

    def _follow(self, alarm: Alarm, announcements: Sequence[Announcement]) -> None:
        """Take the alarm that follows, noted together with its announcements: no crash comes between."""
        self.alarm = alarm
        self._journal.note(Change(alarms={alarm.loop: alarm}))
        for announcement in announcements:
            self._announce(announcement)

    def _announce(self, announcement: Announcement) -> None:
        if announcement.kind == "event":
            LOG.info(
                "%s: alarm is %s",
                self.settings.name,
                announcement.alarm.state,
                extra={"event": "alarm", "loop": self.settings.name},
            )
            for observer in self._observers:
                observer.announced(announcement)
        for outbox in self._outboxes:
            outbox.put(
                Publication(self.settings.name, announcement.kind, announcement.id, announcement.fields())
            )


def _of_the_window(settings: LoopSettings) -> LoopSettings:
    """Return the settings without those that only matter after the window was cut."""
    return settings.model_copy(update={"alarm": AlarmSettings(), "quantify": "always", "publish": ()})

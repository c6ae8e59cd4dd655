"""The stiction alarm of one loop: diagnoses and operators in, the next alarm and its announcements out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from agent.alarms.delay import Delay
from agent.alarms.state import Event, State, next_state
from agent.analysis.results import Diagnosis, StictionEstimate, Verdict

Priority = Literal["low", "medium", "high", "critical"]


@dataclass(frozen=True, slots=True)
class Announcement:
    """What the plant should be told of an alarm."""

    kind: Literal["state", "event"]
    """``state``: the newest replaces the former; ``event``: a change of state, each counts."""
    alarm: Alarm
    """The alarm as it is now."""
    time: float
    """Of the data that led to it, s UTC."""

    @property
    def id(self) -> str:
        """The same whenever the same thing is announced, so that a consumer can drop what it got twice."""
        return f"{self.alarm.loop}/{self.time:.3f}/{self.kind}/{self.alarm.state}"

    def fields(self) -> dict[str, float | str | bool | None]:
        """Flat values for a bus; None is not known."""
        alarm, found = self.alarm, self.alarm.stiction
        return {
            "loop": alarm.loop,
            "id": alarm.id,
            "active": alarm.state.active,
            "state": alarm.state.value,
            "verdict": alarm.verdict,
            "priority": alarm.priority,
            "time": self.time,
            "f_s": found.f_s.value if found else None,
            "f_d": found.f_d.value if found else None,
            "s": found.s.value if found else None,
            "j": found.j.value if found else None,
        }


@dataclass(frozen=True, slots=True)
class Alarm:
    """Where the alarm of one loop stands. Immutable: each method returns the alarm that follows.

    For example::

        alarm = Alarm("FIC101")
        alarm, announcements = alarm.on_diagnosis(diagnosis, time)
    """

    loop: str
    priority: Priority = "medium"
    delay: Delay = field(default_factory=lambda: Delay(on=3, off=3))
    state: State = State.NORMAL
    id: str | None = None
    """Of the present or last activation, stable from raise to return; None before the first."""
    verdict: Verdict | None = None
    """Of the last window."""
    stiction: StictionEstimate | None = None
    """Of the last window that found some, until the condition is gone; OP units."""

    def on_diagnosis(self, diagnosis: Diagnosis, time: float) -> tuple[Alarm, tuple[Announcement, ...]]:
        """Take the diagnosis of the window that ended at ``time`` (s UTC).

        Stiction counts towards on, no stiction towards off, a window that could not tell towards neither. The
        state is announced each time, so that a bus that lost it has it again after one hop.
        """
        match diagnosis.verdict:
            case "stiction":
                seen: bool | None = True
            case "no_stiction":
                seen = False
            case _:
                seen = None
        delay = self.delay.after(seen=seen)
        found = diagnosis.quantification.stiction if diagnosis.quantification else None
        stiction = found if seen and found else self.stiction
        if seen is False and not delay.there:
            stiction = None
        alarm = replace(self, delay=delay, verdict=diagnosis.verdict, stiction=stiction)
        if delay.there and not self.delay.there:
            alarm = _after(alarm, Event.RAISE, time)
        elif self.delay.there and not delay.there:
            alarm = _after(alarm, Event.CLEAR, time)
        return alarm, _announcements(alarm, self.state, time)

    def on_operator(self, event: Event, time: float) -> tuple[Alarm, tuple[Announcement, ...]]:
        """Take what a person decided at ``time`` (s UTC): acknowledge, shelve, out of service and back."""
        if event in {Event.RAISE, Event.CLEAR}:
            raise ValueError(f"{event} is for the diagnosis to say, not for a person")
        alarm = _after(self, event, time)
        if self.state.silenced and not alarm.state.silenced and alarm.delay.there:
            alarm = _after(alarm, Event.RAISE, time)
        if alarm.state == self.state:
            return alarm, ()
        return alarm, _announcements(alarm, self.state, time)


def _after(alarm: Alarm, event: Event, time: float) -> Alarm:
    state = next_state(alarm.state, event)
    starts = state.active and not alarm.state.active
    return replace(alarm, state=state, id=f"{alarm.loop}/{time:.3f}" if starts else alarm.id)


def _announcements(alarm: Alarm, before: State, time: float) -> tuple[Announcement, ...]:
    state = Announcement("state", alarm, time)
    return (state,) if alarm.state == before else (state, Announcement("event", alarm, time))

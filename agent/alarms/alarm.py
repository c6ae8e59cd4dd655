"""The stiction alarm of one loop: diagnoses and decisions in, the next alarm and its announcements out."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from agent.alarms.command import Command
from agent.alarms.delay import Delay
from agent.alarms.device_health import DeviceHealth, device_health
from agent.alarms.state import Event, State, next_state
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.memory.sticks import is_suspected
from agent.analysis.results import StictionEstimate, Verdict

Priority = Literal["low", "medium", "high", "critical"]
SCHEMA = 2
"""Version of the published fields: 2 has the intervals of S and J."""


@dataclass(frozen=True, slots=True)
class Announcement:
    """One publication about an alarm."""

    kind: Literal["state", "event"]
    """``state``: the newest replaces the one before; ``event``: a change of state, each one counts."""
    alarm: Alarm
    """The alarm as it stands now."""
    time: float
    """Time of the data or of the decision that caused it, s UTC."""

    @property
    def id(self) -> str:
        """Message id: equal for repeats of the same announcement, so that a consumer can drop duplicates."""
        return f"{self.alarm.loop}/{moment(self.time)}/{self.kind}/{self.alarm.state}"

    def fields(self) -> dict[str, float | str | bool | None]:
        """Return flat values for a bus; None means not known. docs/payload.md explains each field."""
        alarm, found = self.alarm, self.alarm.stiction
        return {
            "schema": SCHEMA,
            "message_id": self.id,
            "loop": alarm.loop,
            "id": alarm.id,
            "active": alarm.state.active,
            "state": alarm.state.value,
            "verdict": alarm.verdict,
            "priority": alarm.priority,
            "ne107": alarm.health.name.lower(),
            "health": int(alarm.health),
            "time": self.time,
            "by": alarm.by,
            "until": alarm.until,
            "f_s": found.f_s.value if found else None,
            "f_d": found.f_d.value if found else None,
            "s": found.s.value if found else None,
            "s_low": found.s.low if found else None,
            "s_high": found.s.high if found else None,
            "j": found.j.value if found else None,
            "j_low": found.j.low if found else None,
            "j_high": found.j.high if found else None,
            "s_identifiable": found.identifiable_s if found else None,
            "j_identifiable": found.identifiable_j if found else None,
            "probability": alarm.sticks,
            "advisory": alarm.advisory,
            "no_response": alarm.no_response,
        }


def moment(time: float) -> str:
    """Return a time (s UTC) as written in ids, to the microsecond: two decisions may share a millisecond."""
    return f"{time:.6f}"


Followed = tuple["Alarm", tuple[Announcement, ...]]


@dataclass(frozen=True, slots=True)
class Alarm:
    """The alarm of one loop at a moment. Immutable: each method returns the next alarm.

    For example::

        alarm = Alarm("FIC101")
        alarm, announcements = alarm.on_diagnosis(diagnosis, time)
        alarm, announcements = alarm.on_command(Command(Event.ACKNOWLEDGE, by="jane", at=time))
    """

    loop: str
    priority: Priority = "medium"
    delay: Delay = field(default_factory=lambda: Delay(on=3, off=3))
    state: State = State.NORMAL
    id: str | None = None
    """Id of the present or last activation, stable from raise to return; None before the first."""
    verdict: Verdict | None = None
    """Verdict on the last window."""
    stiction: StictionEstimate | None = None
    """Estimate from the last window that showed stiction, until the condition is gone; OP units."""
    diagnosed: DeviceHealth = DeviceHealth.NORMAL
    """NE 107 status of the device from the last window."""
    sticks: float | None = None
    """Probability that the valve sticks, from all windows that are remembered; None before the first."""
    suspected: bool = False
    """Whether it sticks more probably than not and the verdict on the last window is another."""
    advises: bool = False
    """Whether a suspicion is published as an active advisory; else as one that is shelved."""
    no_response: str | None = None
    """Why PV did not respond to OP in the last window; None where it did, or that is not found."""
    by: str | None = None
    """Person whose command led to this state; None where a diagnosis or the end of shelving did."""
    until: float | None = None
    """End of shelving, s UTC; None in any other state."""

    @property
    def advisory(self) -> Literal["none", "shelved", "active"]:
        """Return the state of the advisory, which is no alarm: the valve is suspected, no more."""
        if not self.suspected:
            return "none"
        return "active" if self.advises else "shelved"

    @property
    def health(self) -> DeviceHealth:
        """NE 107 status; a loop that is out of service is under function check."""
        return DeviceHealth.FUNCTION_CHECK if self.state is State.OUT_OF_SERVICE else self.diagnosed

    def on_diagnosis(self, diagnosis: Diagnosis, time: float) -> Followed:
        """Apply the diagnosis of the window that ended at ``time`` (s UTC).

        Stiction counts towards on, no stiction towards off, an undecided window towards neither. The state is
        announced each time, so that a bus that lost it has it again after one hop.
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
        alarm = replace(
            self,
            delay=delay,
            verdict=diagnosis.verdict,
            stiction=stiction,
            sticks=None if diagnosis.sticks is None else diagnosis.sticks.probability,
            suspected=is_suspected(diagnosis),
            no_response=None if diagnosis.no_response is None else diagnosis.no_response.cause,
            diagnosed=device_health(diagnosis, sticks=delay.there),
        )
        if delay.there and not self.delay.there:
            alarm = _after(alarm, Event.RAISE, time)
        elif self.delay.there and not delay.there:
            alarm = _after(alarm, Event.CLEAR, time)
        return alarm, _announcements(alarm, self.state, time)

    def on_command(self, command: Command) -> Followed:
        """Apply a person's command; one without meaning in this state changes and announces nothing.

        Shelving a shelved alarm again sets a new end.
        """
        if command.event is Event.SHELVE and self.state is State.SHELVED:
            alarm = replace(self, by=command.by, until=command.until)
        else:
            alarm = _returned(
                self, _after(self, command.event, command.at, command.by, command.until), command.at
            )
        return alarm, () if alarm == self else _announcements(alarm, self.state, command.at)

    def on_clock(self, now: float) -> Followed:
        """End shelving when its time is over at ``now``, s UTC."""
        if self.until is None or now < self.until:
            return self, ()
        alarm = _returned(self, _after(self, Event.UNSHELVE, now), now)
        return alarm, _announcements(alarm, self.state, now)

    def resumed(self, kept: Alarm) -> Alarm:
        """Return the alarm ``kept`` from the last run, with the priority and delays of this one."""
        delay = replace(kept.delay, on=self.delay.on, off=self.delay.off)
        return replace(kept, priority=self.priority, delay=delay, advises=self.advises)


def _after(
    alarm: Alarm, event: Event, time: float, by: str | None = None, until: float | None = None
) -> Alarm:
    state = next_state(alarm.state, event)
    if state is alarm.state:
        return alarm
    starts = state.active and not alarm.state.active
    return replace(
        alarm, state=state, id=f"{alarm.loop}/{moment(time)}" if starts else alarm.id, by=by, until=until
    )


def _returned(before: Alarm, alarm: Alarm, time: float) -> Alarm:
    """Raise the alarm again if silencing has ended and its condition is still present."""
    if before.state.silenced and not alarm.state.silenced and alarm.delay.there:
        return _after(alarm, Event.RAISE, time, alarm.by)
    return alarm


def _announcements(alarm: Alarm, before: State, time: float) -> tuple[Announcement, ...]:
    state = Announcement("state", alarm, time)
    return (state,) if alarm.state == before else (state, Announcement("event", alarm, time))

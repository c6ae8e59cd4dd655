"""The configuration file as models. Docstrings of fields go into ``config/schema.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from agent.alarms import Priority
from agent.analysis.record.mode import is_automatic, word_of
from agent.analysis.record.recording import LoopHints
from agent.settings.service import HistorySettings, HttpSettings
from connectors.options import Options, Seconds, Target

Range = tuple[
    Annotated[float, Field(allow_inf_nan=False)],
    Annotated[float, Field(allow_inf_nan=False)],
]
Windows = Annotated[int, Field(ge=1)]


class AgentSettings(Options):
    """The daemon as a whole."""

    workers: Annotated[int, Field(ge=1)] = 1
    """Worker processes for diagnoses; one core each."""
    data_age: Seconds = 60.0
    """Time without any sample after which a connection is opened anew, s."""
    clock_error: Seconds | None = 86400.0
    """Difference from this machine's clock above which the time of a source is rejected, s: the time of this
    machine is used then. None: the time of the source is always accepted."""
    base_rate: Annotated[float, Field(gt=0, lt=1)] = 0.2
    """Part of the plant's valves that stick: where the probability of each loop begins."""
    longest_wait: Seconds = 3.0
    """Longest wait between two attempts at a connection that is down, s; the first waits are shorter."""
    state: Path | None = None
    """File that keeps alarms and unpublished messages over a restart; relative to the configuration file.
    None: the name of the configuration file with the ending .sqlite."""
    http: HttpSettings | None = None
    """HTTP server for health and metrics; None: no server."""
    history: HistorySettings | None = HistorySettings()
    """Entries for `slipjump history`, kept beside `state` with the ending .history.sqlite; None: none."""
    watch_config: bool = False
    """Whether a change of the configuration file takes effect without SIGHUP."""


class WindowSettings(Options):
    """The stretch of data that a diagnosis uses."""

    seconds: Seconds | None = None
    """Fixed length, s. None: `periods` of the oscillation, between `min_seconds` and `max_seconds`."""
    periods: Annotated[float, Field(ge=3)] = 15.0
    """Length in periods of the detected oscillation; all data until an oscillation is detected."""
    min_seconds: Seconds = 300.0
    max_seconds: Seconds = 3600.0
    hop: Annotated[float, Field(gt=0, le=1)] = 0.25
    """Distance from one window to the next, as a fraction of the window length."""

    @model_validator(mode="after")
    def _bounds(self) -> WindowSettings:
        if self.min_seconds > self.max_seconds:
            raise ValueError(
                f"min_seconds {self.min_seconds:g} is more than max_seconds {self.max_seconds:g}"
            )
        return self

    @property
    def shortest(self) -> float:
        """Least length, s."""
        return self.min_seconds if self.seconds is None else self.seconds

    @property
    def longest(self) -> float:
        """Greatest length, s."""
        return self.max_seconds if self.seconds is None else self.seconds


class AlarmSettings(Options):
    """When a loop's alarm is raised and cleared."""

    on_delay: Windows = 3
    """Consecutive windows that must show stiction before the alarm is raised."""
    off_delay: Windows = 3
    """Consecutive windows that must show no stiction before it is cleared."""
    priority: Priority = "medium"
    advisory: Literal["shelved", "active"] = "shelved"
    """Whether a valve that is only suspected is published as a shelved advisory, which nobody is called for,
    or as an active one. It is never an alarm."""


LOOP_NAME = r"^[^\s/+#.\u0000-\u001f\u007f-\u009f\u200b-\u200f\u202a-\u202e\u2060-\u2069\ufeff]+$"
"""Characters of a loop's name: not those that topics and tags use, that nobody sees, or that turn text."""


class LoopSettings(Options):
    """One control loop: the addresses of its values, and what an engineer knows about it."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    name: Annotated[str, Field(min_length=1, pattern=LOOP_NAME, examples=["FIC101"])]
    """Tag name without spaces and without / + # . since it becomes part of topics and tags, and without
    control and direction characters, which would hide in logs what is written there."""
    connection: str
    """Name of the connection from which its tags are read."""
    ts: Seconds
    """Sampling time, s."""
    acting: Literal["reverse", "direct"] | None = None
    """Controller action: reverse, OP falls when PV rises; direct, OP rises when PV rises. None: not known."""
    integrating: bool | None = None
    """Whether PV integrates the flow through the valve, as most levels do. None: not known."""
    cascade: bool = False
    """Whether another controller sets the set point, so that SP changes all the time."""
    op_range: Range | None = None
    """Limits of the valve, in the unit of OP."""
    pv_range: Range | None = None
    """Range of the transmitter, in the unit of PV."""
    automatic: tuple[str | float, ...] | None = None
    """Values of the mode tag that count as automatic, and no others; upper and lower case are equal. None:
    those of the table in `docs/howto/recordings.md`."""
    modes: Mapping[str | int | float, Literal["automatic", "manual"]] = {}
    """Further values of the mode tag -> automatic or manual, such as `{PROG7: automatic, 3: manual}`."""
    hold: Seconds | None = None
    """Where a bus reports changes only: longest silence of the whole loop that still means no change, s.
    None: 10 ts."""
    tags: Mapping[str, Options]
    """Role (pv, op, and optionally sp, mv, mode) -> address on the connection."""
    window: WindowSettings = WindowSettings()
    quantify: Literal["when_it_moves", "always"] = "when_it_moves"
    """Windows that get a full diagnosis: those in which the loop oscillates or OP travels, or all."""
    alarm: AlarmSettings = AlarmSettings()
    publish: tuple[Target, ...] = ()
    """Connections on which its alarm is published."""
    variables: Mapping[str, str] = {}
    """Name -> text that replaces `{name}` in MQTT topics and the like, besides those of a connection."""

    @field_validator("op_range", "pv_range")
    @classmethod
    def _rises(cls, value: Range | None) -> Range | None:
        if value is not None and value[0] >= value[1]:
            raise ValueError(f"the lower end {value[0]:g} must be below the upper end {value[1]:g}")
        return value

    @model_validator(mode="after")
    def _long_enough(self) -> LoopSettings:
        if self.window.shortest < 20 * self.ts:
            raise ValueError(f"a window of {self.window.shortest:g} s is shorter than 20 samples")
        return self

    @property
    def roles(self) -> tuple[str, ...]:
        """Roles that are read, PV and OP first."""
        return tuple(role for role in ("pv", "op", "sp", "mv", "mode") if role in self.tags)

    @property
    def hints(self) -> LoopHints:
        """Prior knowledge for the analysis."""
        return LoopHints(integrating=self.integrating, acting=self.acting, op_range=self.op_range)

    @property
    def longest_silence(self) -> float:
        """Longest silence of the whole loop that still means no change, s."""
        return 10 * self.ts if self.hold is None else self.hold

    def is_automatic(self, mode: float | str) -> bool:
        """Whether a value of the mode tag means that the loop is in automatic."""
        return self.mode_means(mode) is True

    def mode_means(self, mode: float | str) -> bool | None:
        """Return whether a value of the mode tag means automatic; None where nothing says so or not."""
        others = {word_of(word): meaning == "automatic" for word, meaning in self.modes.items()}
        if self.automatic is not None and word_of(mode) not in others:
            return word_of(mode) in {word_of(word) for word in self.automatic}
        return is_automatic(mode, others)


@dataclass(frozen=True, slots=True)
class ConnectionSettings:
    """One connection to a bus."""

    kind: str
    """Kind of the bus, e.g. modbus, opcua or mqtt."""
    options: Options
    """Options of this kind."""


@dataclass(frozen=True, slots=True)
class Settings:
    """The whole configuration of the agent."""

    agent: AgentSettings
    connections: Mapping[str, ConnectionSettings]
    """By name."""
    loops: tuple[LoopSettings, ...]
    lists: tuple[Path, ...] = ()
    """CSV files from which some of the loops come."""

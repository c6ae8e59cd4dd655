"""The configuration file as models. Docstrings of fields go into ``config/schema.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from agent.alarms import Priority
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
    """Processes that quantify; one core each."""
    data_age: Seconds = 60.0
    """Time without any sample after which a connection is opened anew, s."""
    clock_error: Seconds | None = 86400.0
    """Difference from this machine's clock from which the time that a source gives is absurd, s: then time is
    taken from here. None: it is always believed."""
    longest_wait: Seconds = 3.0
    """Longest wait between two attempts at a connection that is down, s; the first waits are shorter."""
    state: Path | None = None
    """File that keeps alarms and what waits to be told over a restart; relative to the configuration file.
    None: its name with the ending .sqlite."""
    http: HttpSettings | None = None
    """Where health and metrics are told; None: nowhere."""
    history: HistorySettings | None = HistorySettings()
    """What `slipjump history` shows, kept beside `state` with the ending .history.sqlite; None: nothing."""
    watch_config: bool = False
    """Whether a change of the configuration file takes effect by itself, as it does after SIGHUP."""


class WindowSettings(Options):
    """The stretch of data that a diagnosis looks at."""

    seconds: Seconds | None = None
    """Fixed length, s. None: `periods` of the oscillation, between `min_seconds` and `max_seconds`."""
    periods: Annotated[float, Field(ge=3)] = 15.0
    """Length in periods of the oscillation that was seen; until one is seen, all there is."""
    min_seconds: Seconds = 300.0
    max_seconds: Seconds = 3600.0
    hop: Annotated[float, Field(gt=0, le=1)] = 0.25
    """How far a window is from the one before, in parts of its length."""

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
    """When a loop's alarm comes and goes."""

    on_delay: Windows = 3
    """Windows in a row that must show stiction."""
    off_delay: Windows = 3
    """Windows in a row that must show none."""
    priority: Priority = "medium"


class LoopSettings(Options):
    """One control loop: where its values are, and what an engineer knows about it."""

    model_config = ConfigDict(arbitrary_types_allowed=True)

    name: Annotated[str, Field(min_length=1, pattern=r"^[^\s/+#.]+$", examples=["FIC101"])]
    """No spaces, none of / + # . in it: it becomes part of topics and tags."""
    connection: str
    """Name of the connection that its tags are read from."""
    ts: Seconds
    """Sampling time, s."""
    acting: Literal["reverse", "direct"] | None = None
    """Controller action: reverse, OP falls when PV rises; direct, OP rises. None: not known."""
    integrating: bool | None = None
    """Whether PV integrates the flow through the valve, as most levels do. None: not known."""
    cascade: bool = False
    """Whether another controller sets the set point, so that SP moves all the time."""
    op_range: Range | None = None
    """Limits of the valve, in the unit of OP."""
    pv_range: Range | None = None
    """Range of the transmitter, in the unit of PV."""
    automatic: tuple[str | float, ...] = ("AUTO", "CAS", "RCAS")
    """Values of the mode tag that count as automatic; words in capitals or not."""
    hold: Seconds | None = None
    """Where a bus reports changes only: silence of the whole loop that means no change, s. None: 10 ts."""
    tags: Mapping[str, Options]
    """Role (pv, op, and if there are any sp, mv, mode) -> address on the connection."""
    window: WindowSettings = WindowSettings()
    quantify: Literal["when_it_moves", "always"] = "when_it_moves"
    """Which windows get a full diagnosis: those in which the loop oscillates or OP travels, or all."""
    alarm: AlarmSettings = AlarmSettings()
    publish: tuple[Target, ...] = ()
    """Where its alarm is told."""
    variables: Mapping[str, str] = {}
    """Name -> what stands for `{name}` in MQTT topics and the like, besides those of a connection."""

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
        """What is read of the loop, PV and OP first."""
        return tuple(role for role in ("pv", "op", "sp", "mv", "mode") if role in self.tags)

    @property
    def hints(self) -> LoopHints:
        """What the analysis is told beforehand."""
        return LoopHints(integrating=self.integrating, acting=self.acting, op_range=self.op_range)

    @property
    def longest_silence(self) -> float:
        """Silence of the whole loop that still means that nothing changed, s."""
        return 10 * self.ts if self.hold is None else self.hold

    def is_automatic(self, mode: float | str) -> bool:
        """Whether a value of the mode tag means that the controller works."""
        if isinstance(mode, str):
            return mode.strip().casefold() in {v.casefold() for v in self.automatic if isinstance(v, str)}
        return mode in self.automatic


@dataclass(frozen=True, slots=True)
class ConnectionSettings:
    """One connection to a bus."""

    kind: str
    """Of the bus: modbus, opcua or mqtt."""
    options: Options
    """The bus's own options."""


@dataclass(frozen=True, slots=True)
class Settings:
    """All that the agent is told."""

    agent: AgentSettings
    connections: Mapping[str, ConnectionSettings]
    """By name."""
    loops: tuple[LoopSettings, ...]
    lists: tuple[Path, ...] = ()
    """Files that some of the loops are listed in."""

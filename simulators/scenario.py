"""A scenario: one control loop with its faults, as a YAML file describes it.

Every number is a parameter of the simulated plant; the truth with which a diagnosis is compared follows from
them. A file may state the truth as well, for its reader; then the two must agree.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Literal, Self

import yaml
from pydantic import Field, PositiveFloat, ValidationError, model_validator

from connectors.base import ConfigError
from simulators.disturbance import at_time
from simulators.draws.stability import peak_sensitivity
from simulators.parameters import (
    Bursts,
    ControllerParameters,
    Drift,
    FieldFault,
    GainStep,
    LoadStepParameters,
    Noise,
    NotNegative,
    Part,
    PipeParameters,
    ProcessParameters,
    Quantisation,
    SetPointStep,
    SinusoidParameters,
    TransmitterParameters,
    ValveParameters,
    Wander,
)

TIGHT = 4.0
"""Peak sensitivity beyond which a loop oscillates by itself: its gain margin is then 1.33 or less."""


class Truth(Part):
    """What a diagnosis of the loop should say."""

    verdict: Literal["stiction", "no_stiction"]
    cause: Literal["stiction", "tight_tuning", "external_disturbance", "no_oscillation"]
    f_s: float
    """OP units."""
    f_d: float
    """OP units."""


class Scenario(Part):
    """One loop, its faults and the run to make of it."""

    loop: str = Field(min_length=1)
    start: float = 1_767_225_600.0
    """Time of the first row, s UTC (2026-01-01 by default) or ISO 8601 in the file."""
    ts: PositiveFloat = 1.0
    """Sampling time, s."""
    duration: PositiveFloat
    """s."""
    warm_up: NotNegative = 600.0
    """Time the loop runs before the first row, s, so that a record never begins at rest."""
    seed: int = Field(default=0, ge=0)
    op_range: tuple[float, float] = (0.0, 100.0)
    """Limits of OP, and of the valve where it has no stops of its own, OP units."""
    controller: ControllerParameters
    valve: ValveParameters = ValveParameters()
    process: ProcessParameters
    gain_steps: tuple[GainStep, ...] = ()
    pipe: PipeParameters | None = None
    """Between valve and process; None has no length."""
    transmitter: TransmitterParameters = TransmitterParameters()
    sensor_tau: NotNegative = 0.0
    """Lag of the transmitter, s."""
    noise: Noise = Noise()
    disturbance: SinusoidParameters = SinusoidParameters()
    load_steps: tuple[LoadStepParameters, ...] = ()
    wander: Wander = Wander()
    bursts: Bursts = Bursts()
    """Of ``noise``, ``wander`` and the walk of ``drift``, each by itself."""
    drift: Drift = Drift()
    quantisation: Quantisation = Quantisation()
    set_points: tuple[SetPointStep, ...] = ()
    fault: FieldFault = FieldFault()
    stated: Truth | None = Field(default=None, alias="truth")
    """The truth as the file states it."""

    @property
    def samples(self) -> int:
        """Rows in the record."""
        return max(1, round(self.duration / self.ts))

    @property
    def peak_sensitivity(self) -> float:
        """How close the loop would be to oscillating without friction; see ``stability``."""
        return peak_sensitivity(self.controller, self.valve, self.process, self.ts, self.sensor_tau)

    @property
    def truth(self) -> Truth:
        """The truth that follows from the parameters."""
        valve = self.valve
        if valve.f_s > 0 or valve.backlash > 0:
            both = (1 + valve.closing) / 2
            f_s, f_d = (each * both + valve.backlash / 2 for each in (valve.f_s, valve.f_d))
            return Truth(verdict="stiction", cause="stiction", f_s=f_s, f_d=f_d)
        if self.peak_sensitivity > TIGHT:
            return Truth(verdict="no_stiction", cause="tight_tuning", f_s=0, f_d=0)
        outside = self.disturbance.amplitude > 0
        cause: Literal["external_disturbance", "no_oscillation"]
        cause = "external_disturbance" if outside else "no_oscillation"
        return Truth(verdict="no_stiction", cause=cause, f_s=0, f_d=0)

    def set_point(self, elapsed: float) -> float:
        """Set point at ``elapsed`` s from the start of the record, PV units."""
        return at_time([(step.time, step.sp) for step in self.set_points], elapsed, self.controller.sp)

    @model_validator(mode="before")
    @classmethod
    def _start_in_seconds(cls, values: object) -> object:
        if not isinstance(values, dict) or not isinstance(values.get("start"), datetime):
            return values
        start = values["start"]
        return values | {"start": (start if start.tzinfo else start.replace(tzinfo=UTC)).timestamp()}

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        faults = []
        low, high = self.op_range
        if not low < high:
            faults.append(f"op_range: expected [low, high], got [{low:g}, {high:g}]")
        elif not low <= self.controller.op <= high:
            faults.append(f"controller.op: {self.controller.op:g} lies outside op_range")
        sign = 1 if self.controller.acting == "reverse" else -1
        if self.process.gain * sign <= 0:
            side = "above" if sign > 0 else "below"
            faults.append(f"process.gain: must lie {side} 0 with a {self.controller.acting} controller")
        if self.fault.kind == "no_flow" and not self.process.taus:
            faults.append("fault.kind: no_flow needs a process of first or second order")
        for name in ("set_points", "load_steps", "gain_steps"):
            times = [step.time for step in getattr(self, name)]
            if times != sorted(times):
                faults.append(f"{name}: must be in order of time")
        if not faults and self.stated is not None:
            stated, follows = self.stated.model_dump(), self.truth.model_dump()
            faults += [
                f"truth.{key}: {stated[key]} is stated, {follows[key]} follows from the parameters"
                for key in stated
                if stated[key] != follows[key]
            ]
        if faults:
            raise ValueError("\n".join(faults))
        return self


def load_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises:
        ConfigError: unreadable, no YAML or no scenario; every fault with its path in the file, one a line.
    """
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError as error:
        raise ConfigError([f"{path}: not UTF-8 text"]) from error
    except OSError as error:
        raise ConfigError([f"{path}: {error.strerror}"]) from error
    except yaml.MarkedYAMLError as error:
        line = f":{error.problem_mark.line + 1}" if error.problem_mark else ""
        raise ConfigError([f"{path}{line}: not YAML: {error.problem}"]) from error
    except yaml.YAMLError as error:
        raise ConfigError([f"{path}: not YAML: {error}"]) from error
    if not isinstance(document, dict):
        raise ConfigError([f"{path}: expected a scenario, keys and values"])
    try:
        return Scenario.model_validate(document)
    except ValidationError as error:
        raise ConfigError([f"{path}: {fault}" for fault in _faults(error)]) from error


def _faults(error: ValidationError) -> list[str]:
    """Return each fault with its place in the file."""
    return [
        ": ".join(filter(None, (".".join(map(str, fault["loc"])), message)))
        for fault in error.errors()
        for message in fault["msg"].removeprefix("Value error, ").splitlines()
    ]

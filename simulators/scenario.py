"""A scenario: one control loop with its faults, as a YAML file tells it.

Every number is a parameter of the simulated plant; the truth a diagnosis is held against follows from
them. A file may state the truth as well, for its reader; then the two must agree.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, model_validator

from connectors.yaml_file import read_yaml
from simulators.stability import peak_sensitivity

TIGHT = 4.0
"""Peak sensitivity beyond which a loop swings by itself: its gain margin is then 1.33 or less."""

NotNegative = Annotated[float, Field(ge=0)]


class Part(BaseModel):
    """Something of a scenario: no unknown keys, no infinite numbers, fixed once read."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class ControllerParameters(Part):
    """PI controller."""

    kc: PositiveFloat
    """Gain, OP units per PV unit."""
    ti: PositiveFloat
    """Integral time, s."""
    acting: Literal["reverse", "direct"] = "reverse"
    """Reverse: OP falls when PV rises."""
    sp: float
    """Set point, PV units."""
    op: float = 50.0
    """OP that holds PV at the set point without load, OP units."""


class ValveParameters(Part):
    """Pneumatic valve; forces are in OP units, divided by the rate of the spring."""

    law: Literal["none", "karnopp", "lugre"] = "none"
    """Friction law."""
    f_s: NotNegative = 0.0
    """Static friction, OP units."""
    f_d: NotNegative = 0.0
    """Kinetic friction, OP units."""
    tau_ip: NotNegative = 0.1
    """Lag of the I/P converter and actuator, s."""
    damping: PositiveFloat = 0.2
    """Viscous damping over spring rate, s: the time constant of a stroke without friction."""
    inertia: PositiveFloat = 2.6e-5
    """Moving mass over spring rate, s2."""
    stribeck: PositiveFloat = 2e-4
    """Speed over which friction falls from static to kinetic, OP spans per second."""
    still: PositiveFloat = 1e-5
    """Speed under which a stem counts as standing (Karnopp), OP spans per second."""
    bristle_stiffness: PositiveFloat = 2000.0
    """Stiffness of the bristles over spring rate (LuGre)."""
    bristle_damping: PositiveFloat = 0.1
    """Damping of the bristles over spring rate, s (LuGre)."""

    @model_validator(mode="after")
    def _friction_fits_law(self) -> Self:
        if self.law == "none":
            if self.f_s or self.f_d:
                raise ValueError("f_s and f_d need a friction law: karnopp or lugre")
        elif not 0 < self.f_s >= self.f_d:
            raise ValueError(f"expected 0 <= f_d <= f_s and f_s > 0, got f_s {self.f_s:g}, f_d {self.f_d:g}")
        elif self.law == "lugre" and self.f_d == 0:
            raise ValueError("f_d must be > 0 with lugre, whose bristles else never wear off")
        return self


class ProcessParameters(Part):
    """What the flow through the valve does to PV."""

    kind: Literal["first_order", "second_order", "integrating"] = "first_order"
    gain: float
    """PV units per OP unit; per OP unit and second where integrating. Below 0 with a direct controller."""
    tau: PositiveFloat | None = None
    """Time constant, s; none where integrating."""
    tau2: PositiveFloat | None = None
    """Second time constant, s; second order only."""
    delay: NotNegative = 0.0
    """Dead time, s."""

    @property
    def taus(self) -> tuple[float, ...]:
        """All time constants, s."""
        return tuple(tau for tau in (self.tau, self.tau2) if tau is not None)

    @model_validator(mode="after")
    def _taus_fit_kind(self) -> Self:
        wanted = {"first_order": (True, False), "second_order": (True, True), "integrating": (False, False)}
        if (self.tau is not None, self.tau2 is not None) != wanted[self.kind]:
            needs = {
                "first_order": "tau",
                "second_order": "tau and tau2",
                "integrating": "neither tau nor tau2",
            }
            raise ValueError(f"kind {self.kind} takes {needs[self.kind]}")
        return self


class Noise(Part):
    """Noise of the transmitter."""

    std: NotNegative = 0.0
    """PV units."""
    correlation: NotNegative = 0.0
    """Time over which it forgets itself, s; 0 is white."""


class Sinusoid(Part):
    """Load swinging at the process input."""

    amplitude: NotNegative = 0.0
    """OP units."""
    period: PositiveFloat = 100.0
    """s."""


class Drift(Part):
    """Load drifting at the process input."""

    ramp: float = 0.0
    """OP units per second."""
    walk: NotNegative = 0.0
    """Standard deviation a random walk gains over one second, OP units."""


class Quantisation(Part):
    """Steps of the converters; 0 is none."""

    pv: NotNegative = 0.0
    """PV units."""
    op: NotNegative = 0.0
    """OP units."""


class SetPointStep(Part):
    """A new set point from a time on."""

    time: NotNegative
    """s from the start of the record."""
    sp: float
    """PV units."""


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
    """Time of the first row, s UTC (2026-01-01 unless told) or ISO 8601 in the file."""
    ts: PositiveFloat = 1.0
    """Sampling time, s."""
    duration: PositiveFloat
    """s."""
    warm_up: NotNegative = 300.0
    """Time the loop runs before the first row, s, so that a record never begins at rest."""
    seed: int = Field(default=0, ge=0)
    op_range: tuple[float, float] = (0.0, 100.0)
    """Limits of OP and of the valve, OP units."""
    controller: ControllerParameters
    valve: ValveParameters = ValveParameters()
    process: ProcessParameters
    noise: Noise = Noise()
    disturbance: Sinusoid = Sinusoid()
    drift: Drift = Drift()
    quantisation: Quantisation = Quantisation()
    set_points: tuple[SetPointStep, ...] = ()
    stated: Truth | None = Field(default=None, alias="truth")
    """The truth as the file states it."""

    @property
    def samples(self) -> int:
        """Rows in the record."""
        return max(1, round(self.duration / self.ts))

    @property
    def peak_sensitivity(self) -> float:
        """How close the loop would be to swinging without friction; see ``stability``."""
        return peak_sensitivity(self.controller, self.valve, self.process, self.ts)

    @property
    def truth(self) -> Truth:
        """The truth that follows from the parameters."""
        if self.valve.f_s > 0:
            return Truth(verdict="stiction", cause="stiction", f_s=self.valve.f_s, f_d=self.valve.f_d)
        if self.peak_sensitivity > TIGHT:
            return Truth(verdict="no_stiction", cause="tight_tuning", f_s=0, f_d=0)
        outside = self.disturbance.amplitude > 0
        cause: Literal["external_disturbance", "no_oscillation"]
        cause = "external_disturbance" if outside else "no_oscillation"
        return Truth(verdict="no_stiction", cause=cause, f_s=0, f_d=0)

    def set_point(self, elapsed: float) -> float:
        """Set point at ``elapsed`` s from the start of the record, PV units."""
        past = [step.sp for step in self.set_points if step.time <= elapsed]
        return past[-1] if past else self.controller.sp

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
        times = [step.time for step in self.set_points]
        if times != sorted(times):
            faults.append("set_points: must be in order of time")
        if not faults and self.stated is not None and self.stated != self.truth:
            faults.append(f"truth: the parameters say {self.truth}, the file {self.stated}")
        if faults:
            raise ValueError("; ".join(faults))
        return self


def load_scenario(path: Path) -> Scenario:
    """Read a scenario file.

    Raises:
        ConfigError: every fault with its path in the file, one a line.
    """
    return read_yaml(path, Scenario)

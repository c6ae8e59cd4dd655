"""Parameters of a simulated loop's parts, as a scenario file gives them."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, model_validator

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
    feed_forward: NotNegative = 0.0
    """Part of the load that OP cancels, as of a load that is measured; 0: feedback alone."""


class ValveParameters(Part):
    """Pneumatic valve; forces are in OP units, divided by the rate of the spring."""

    law: Literal["none", "karnopp", "lugre"] = "none"
    """Friction law."""
    f_s: NotNegative = 0.0
    """Static friction, OP units."""
    f_d: NotNegative = 0.0
    """Kinetic friction, OP units."""
    closing: PositiveFloat = 1.0
    """Friction of a closing stem over that of an opening one, which ``f_s`` and ``f_d`` are."""
    scatter: NotNegative = 0.0
    """Standard deviation of the logarithm of the friction from one stop of the stem to the next."""
    backlash: NotNegative = 0.0
    """Slack between stem and plug, OP units."""
    tau_ip: NotNegative = 0.1
    """Lag of the I/P converter and actuator, s."""
    rate: PositiveFloat | None = None
    """Fastest stroke that the actuator's air allows, OP units per second; None has no limit."""
    stops: tuple[float, float] | None = None
    """Where the stroke ends, OP units; None: where OP does."""
    rangeability: PositiveFloat = 1.0
    """R of the trim: flow goes as (R^x - 1) / (R - 1) over the stroke x. Above 1 equal percentage, below 1
    quick opening."""
    split: tuple[float, float, float] | None = None
    """Trim in two parts: where the lower ends and the upper begins, OP units, and the slope of the upper."""
    damping: PositiveFloat = 0.2
    """Viscous damping over spring rate, s: the time constant of a stroke without friction."""
    inertia: PositiveFloat = 2.6e-5
    """Moving mass over spring rate, s2."""
    stribeck: PositiveFloat = 2e-4
    """Speed over which friction falls from static to kinetic, OP spans per second."""
    still: PositiveFloat = 1e-5
    """Speed under which a stem counts as standing (Karnopp), OP spans per second."""
    bristle_stiffness: PositiveFloat = 10_000.0
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
            raise ValueError("f_d must be > 0 with lugre: its bristles relax only with kinetic friction")
        if self.stops is not None and not self.stops[0] < self.stops[1]:
            raise ValueError(f"stops: expected [low, high], got [{self.stops[0]:g}, {self.stops[1]:g}]")
        return self


class ProcessParameters(Part):
    """Response of PV to the flow through the valve."""

    kind: Literal["first_order", "second_order", "integrating"] = "first_order"
    gain: float
    """PV units per OP unit; per OP unit and second where integrating. Below 0 with a direct controller."""
    tau: PositiveFloat | None = None
    """Time constant, s; none where integrating."""
    tau2: PositiveFloat | None = None
    """Second time constant, s; second order only."""
    delay: NotNegative = 0.0
    """Dead time, s."""
    lead: NotNegative = 0.0
    """Inverse response: PV loses this times the speed of the last lag, s; none where integrating."""
    absolute: PositiveFloat | None = None
    """Of a vessel that radiates: PV of the operating point above absolute zero, OP units; of first order."""
    friction: NotNegative = 0.0
    """Coulomb friction of a drive, OP units; first order only."""
    no_drive: float = 0.0
    """OP at which such a drive has no force, OP units."""

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
        if self.lead and not self.taus:
            raise ValueError("lead needs a lag: first_order or second_order")
        if (self.absolute or self.friction) and (self.kind != "first_order" or self.lead):
            raise ValueError("absolute and friction need kind first_order without lead")
        if self.absolute and self.friction:
            raise ValueError("a process radiates or rubs: absolute or friction")
        return self


class PipeParameters(Part):
    """A pipe between valve and process: what flows through it takes the longer, the less flows."""

    volume: PositiveFloat
    """What one OP unit lets through in a second is one, OP units times s."""
    no_flow: float
    """OP at which nothing flows, OP units."""


class TransmitterParameters(Part):
    """What is shown of PV."""

    kind: Literal["linear", "square", "ph"] = "linear"
    """``square``: the pressure across an orifice whose root is not extracted; ``ph``: PV is the pH of a
    buffered solution, the valve doses a strong base."""
    flow: PositiveFloat = 1.0
    """Flow of the operating point, OP units; ``square`` only."""
    ph: float = 7.0
    """Of the operating point; ``ph`` only."""
    strength: PositiveFloat = 1e-7
    """Base that one OP unit adds, mol/l; ``ph`` only."""
    buffer: NotNegative = 0.0
    """Weak acid in the solution, mol/l; ``ph`` only."""
    dead_band: NotNegative = 0.0
    """Of a float or a linkage, as PV over the gain of the process, OP units."""


class Noise(Part):
    """Noise of the transmitter."""

    std: NotNegative = 0.0
    """PV units."""
    correlation: NotNegative = 0.0
    """Correlation time, s; 0 is white."""


class Bursts(Part):
    """Strength of the noise and of loads that wander: it rises and falls, as with weather or a neighbour."""

    std: NotNegative = 0.0
    """Standard deviation of its logarithm; 0 is the same strength always. The mean square stays."""
    correlation: PositiveFloat = 10.0
    """Correlation time, s."""


class SinusoidParameters(Part):
    """Load that oscillates at the process input."""

    amplitude: NotNegative = 0.0
    """OP units."""
    period: PositiveFloat = 100.0
    """s."""
    shape: Literal["sine", "square", "sawtooth", "pulses"] = "sine"
    """Pulses last a fifth of the period."""


class LoadStepParameters(Part):
    """Another load at the process input from a time on."""

    time: NotNegative
    """s from the start of the record."""
    load: float
    """OP units, in place of that of the step before."""


class GainStep(Part):
    """A change of the gain of the flow at a time, as where the pressure before the valve changes."""

    time: NotNegative
    """s from the start of the record."""
    factor: PositiveFloat
    """Of the deviation of the flow; 1 before the first step."""


class Wander(Part):
    """Load at the process input that wanders about zero: noise of first order."""

    std: NotNegative = 0.0
    """OP units."""
    correlation: PositiveFloat = 30.0
    """Correlation time, s."""


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


class FieldFault(Part):
    """Something in the field that breaks the way from OP to PV from a time on."""

    kind: Literal["none", "jammed", "no_flow", "transmitter_holds", "transmitter_fails"] = "none"
    """``jammed``: the plug stands; ``no_flow``: nothing flows, and PV falls to zero; ``transmitter_holds``:
    it repeats its last value; ``transmitter_fails``: it goes to ``value``."""
    time: NotNegative = 0.0
    """s from the start of the record."""
    value: float = 0.0
    """PV units."""
    cut_off: NotNegative = 0.0
    """PV below it is shown as zero, PV units; only where nothing flows."""

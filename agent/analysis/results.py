"""What an analysis says, as values. A number that is not known is None, never NaN."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from agent.units import FrictionBands

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

Verdict = Literal["stiction", "no_stiction", "undecided", "not_testable"]
Cause = Literal["stiction", "tight_tuning", "external_disturbance", "no_oscillation", "undecided"]
StictionClass = Literal["weak", "dead_band", "stick_slip", "dead_band_stick_slip"]
FIRM: tuple[Verdict, ...] = ("stiction", "no_stiction")
"""Verdicts that a label can be compared with."""
MethodVerdict = Literal["stiction", "no_stiction", "undecided", "not_applicable"]
MethodKind = Literal["limit_cycle", "travel", "model"]
"""What a method looks at: the shape of a steady oscillation, valve against OP, or a model's free run."""


NORMAL_90 = 1.6448536269514722
"""Half of the 90 % interval of a normal distribution, standard deviations: its 95 % quantile."""


@dataclass(frozen=True, slots=True)
class IntervalEstimate:
    """A number with its 90 % interval."""

    value: float
    low: float | None = None
    """Lower end, or None before intervals exist."""
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Oscillation:
    """What an oscillation detector saw in one signal."""

    detected: bool
    period: float | None
    """s; None where no period could be found."""
    regularity: float | None
    """Mean over three standard deviations of the period (Thornhill 2003); > 1 is regular."""
    share: float | None = None
    """Its part of the signal's power, 0 to 1; None where it was not separated from the rest."""


@dataclass(frozen=True, slots=True)
class StictionEstimate:
    """How much a valve sticks, in OP units."""

    f_s: IntervalEstimate
    f_d: IntervalEstimate
    s: IntervalEstimate
    j: IntervalEstimate
    identifiable_s: bool | None = None
    """Whether the record determines S; None before this is judged."""
    identifiable_j: bool | None = None

    @classmethod
    def of(cls, bands: FrictionBands) -> StictionEstimate:
        """Return the estimate without intervals."""
        return cls(
            IntervalEstimate(bands.f_s),
            IntervalEstimate(bands.f_d),
            IntervalEstimate(bands.s),
            IntervalEstimate(bands.j),
        )

    @property
    def bands(self) -> FrictionBands:
        """The friction without its intervals, OP units."""
        return FrictionBands(self.f_s.value, self.f_d.value)


@dataclass(frozen=True, slots=True)
class ProcessIntervals:
    """90 % intervals of a process, each (low, high); None for what the process does not have."""

    gain: tuple[float, float]
    """As ``ProcessEstimate.gain``."""
    tau: tuple[float, float] | None
    """s"""
    delay: tuple[float, float]
    """s"""
    tau2: tuple[float, float] | None = None
    """s"""


@dataclass(frozen=True, slots=True)
class Profile:
    """The best model at each S: what the record says of S, and what trades with it.

    Arrays have shape (k,), S ascending.
    """

    s: FloatArray
    """OP units."""
    p: FloatArray
    """That the best model at that S is as good as the best of all (``identify.confidence_set``), 0 to 1."""
    delay: FloatArray
    """Delay of the best model at that S, s."""
    j: FloatArray
    """Its slip jump, OP units."""
    limit: float
    """Of ``p``, from which a model is within the 90 % interval."""


@dataclass(frozen=True, slots=True)
class ProcessEstimate:
    """The low-order process between valve and PV."""

    kind: str
    """``fopdt``, ``sopdt`` or ``integrator``."""
    gain: float
    """PV units per OP unit (per OP unit and second for an integrator)."""
    tau: float | None
    """Largest time constant, s; None for an integrator."""
    delay: float
    """s; y(t) depends first on MV(t - delay), delay >= ts."""
    tau2: float | None = None
    """Second time constant of a ``sopdt``, s."""
    intervals: ProcessIntervals | None = None
    """None where a quantifier has none."""


@dataclass(frozen=True, slots=True)
class CauseShare:
    """One of the causes of an oscillation with its part in it, 0 to 1."""

    cause: Cause
    share: float


@dataclass(frozen=True, slots=True)
class SimulatedModel:
    """A model in free run, for readers: its process, its PV and its valve, (n,) each."""

    process: ProcessEstimate
    pv: FloatArray
    """PV units."""
    mv: FloatArray
    """OP units."""


@dataclass(frozen=True, slots=True)
class Sticks:
    """How probable it is that a valve sticks, at the base rate of its plant."""

    probability: float
    """0 to 1, always known: without any evidence it is the base rate."""
    base_rate: float
    """Part of the valves of the plant that stick."""
    windows: float
    """Windows that it comes from; what counts in part counts in part."""


@dataclass(frozen=True, slots=True)
class LeastErrorValve:
    """The valve with the least error in free run, which need not be the likeliest."""

    s: float
    """OP units, like J."""
    j: float
    mv: FloatArray
    """How its stem moved, OP units, (n,)."""


@dataclass(frozen=True, slots=True)
class Quantification:
    """Answer of one quantifier on one window."""

    quantifier: str
    stiction: StictionEstimate | None
    """None where the valve model did not beat the linear one, or the fit failed (``failure`` says why)."""
    process: ProcessEstimate | None
    free_run_percent: float | None
    """Fit of the sticking model in free run, 100 (1 - ||PV - model|| / ||PV - mean PV||)."""
    linear_percent: float | None
    """The same without stiction."""
    evidence: float | None
    """Linear over stiction free-run mean squared error; 1 where stiction explains nothing."""
    decision: MethodVerdict
    model_pv: FloatArray | None = None
    """Free-run PV of the chosen model, PV units, (n,)."""
    model_mv: FloatArray | None = None
    """Simulated valve position, OP units, (n,)."""
    failure: str | None = None
    """Why there is no answer, in plain words."""
    profile: Profile | None = None
    """Error against S; None where a quantifier has none."""
    cause_shares: tuple[CauseShare, ...] = ()
    """Causes of the oscillation, where the method names them."""
    quick_evidence: float | None = None
    """``evidence`` from what is quicker than a load wanders; None where a quantifier does not give it."""
    turns: int | None = None
    """Changes of direction of the valve that was found; None where a quantifier does not count them."""
    log_likelihood_ratio: float | None = None
    """Log of how much more likely the record is with a sticking valve, nats; None: not computed."""
    would_show: float | None = None
    """How likely the record would show a valve that sticks, 0 to 1; None: not known."""
    load_wave: bool = False
    """Whether a wave of the load makes the record at least as likely as a valve that sticks: ``evidence``
    compares with a model that has none, and says nothing then."""
    slip_scatter: float | None = None
    """Standard deviation of the logarithm of S from slip to slip; None where one S explains them as well."""
    search_spent: bool = False
    """Whether the search ended with its budget spent, so that a better valve might be found."""
    sticking: SimulatedModel | None = None
    """The model that sticks where the chosen one does not, for a verdict that others decide."""
    least_error: LeastErrorValve | None = None
    """On which evidence and verdict rest, for the innovations; None: the valve that is reported, or theirs is
    known."""

    @property
    def s(self) -> IntervalEstimate | None:
        """Return S, OP units; None where nothing was estimated."""
        return None if self.stiction is None else self.stiction.s


@dataclass(frozen=True, slots=True)
class MethodResult:
    """What one method says, for the table of methods."""

    verdict: MethodVerdict
    index: float | None
    reason: str = ""
    """Why, for an engineer; empty where the quantifier's own words stand elsewhere."""
    seen: object = field(default=None, repr=False, compare=False)
    """What the detector looked at, its own dataclass, for its picture; None where it did not get so far."""

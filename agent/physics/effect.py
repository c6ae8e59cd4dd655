"""The interface of a physical effect: bounded parameters and what they do at one stage from OP to PV."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol, TypeVar, runtime_checkable

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

P = TypeVar("P")
"""A process that the effect can change: ``LinearProcess``, ``TwoTanks``."""
Stage = Literal["valve", "process", "sensor", "disturbance"]


@dataclass(frozen=True, slots=True)
class Facts:
    """Properties of a record that set the bounds of parameters."""

    ts: float
    """s."""
    samples: int
    op_low: float
    """OP units, like ``op_high``."""
    op_high: float
    pv_low: float
    """PV units, like ``pv_high``."""
    pv_high: float
    period: float
    """Dominant period of OP, s."""
    op_speed: float
    """Mean speed of OP without its noise, OP units per second."""
    gain_sign: int
    """Of the process; 0 where it is not known."""
    stepped: bool = False
    """Whether OP stands at most samples: a test by hand, a relay. What feedback forbids is possible then."""
    response: Literal["OP", "PV"] = "OP"
    """Unit in which the base of a model responds: that of OP for a gain of one, or of PV itself."""

    @property
    def response_span(self) -> float:
        """Max - min of OP, or of PV, in the unit in which the base responds."""
        return self.op_span if self.response == "OP" else self.pv_high - self.pv_low

    @property
    def op_span(self) -> float:
        """Max - min of OP, OP units."""
        return self.op_high - self.op_low

    @property
    def duration(self) -> float:
        """Of the record, s."""
        return self.ts * self.samples


@dataclass(frozen=True, slots=True)
class Parameter:
    """One number of an effect or of a process, searched between its bounds."""

    name: str
    unit: str
    """``OP``, ``PV``, ``s``, ``1/s``, ``OP/s``, ``OP*s``, ``1/OP`` or ``1``."""
    low: float
    high: float
    """Where it is ``low``, the number is not searched: a constant of the record that is fitted, with which
    other numbers mean the same in another record."""
    null: float | None = None
    """Value that removes the effect; None where no value of this parameter alone removes it."""
    log: bool = False
    """Searched by its logarithm; ``low`` > 0 then."""
    of_record: bool = False
    """Belongs to one record, not to the loop, like the first valve position: each record fits its own."""
    natural: bool = False
    """Physics sets the bounds, not the search, so a value at a bound is plausible: a share, a ratio."""
    by_law: float = 0.0
    """Part of its value by which it may differ under another law of the same effect, or within a sample. The
    true one is not known, so the interval is at least so wide."""

    @property
    def constant(self) -> bool:
        """Whether it is not searched."""
        return self.low == self.high

    @property
    def instant(self) -> bool:
        """Whether it is the time of an event in the record."""
        return self.of_record and self.unit == "s"


class Effect(Protocol):
    """One physical effect. Its stage decides which of the four forms of ``apply`` it has."""

    @property
    def name(self) -> str:
        """As the command line calls it."""
        ...

    @property
    def family(self) -> str:
        """Effects that one record may not be able to distinguish."""
        ...

    @property
    def stage(self) -> Stage:
        """Where between OP and PV it acts."""
        ...

    @property
    def bases(self) -> tuple[str, ...]:
        """Names of the process bases it applies to; empty: all, but a process effect only to linear ones."""
        ...

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return what is searched, with bounds that fit the record."""
        ...


class ValveEffect(Effect, Protocol):
    """Moves the valve; effects of this stage act one after the other (``loop_model.CHAIN``)."""

    def apply(self, position: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return the position (n,), OP units, that follows from what is commanded, (n,), OP units, no NaN."""
        ...


@runtime_checkable
class ManyValves(ValveEffect, Protocol):
    """A valve effect that moves many valves at once, which takes less time than one after the other."""

    def apply_all(self, positions: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return what ``apply`` does of each valve, (m, n), of values (m, k).

        ``positions`` are those that are commanded, (m, n), or one row for all, (1, n).
        """
        ...


class SensorEffect(Effect, Protocol):
    """Changes the measured PV, as a transmitter does. It sees the response for gain one, before its level."""

    def apply(self, pv: FloatArray, values: FloatArray, ts: float) -> FloatArray:
        """Return the measured value of ``pv``, (n,), PV units."""
        ...


class DisturbanceEffect(Effect, Protocol):
    """Adds to PV with coefficients that are solved for, not searched."""

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:
        """Return the columns that are added, each to be multiplied by its coefficient, (n, k).

        Args:
            time: From the start of the record, s, (n,).
            response: Of the process to the valve, gain one, (n,).
            values: In the order of ``parameters``.
        """
        ...


Solved = tuple[float, str]
"""A number that was solved for, and its unit: those of ``Parameter``, ``PV/OP``, ``rad``."""


@runtime_checkable
class SolvedEffect(Effect, Protocol):
    """A disturbance whose coefficients have names for a reader: heights, an amplitude and a phase."""

    def solved(self, coefficients: FloatArray, gain: float) -> Mapping[str, Solved]:
        """Return the numbers by name, of the coefficients of ``columns``, (k,), and of the process's gain."""
        ...


@runtime_checkable
class SpottedEffect(Effect, Protocol):
    """An effect that a scan of its parameters misses, but that the residual of a model without it shows."""

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:
        """Return start values (m, k), in the order of ``parameters``; none where the residual shows none.

        ``residual`` is PV less the model, PV units, (n,), NaN where missing.
        """
        ...


class ProcessEffect(Effect, Protocol[P]):
    """Changes a process into another process."""

    def change(self, process: P, values: FloatArray) -> P:
        """Return the process with the effect; times are in s."""
        ...

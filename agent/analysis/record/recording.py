"""The stretch of one loop that everything else looks at."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from agent.analysis.record.known_process import KnownProcess, KnownValve
from agent.analysis.record.wild_samples import wild

FloatArray = NDArray[np.float64]
LARGEST = 1e15
"""No plant has such numbers: historians mark lost values by 1e30 and the like."""


@dataclass(frozen=True, slots=True)
class LoopHints:
    """What an engineer knows about the loop and the data do not show as well."""

    integrating: bool | None = None
    """PV integrates the valve flow (levels); None: unknown."""
    acting: str | None = None
    """Controller action, ``reverse`` (process gain > 0) or ``direct`` (gain < 0); None: unknown."""
    delay: int | None = None
    """Samples D: y(t) depends first on MV(t - D), D >= 1; None: search it."""
    order: int | None = None
    """Order of the process model, 1 or 2; None: choose."""
    op_range: tuple[float, float] | None = None
    """Limits of the valve in OP units; None: unknown, so saturation is judged from the record."""
    known: KnownProcess | None = None
    """The process as other windows of the valve showed it; None: there are none."""
    known_valve: KnownValve | None = None
    """The valve as earlier windows of it showed that it sticks; None: they did not."""


@dataclass(frozen=True, slots=True)
class LoopWindow:
    """OP and PV of a loop on a uniform time grid; a missing or impossible sample is NaN, never a guess.

    All arrays have shape (n,) and are read-only.
    """

    loop: str
    start: float
    """Time of the first sample, s UTC."""
    ts: float
    """Sampling time, s."""
    op: FloatArray
    """Controller output, OP units."""
    pv: FloatArray
    """Process variable, PV units."""
    sp: FloatArray | None = None
    """Set point, PV units."""
    mv: FloatArray | None = None
    """Measured valve position or flow, its own unit."""
    automatic: NDArray[np.bool_] | None = None
    """True where the loop was in an automatic mode; None where the mode is unknown. Elsewhere OP, PV and MV
    are NaN: the controller did not move OP."""
    hints: LoopHints = field(default_factory=LoopHints)
    duplicates: int = 0
    """Samples dropped because their timestamp was there already."""
    wild: int = 0
    """Values of OP, PV and MV that are gaps because they lie far outside those around them."""
    clocks_apart: float = 0.0
    """How far PV's clock is ahead of OP's, where that is known and matters, s."""
    unknown_modes: tuple[str, ...] = ()
    """Modes in the record of which no table knows whether they are automatic; they count as not."""

    def __post_init__(self) -> None:
        n = len(self.op)
        for name in ("automatic", "op", "pv", "sp", "mv"):
            values = getattr(self, name)
            if values is None:
                continue
            if len(values) != n:
                raise ValueError(f"{name} has {len(values)} samples, op has {n}")
            frozen = np.array(values)  # a copy: freezing the caller's array would surprise him
            if frozen.dtype.kind == "f":
                frozen[np.abs(frozen) >= LARGEST] = np.nan  # also infinity: no instrument reads it
                self._reject_wild(name, frozen)
                if self.automatic is not None and name != "sp":
                    frozen[~np.asarray(self.automatic)] = np.nan
            frozen.setflags(write=False)
            object.__setattr__(self, name, frozen)

    def _reject_wild(self, name: str, values: FloatArray) -> None:
        """Make gaps of isolated values that no plant has; the set point may be any."""
        if name == "sp":
            return
        found = wild(values)
        values[found] = np.nan
        object.__setattr__(self, "wild", self.wild + int(np.count_nonzero(found)))

    def __len__(self) -> int:
        return len(self.op)

    @property
    def time(self) -> FloatArray:
        """Sample times, s UTC, shape (n,)."""
        return np.asarray(self.start + self.ts * np.arange(len(self)), dtype=np.float64)

    @property
    def error(self) -> FloatArray:
        """Control error SP - PV; without a set point the deviation of PV from its mean. PV units, (n,)."""
        return error_of(self.pv, self.sp)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """True where OP and PV are both finite, shape (n,)."""
        return np.isfinite(self.op) & np.isfinite(self.pv)

    @property
    def op_span(self) -> float:
        """Max - min of OP, OP units; 0 where nothing is finite."""
        finite = self.op[np.isfinite(self.op)]
        return float(np.ptp(finite)) if finite.size else 0.0

    def with_hints(self, hints: LoopHints) -> LoopWindow:
        """Return the same data with other prior knowledge."""
        return replace(self, hints=hints)


def error_of(pv: FloatArray, sp: FloatArray | None) -> FloatArray:
    """Return the control error SP - PV, (n,); without a set point the deviation of PV from its mean."""
    if sp is not None:
        return np.asarray(sp - pv, dtype=np.float64)
    finite = pv[np.isfinite(pv)]
    with np.errstate(invalid="ignore", over="ignore"):  # the sum of huge readings
        mean = float(np.mean(finite)) if finite.size else np.nan
        return np.asarray(mean - pv, dtype=np.float64)

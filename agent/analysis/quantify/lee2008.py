"""Closed-loop stiction quantification by system identification: Lee, Ren and Huang (2008).

For each valve of a bounded space (f_S, f_D; model of He et al. 2007) the position MV' follows from OP, a
first- or second-order process with delay is fitted from MV' to PV, and the valve with the least model error
is the answer. Kept from the paper: the valve starts without stored force, u_r(0) = 0; means are removed,
nothing is filtered; order and delay are searched where the engineer doesn't give them. Ours: the error is
that of the simulated output (see ``output_error``), and implausible processes are refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.analysis.delay import estimate_delay
from agent.analysis.quantify.bounded_search import grid_search, random_search
from agent.analysis.quantify.output_error import (
    FEWEST_ROWS,
    FIRST_ORDER,
    INTEGRATOR,
    SECOND_ORDER,
    fit_process,
    output_errors,
    valve_position,
)
from agent.analysis.quantify.process_estimate import process_estimate
from agent.analysis.quantify.turns import turns
from agent.analysis.results import MethodVerdict, Quantification, StictionEstimate
from agent.physics.processes.arx import Arx, simulate_arx
from agent.physics.valves.he2007 import he2007
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.recording import FloatArray, LoopWindow

THRESHOLD = 1.4
"""Evidence above which the valve is said to stick: 5 % of simulated loops without stiction exceed it."""
SHORT_DELAYS = 20
"""Delays always searched, samples."""
AROUND_ESTIMATE = 5
"""Delays searched on each side of the estimated one, samples."""

NO_STICTION = np.zeros(2)


@dataclass(frozen=True, slots=True)
class Lee2008:
    """The paper's method with one of its two searches."""

    search: Literal["grid", "random"] = "grid"
    """Contour map at 1 % of the OP span, as in the paper's Table I, or multistart adaptive random search."""

    @property
    def name(self) -> str:
        """``lee2008`` or ``lee2008_random``."""
        return "lee2008" if self.search == "grid" else f"lee2008_{self.search}"

    def quantify(self, window: LoopWindow) -> Quantification:
        """Measure one window; where that can't be done, ``failure`` tells why."""
        missing = lack(window)
        if missing is not None:
            return _failed(self.name, missing)
        record = Record.of(window)
        structures = structures_to_try(window)
        anywhere = free_delays(window, structures)
        delays = anywhere if window.hints.delay is None else np.array([window.hints.delay])

        def errors(bands: FloatArray) -> FloatArray:
            lowest: FloatArray = record.errors(bands, delays, structures).min(axis=(1, 2))
            return lowest

        search = grid_search if self.search == "grid" else random_search
        best = record.best_model(search(errors, window.op_span), delays, structures)
        if best is None:
            return _failed(self.name, "no process with a real lag and a steady gain follows PV from OP")
        # The rival without stiction may take any delay: a wrong hint must not make a valve look sticky.
        linear = record.best_model(NO_STICTION, np.union1d(anywhere, delays), structures)
        linear_error = min(record.variance, np.inf if linear is None else linear.error)
        evidence = linear_error / max(best.error, 1e-12 * record.variance)
        return Quantification(
            quantifier=self.name,
            stiction=StictionEstimate.of(best.bands) if best.bands.f_s > 0 else None,
            process=process_estimate(best.process, best.structure, window.ts),
            free_run_percent=record.percent(best.error),
            linear_percent=record.percent(linear_error),
            evidence=evidence,
            decision=_decision(best, evidence),
            model_pv=best.pv + record.pv_mean,
            model_mv=best.mv,
        )


@dataclass(frozen=True, slots=True)
class _Model:
    bands: FrictionBands
    structure: int
    process: Arx
    mv: FloatArray
    """Valve position, OP units, (n,)."""
    pv: FloatArray
    """Simulated output about the mean of PV, PV units, (n,)."""
    error: float
    """Mean squared error of that, PV units squared."""


@dataclass(frozen=True, slots=True)
class Record:
    """OP and PV as the objective takes them."""

    op: FloatArray
    """OP units, (n,)."""
    pv: FloatArray
    """About its mean, PV units, (n,)."""
    pv_mean: float
    gain_sign: int
    """1 or -1 where the engineer gave the controller's action, else 0."""

    @classmethod
    def of(cls, window: LoopWindow) -> Record:
        """Return the record of a window in which ``lack`` misses nothing."""
        op = np.where(np.isfinite(window.op), window.op, np.nan)
        pv = np.where(np.isfinite(window.pv), window.pv, np.nan)
        mean = float(np.nanmean(pv))
        sign = {"reverse": 1, "direct": -1, None: 0}[window.hints.acting]
        return cls(op, pv - mean, mean, sign)

    @property
    def variance(self) -> float:
        """Of PV, PV units squared: the error of a model that explains nothing."""
        return float(np.nanmean(self.pv**2))

    def percent(self, error: float) -> float:
        """Fit of a model with this mean squared error."""
        return float(100 * (1 - np.sqrt(error / self.variance)))

    def errors(self, bands: FloatArray, delays: NDArray[np.int64], structures: tuple[int, ...]) -> FloatArray:
        """Mean squared errors, shape (bands, structures, delays)."""
        return np.stack(
            [output_errors(self.op, self.pv, bands, delays, each, self.gain_sign) for each in structures],
            axis=1,
        )

    def best_model(
        self, bands: FloatArray, delays: NDArray[np.int64], structures: tuple[int, ...]
    ) -> _Model | None:
        """Return the best process behind a valve with ``bands`` (2,), or None where none is plausible."""
        errors = self.errors(bands[None, :], delays, structures)[0]
        row, column = np.unravel_index(np.argmin(errors), errors.shape)
        error, structure = float(errors[row, column]), structures[row]
        if not np.isfinite(error):
            return None
        f_s, f_d = float(bands[0]), float(bands[1])
        mv = valve_position(self.op, f_s, f_d)
        process = fit_process(mv, self.pv, int(delays[column]), structure)
        return _Model(
            bands=FrictionBands(f_s, f_d),
            structure=structure,
            process=process,
            mv=he2007(self.op, f_s, f_d, self.op[np.isfinite(self.op)][0]),
            pv=simulate_arx(process, mv, self.pv),
            error=error,
        )


def _decision(best: _Model, evidence: float) -> MethodVerdict:
    if best.bands.f_s == 0 or evidence <= THRESHOLD:
        return "no_stiction"
    return "stiction" if turns(best.mv) > 0 else "undecided"


def structures_to_try(window: LoopWindow) -> tuple[int, ...]:
    """Return the processes to try, the simplest first; it stays where the next is no better."""
    if window.hints.integrating:
        return (INTEGRATOR,)
    if window.hints.order is not None:
        return (FIRST_ORDER if window.hints.order == 1 else SECOND_ORDER,)
    return (FIRST_ORDER, SECOND_ORDER)


def free_delays(window: LoopWindow, structures: tuple[int, ...]) -> NDArray[np.int64]:
    """Return the delays to search: the short ones, and about the paper's estimate from OP to PV.

    In a sticking loop that estimate is often far off, so it only adds to them.
    """
    longest = max(1, len(window) // 10)
    delays = set(range(1, SHORT_DELAYS + 1))
    for order in {max(FIRST_ORDER, structure) for structure in structures}:
        estimate = estimate_delay(window.op, window.pv, order=order, longest=longest)
        if estimate is not None:
            delays |= set(range(estimate - AROUND_ESTIMATE, estimate + AROUND_ESTIMATE + 1))
    return np.array(sorted(delay for delay in delays if 1 <= delay <= longest), dtype=np.int64)


def lack(window: LoopWindow) -> str | None:
    """Return what a window lacks for a fit, in plain words; None where it lacks nothing."""
    known = int(np.count_nonzero(window.valid))
    if known < 2 * FEWEST_ROWS:
        return f"only {known} samples have both OP and PV, at least {2 * FEWEST_ROWS} are needed"
    if window.op_span == 0:
        return "OP does not move"
    if np.ptp(window.pv[np.isfinite(window.pv)]) == 0:
        return "PV does not move"
    return None


def _failed(name: str, why: str) -> Quantification:
    return Quantification(
        quantifier=name,
        stiction=None,
        process=None,
        free_run_percent=None,
        linear_percent=None,
        evidence=None,
        decision="not_applicable",
        failure=why,
    )

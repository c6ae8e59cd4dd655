"""A load that changes up to three times, and stays or returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts, Parameter, Solved, Stage
from agent.physics.signals.steps import lagged_steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

EDGE = 0.05
"""Share of the record at either end in which a step cannot be distinguished from the level."""
STEPS = 3
"""In all, at most."""
TIMES = ("time", "time_2", "time_3")
HEIGHTS = ("height", "height_2", "height_3")
INSTANTS = 120
"""Instants of the record that are scanned before a search begins."""
LAGS = (0.0, 0.25, 1.0)
"""Lags of that scan, periods."""
LEAST_ENERGY = 1e-6
"""Least energy per sample by which a step must differ from the others."""


@dataclass(frozen=True, slots=True)
class LoadStepEffect:
    """Steps behind a lag of their own on PV; their heights are solved for.

    One step alone does not find a load that comes and goes again, as of a pump or a batch: the residual is
    nearly as large as without it. For a load that changes once the other two steps are small. A load enters
    through the process, but seldom on the path of the valve: the lag is searched, not taken from the process.
    No lag at all is a step of the level or of the transmitter, a lag of four periods is a slow load on an
    integrating process.
    """

    name: str = "load_step"
    family: str = "disturbance"
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()
    steps: int = STEPS
    """How many it has."""

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return the instants, in any order, and the lag."""
        first, last = EDGE * facts.duration, (1 - EDGE) * facts.duration
        instants = [Parameter(each, "s", first, last, of_record=True) for each in TIMES[: self.steps]]
        return (*instants, Parameter("tau", "s", 0.0, 4 * facts.period))

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return the steps, of height one, (n, steps)."""
        *instants, tau = values.tolist()
        return lagged_steps(time, np.array(instants), tau).T

    def solved(self, coefficients: FloatArray, gain: float) -> dict[str, Solved]:  # noqa: ARG002
        """Return the heights, in the order of the instants."""
        return {name: (float(each), "PV") for name, each in zip(HEIGHTS, coefficients, strict=False)}

    def spotted(self, residual: FloatArray, facts: Facts) -> FloatArray:
        """Return for each of some lags the steps that leave least, one after the other, (m, steps + 1)."""
        first, last = EDGE * facts.duration, (1 - EDGE) * facts.duration
        time = np.asarray(facts.ts * np.arange(len(residual)), dtype=np.float64)
        known = np.isfinite(residual)
        instants = np.linspace(first, last, INSTANTS)
        found = []
        for tau in (lag * facts.period for lag in LAGS):
            scanned = lagged_steps(time, instants, tau).T[known]
            drift = np.stack((np.ones(len(scanned)), time[known]), axis=1)
            places: list[int] = []
            for _ in range(self.steps):
                besides = np.column_stack((drift, scanned[:, places]))
                places.append(_explains_most(scanned, besides, residual[known]))
            found.append((*instants[places], tau))
        return np.array(found)


def _explains_most(columns: FloatArray, besides: FloatArray, residual: FloatArray) -> int:
    """Return which column (n, k) explains most of a residual (n,) beside others, (n, m)."""
    basis, _ = np.linalg.qr(besides)
    left = residual - basis @ (basis.T @ residual)
    energy = np.einsum("ij,ij->j", columns, columns) - np.sum((basis.T @ columns) ** 2, axis=0)
    distinct = energy > LEAST_ENERGY * len(columns)
    return int(np.argmax(np.where(distinct, (columns.T @ left) ** 2 / np.where(distinct, energy, 1.0), 0.0)))

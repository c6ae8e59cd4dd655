"""The contour map: how well every valve of the bounded space explains a record.

Lee, Ren and Huang (2008), section V.D.2 and Fig. 3: a uniform grid over f_S and f_D for each structure of the
process, so that one sees whether a minimum stands alone. The error is that of ``lee2008``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import ndimage

from agent.analysis.quantify.processes.output_error import FIRST_ORDER, INTEGRATOR, SECOND_ORDER
from agent.analysis.quantify.valves.bounded_search import RESOLUTION, grid
from agent.analysis.quantify.valves.joint_fit import CentredRecord, free_delays, lack, structures_to_try
from agent.units import FrictionBands

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray, LoopWindow

KINDS = {INTEGRATOR: "integrator", FIRST_ORDER: "fopdt", SECOND_ORDER: "sopdt"}
ALIKE = 1.1
"""Errors up to this multiple of the least count as equally good (``methods.md`` 0.4): a level to look at."""
EXACT = 1e-12
"""Share of the variance of PV below which an error is rounding."""
WHOLE_NEIGHBOURHOOD = np.ones((3, 3))
"""Cells that touch by a corner belong to one basin."""


@dataclass(frozen=True, slots=True)
class ErrorMap:
    """Free-run error of each valve of the grid, with the best delay for each."""

    f_s: FloatArray
    """Rows of the map, OP units, (k,)."""
    f_d: FloatArray
    """Columns of the map, OP units, (k,)."""
    kinds: tuple[str, ...]
    """Structures of the process, as ``ProcessEstimate.kind``: one layer of the map each."""
    error: FloatArray
    """Mean squared error over that of the best cell, (structures, k, k).

    NaN outside f_D <= f_S, f_S + f_D <= span of OP; infinite where no process is plausible.
    """

    @property
    def best(self) -> tuple[str, FrictionBands]:
        """Structure and valve of the best cell."""
        layer = int(np.argmin(np.nanmin(self.error, axis=(1, 2))))
        return self.kinds[layer], self._lowest(self.error[layer])

    def basins(self, layer: int) -> tuple[FrictionBands, ...]:
        """Return the lowest cell of each basin of one structure, the best first.

        A basin is a connected set of cells that are as good as the best of the layer (``ALIKE``).
        """
        labels, count = ndimage.label(self._as_good(layer), WHOLE_NEIGHBOURHOOD)
        basins = [np.where(labels == basin, self.error[layer], np.inf) for basin in range(1, count + 1)]
        return tuple(self._lowest(basin) for basin in sorted(basins, key=np.min))

    def s_of_basins(self, layer: int) -> tuple[float, float]:
        """Return the least and the largest S = f_S + f_D in the basins of one structure, OP units."""
        row, column = np.nonzero(self._as_good(layer))
        s = self.f_s[row] + self.f_d[column]
        return float(s.min()), float(s.max())

    def _as_good(self, layer: int) -> NDArray[np.bool_]:
        error = self.error[layer]
        return np.asarray(np.isfinite(error) & (error <= ALIKE * np.nanmin(error)))

    def _lowest(self, error: FloatArray) -> FrictionBands:
        """Return the valve of the least error of one layer, (k, k)."""
        row, column = np.unravel_index(np.nanargmin(error), error.shape)
        return FrictionBands(float(self.f_s[row]), float(self.f_d[column]))


def error_map(window: LoopWindow, resolution: float = RESOLUTION) -> ErrorMap | None:
    """Return the map of a window, or None where nothing can be fitted to it.

    Args:
        window: The record; its hints bound the map as they bound ``lee2008``.
        resolution: Step of the grid, share of the span of OP; the paper takes 0.01 to 0.02.
    """
    if lack(window) is not None:
        return None
    structures = structures_to_try(window)
    delays = free_delays(window, structures) if window.hints.delay is None else np.array([window.hints.delay])
    bands = grid(window.op_span, resolution)
    record = CentredRecord.of(window)
    errors = np.maximum(record.errors(bands, delays, structures).min(axis=2), EXACT * record.variance)
    if not np.isfinite(errors).any():
        return None
    step = resolution * window.op_span
    cells = np.rint(bands / step).astype(int)
    k = int(cells.max()) + 1
    layers = np.full((len(structures), k, k), np.nan)
    layers[:, cells[:, 0], cells[:, 1]] = (errors / errors.min()).T
    axis: FloatArray = step * np.arange(k, dtype=np.float64)
    return ErrorMap(axis, axis, tuple(KINDS[each] for each in structures), layers)

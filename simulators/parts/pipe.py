"""A pipe along which what the valve lets through travels, with some mixing on its way."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.parameters import PipeParameters

    FloatArray = NDArray[np.float64]

CELLS = 60
"""Stirred cells in a row: a front is spread over 13 % of its time in the pipe."""
LEAST = 1e-3
"""Flow that leaks through a closed valve, OP units."""


@kernel
def through(cells: FloatArray, inlet: FloatArray, flow: FloatArray, share: float) -> FloatArray:
    """Move the contents of ``cells`` on by each step's ``flow`` (steps,); return what leaves, (steps,).

    ``share``: part of a cell that one unit of flow exchanges in a step.
    """
    outlet = np.empty(inlet.size)
    for t in range(inlet.size):
        part = min(share * max(flow[t], LEAST), 1.0)
        for i in range(cells.size - 1, 0, -1):
            cells[i] += part * (cells[i - 1] - cells[i])
        cells[0] += part * (inlet[t] - cells[0])
        outlet[t] = cells[-1]
    return outlet


class Pipe:
    """The pipe of one loop, moving through time; at first it is full of what flows at the operating point."""

    def __init__(self, parameters: PipeParameters, op: float, dt: float) -> None:
        self._open = op - parameters.no_flow
        self._share = CELLS * dt / parameters.volume
        self._cells = np.zeros(CELLS)

    def carry(self, flow: FloatArray) -> FloatArray:
        """Return what leaves for a ``flow`` (steps,), both as deviations from the operating point."""
        return through(self._cells, flow, flow + self._open, self._share)

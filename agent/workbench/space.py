"""The parameters of a model on the unit cube, where the search goes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from agent.jit import kernel

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Facts, Parameter
    from agent.physics.loop_model import LoopModel

AT_BOUND = 1e-3
"""Part of a range from its end within which a parameter stands at its bound."""


@dataclass(frozen=True, slots=True)
class Space:
    """Bounds of all parameters of a model; arrays in their order, (k,)."""

    names: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    low: FloatArray
    """Own units; logarithms where the parameter is searched by its logarithm. ``high`` likewise."""
    high: FloatArray
    log: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.names)

    @property
    def searched(self) -> int:
        """How many of them are searched."""
        return sum(not each.constant for each in self.parameters)

    def values(self, at: FloatArray) -> FloatArray:
        """Return the values, own units, of points of the unit cube, (..., k)."""
        points = np.ascontiguousarray(at, dtype=np.float64)
        rows = points.reshape(math.prod(points.shape[:-1]), len(self))
        return values_of(rows, self.low, self.high, self.log).reshape(points.shape)

    def at(self, values: FloatArray) -> FloatArray:
        """Return where values, own units, (..., k), lie in the unit cube; the nearest point of it."""
        inner = np.where(self.log, np.log(np.where(self.log, np.maximum(values, 1e-300), 1.0)), values)
        width = np.where(self.high > self.low, self.high - self.low, 1.0)
        return np.clip((inner - self.low) / width, 0.0, 1.0)

    def at_bound(self, values: FloatArray) -> tuple[str, ...]:
        """Return the names of parameters that ran into a bound of the search: a sign that they mean nothing.

        Where a record begins may lie anywhere, nature's bounds are no sign, at its null an effect is not
        there, and nothing is less than zero where the range begins there: a lag, a delay.
        """
        at = self.at(values)
        found = []
        for name, parameter, value in zip(self.names, self.parameters, at.tolist(), strict=True):
            end = parameter.low if value < AT_BOUND else parameter.high
            inside = AT_BOUND <= value <= 1 - AT_BOUND
            nature = parameter.natural or end == parameter.null or end == 0.0 == parameter.low
            if not (inside or parameter.of_record or parameter.constant or nature):
                found.append(name)
        return tuple(found)


@kernel
def values_of(
    points: NDArray[np.float64], low: NDArray[np.float64], high: NDArray[np.float64], log: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return ``Space.values`` of points (m, k): numpy takes longer to be called than to reckon."""
    values = np.empty(points.shape)
    for i in range(points.shape[0]):
        for k in range(points.shape[1]):
            inner = low[k] + min(max(points[i, k], 0.0), 1.0) * (high[k] - low[k])
            values[i, k] = math.exp(inner) if log[k] else inner
    return values


def space_of(model: LoopModel, facts: Facts) -> Space:
    """Return the space of a model's parameters on a record."""
    pairs = model.parameters(facts)
    parameters = tuple(parameter for _, parameter in pairs)
    log = np.array([each.log for each in parameters], dtype=np.bool_)
    ends = np.array([(each.low, each.high) for each in parameters], dtype=np.float64).reshape(-1, 2)
    ends[log] = np.log(ends[log])
    low, high = np.ascontiguousarray(ends.T)
    return Space(tuple(name for name, _ in pairs), parameters, low, high, log)

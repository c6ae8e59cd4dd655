"""What a fitted model would measure in a test that was not done, and how that moves with its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effects.gain_change import GainChange
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.library import happens_once

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.effect import Facts, Parameter
    from agent.physics.loop_model import LoopModel
    from agent.workbench.fit import Fit

    FloatArray = NDArray[np.float64]

STARTS = 5
"""Positions of a stem before the test that are looked at: nobody knows where it stands."""
DIFFERENCE = 1e-3
"""Step of derivatives, part of a parameter's range."""


@dataclass(frozen=True, slots=True)
class Rival:
    """A model with its numbers, less what stands still in a test.

    What happened once is over: a load stays where it is, another gain stays. A measured input is held.
    """

    model: LoopModel
    facts: Facts
    """Of the record."""
    values: FloatArray
    """Own units, (k,)."""
    coefficients: FloatArray
    """Of the response, then of what goes on."""
    parameters: tuple[Parameter, ...]
    starts: tuple[int, ...]
    """Which values say where an effect was at first."""
    held: tuple[str, ...]
    """Measured inputs that have to stand still."""

    @property
    def name(self) -> str:
        """Its last effect, or its base."""
        return self.model.effects[-1].name if self.model.effects else self.model.base.name

    def prediction(self, op: FloatArray, values: FloatArray) -> FloatArray:
        """Return PV less its level for a new OP, PV units, (n,)."""
        return np.asarray(self.model.columns(op, values, self.facts) @ self.coefficients, dtype=np.float64)

    def predictions(self, op: FloatArray) -> FloatArray:
        """Return it for each position before the test, (m, n)."""
        found = []
        for share in np.linspace(0.0, 1.0, STARTS) if self.starts else (0.5,):
            values = self.values.copy()
            for at in self.starts:
                each = self.parameters[at]
                values[at] = each.low + share * (each.high - each.low)
            found.append(self.prediction(op, values))
        return np.array(found)

    def sensitivity(self, op: FloatArray) -> FloatArray:
        """Return how PV moves with each number but a start, over its range, and with the gain, (n, j)."""
        columns = []
        for at, each in enumerate(self.parameters):
            if at in self.starts:
                continue
            step = DIFFERENCE * (self.values[at] if each.log else each.high - each.low)
            up = self.values.copy()
            up[at] += step if up[at] + step <= each.high else -step
            moved = self.prediction(op, up) - self.prediction(op, self.values)
            columns.append(moved / DIFFERENCE)
        columns.append(self.coefficients[0] * self.model.columns(op, self.values, self.facts)[:, 0])
        return np.column_stack(columns)


def rival_of(fitted: Fit, facts: Facts) -> Rival:
    """Return a fitted model as it will go on; ``facts`` are those of its record."""
    model = fitted.model
    held = tuple(each.name for each in model.effects if isinstance(each, MeasuredInput))
    still = {*held, *(each.name for each in model.effects if happens_once(each, facts))}
    changed = {each.name for each in model.effects if isinstance(each, GainChange)}
    kept = replace(model, effects=tuple(each for each in model.effects if each.name not in still))
    names = [name.partition(".")[0] if "." in name else "" for name, _ in model.parameters(facts)]
    values = fitted.values[[each not in still for each in names]]
    op = np.linspace(facts.op_low, facts.op_high, facts.samples)
    owners = model.layout(facts).owners(op, fitted.values)
    pairs = list(zip(owners, fitted.coefficients.tolist(), strict=True))
    gain = sum(each for owner, each in pairs if owner == "" or owner in changed)
    rest = [each for owner, each in pairs if owner != "" and owner not in still]
    parameters = tuple(each for _, each in kept.parameters(facts))
    starts = tuple(at for at, each in enumerate(parameters) if each.of_record)
    return Rival(kept, facts, values, np.array([gain, *rest]), parameters, starts, held)

"""A measured load, or a second actuator: it acts on PV through gain, dead time and lag of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.identify.problem import bridge
from agent.physics.bases.lag_bases import delay_of, lag_of
from agent.physics.effect import Effect, Facts, Parameter, Solved, Stage
from agent.physics.processes.lag import lag_of_lines

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from agent.analysis.record.recording import FloatArray
    from agent.physics.loop_model import LoopModel

FAMILY = "measured_input"


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredInput:
    """One input. It needs no OP, so that it explains what OP only answers to; its gain is solved for."""

    name: str
    values: FloatArray
    """At the samples of the record, its own unit, (n,); a straight line through each gap."""
    elsewhere: FloatArray | None = None
    """At the samples of the recording for validation, (m,); None where that does not have it."""
    family: str = FAMILY
    stage: Stage = "disturbance"
    bases: tuple[str, ...] = ()

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return dead time and lag. Both may be zero: physics sets these bounds, not the search."""
        delay, lag = delay_of(facts), lag_of("lag", facts)
        return (
            Parameter("delay", "s", 0.0, delay.high, natural=True),
            Parameter("lag", "s", lag.low, lag.high, log=True, natural=True),
        )

    def solved(self, coefficients: FloatArray, gain: float) -> dict[str, Solved]:  # noqa: ARG002
        """Return the gain from the input to PV, PV units per unit of the input."""
        return {"gain": (float(coefficients[0]), "PV/1")}

    def columns(self, time: FloatArray, response: FloatArray, values: FloatArray) -> FloatArray:  # noqa: ARG002
        """Return the input behind its dead time and lag, its own unit about its mean, (n, 1)."""
        delay, lag = (float(each) for each in values)
        ts = float(time[1] - time[0])
        column = np.empty_like(self.values)
        lag_of_lines(self.values, float(self.values.mean()), lag / ts, delay / ts, column)
        return column[:, np.newaxis]


def measured_inputs(
    inputs: Mapping[str, FloatArray],
    elsewhere: Mapping[str, FloatArray],
    samples: int,
    names: Collection[str],
) -> tuple[MeasuredInput, ...]:
    """Return the inputs as effects.

    Args:
        inputs: At the samples of the record, (n,), NaN where missing.
        elsewhere: The same at those of the recording for validation.
        samples: Of the record, n.
        names: Of the effects that there are.

    Raises:
        ValueError: One has a name that is in use or no identifier, another length, or does not move.
    """
    found = []
    for name, values in inputs.items():
        if not name.isidentifier() or name in names:
            raise ValueError(f"an input cannot be named {name!r}: that is an effect, or no word of letters")
        if len(values) != samples:
            raise ValueError(f"input {name} has {len(values)} samples, OP has {samples}")
        known = values[np.isfinite(values)]
        if not known.size or np.ptp(known) == 0.0:
            raise ValueError(f"input {name} does not move")
        other = elsewhere.get(name)
        found.append(MeasuredInput(name, bridge(values), None if other is None else bridge(other)))
    return tuple(found)


def elsewhere(model: LoopModel) -> LoopModel:
    """Return a model with its inputs as the recording for validation has them.

    Raises:
        ValueError: That recording does not have one of them.
    """
    effects: list[Effect] = []
    for each in model.effects:
        if isinstance(each, MeasuredInput):
            if each.elsewhere is None:
                raise ValueError(f"the recording for validation has no input {each.name}")
            effects.append(replace(each, values=each.elsewhere))
        else:
            effects.append(each)
    return replace(model, effects=tuple(effects))


def at_home(model: LoopModel) -> LoopModel:
    """Return a model of a recording, to be scored on that one with numbers that were fitted to others."""
    own = (
        replace(each, elsewhere=each.values) if isinstance(each, MeasuredInput) else each
        for each in model.effects
    )
    return replace(model, effects=tuple(own))

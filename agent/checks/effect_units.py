"""An effect must be the same physics in any unit: OP in per cent or mA, time in seconds or minutes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.checks.contract import demand, require_close, where
from agent.checks.effect_record import FACTS, OP, inner
from agent.physics.bases import BASES
from agent.physics.loop_model import LoopModel
from agent.workbench.library import applies

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.effect import Effect, Facts

    FloatArray = NDArray[np.float64]

OP_FACTOR = 4.0
"""A power of two, so that no rounding lets a stem slip that grazes its threshold."""
TIME_FACTOR = 64.0
OP_POWER = {"OP": 1, "OP/s": 1, "OP*s": 1, "1/OP": -1, "PV/s/OP": -1, "1/s/OP": -1}
SECOND_POWER = {"s": 1, "OP*s": 1, "1/s": -1, "OP/s": -1, "PV/s": -1, "PV/s/OP": -1, "1/s/OP": -1}
SHARE = 0.3
"""Of the range of each parameter."""
TOLERANCE = 1e-9


@demand("effect", "must give the same in other units of OP")
def op_in_other_units(effect: Effect) -> None:
    """Multiply OP by four."""
    scaled = replace(
        FACTS,
        op_low=OP_FACTOR * FACTS.op_low,
        op_high=OP_FACTOR * FACTS.op_high,
        op_speed=OP_FACTOR * FACTS.op_speed,
    )
    for base in BASES:
        if applies(effect, base):
            gain = OP_FACTOR if base.linear else 1.0
            with where(f"on {base.name}"):
                _same(
                    LoopModel(base, (effect,), unguarded=True),
                    scaled,
                    OP_FACTOR * OP,
                    OP_POWER,
                    OP_FACTOR,
                    gain,
                )


@demand("effect", "must give the same in other units of time")
def time_in_other_units(effect: Effect) -> None:
    """Sample 64 times more slowly a record that is as much slower."""
    scaled = replace(
        FACTS,
        ts=TIME_FACTOR * FACTS.ts,
        period=TIME_FACTOR * FACTS.period,
        op_speed=FACTS.op_speed / TIME_FACTOR,
    )
    for base in BASES:
        if applies(effect, base):
            gain = TIME_FACTOR if base.name in {"integrator", "lags_integrator"} else 1.0
            with where(f"on {base.name}"):
                _same(LoopModel(base, (effect,), unguarded=True), scaled, OP, SECOND_POWER, TIME_FACTOR, gain)


def _same(
    model: LoopModel, facts: Facts, op: FloatArray, powers: Mapping[str, int], factor: float, gain: float
) -> None:
    """Go on where a model of scaled facts and OP is the model times ``gain``."""
    values = inner(model, SHARE)
    power = np.array([powers.get(each.unit, 0) for _, each in model.parameters(FACTS)])
    converted = values * factor**power
    require_close(inner(model, SHARE, facts), converted, "the value by its bounds", rtol=1e-7)
    before, now = model.columns(OP, values, FACTS), model.columns(op, converted, facts)
    require_close(now[:, 0], gain * before[:, 0], "the response", rtol=TOLERANCE, atol=TOLERANCE)
    for at, (one, other) in enumerate(zip(now.T[1:], before.T[1:], strict=True)):
        found, expected = one / np.linalg.norm(one), other / np.linalg.norm(other)
        require_close(found, expected, f"column {at} that it adds", atol=TOLERANCE)

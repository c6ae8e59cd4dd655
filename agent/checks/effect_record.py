"""The record that effects are checked on, and values within the bounds that it gives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import Facts

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from agent.physics.loop_model import LoopModel

    FloatArray = NDArray[np.float64]

SAMPLES = 400


def _moving_op() -> FloatArray:
    """Return steps, ramps and turns between 30 and 70 OP units, (400,)."""
    random = np.random.default_rng(3)
    levels = np.repeat(random.uniform(30, 70, SAMPLES // 25 + 1), 25)
    return np.convolve(levels, np.full(8, 1 / 8), mode="valid")[:SAMPLES]


OP = _moving_op()
FACTS = Facts(
    ts=2.0,
    samples=SAMPLES,
    op_low=float(OP.min()),
    op_high=float(OP.max()),
    pv_low=2.0,
    pv_high=9.0,
    period=60.0,
    op_speed=float(np.abs(np.diff(OP)).mean() / 2.0),
    gain_sign=1,
)


def inner(model: LoopModel, share: ArrayLike, facts: Facts = FACTS) -> FloatArray:
    """Return values that stand at a share of each range, of its logarithm where that is searched."""
    parameters = [each for _, each in model.parameters(facts)]
    shares = np.broadcast_to(np.asarray(share, np.float64), len(parameters))
    return np.array(
        [
            each.low * (each.high / each.low) ** part
            if each.log
            else each.low + part * (each.high - each.low)
            for each, part in zip(parameters, shares, strict=True)
        ]
    )

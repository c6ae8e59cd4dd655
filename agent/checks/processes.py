"""What the contract of a process between valve and PV demands: ``agent.physics.processes.Process``."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from agent.checks.contract import ContractError, demand, require, require_close, where

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.processes import UnitGainProcess

    FloatArray = NDArray[np.float64]

DELAYS = (1.0, 1.37, 4.0, 8.9)
"""Samples; whole ones and not."""
LAGS = (6.0, 2.5, 1.2)
"""Lags that a process is checked with, samples, the largest first."""
ROUNDING = 1e-9
"""OP units by which two ways to compute the same response may differ."""


def stairs(seed: int, n: int = 200) -> FloatArray:
    """Return the position of a valve that moves every fourth sample, about 50 OP units, (n,)."""
    return 50 + np.repeat(5 * np.random.default_rng(seed).standard_normal(n // 4), 4)


def lags_of(process: UnitGainProcess) -> tuple[float, ...]:
    """Return values of all parameters but the delay, which is the last."""
    return LAGS[: len(process.parameters) - 1]


def _integrates(process: UnitGainProcess) -> bool:
    return len(process.parameters) == 1


@demand("process", "must be linear in the position")
def linear(process: UnitGainProcess) -> None:
    """Hold the response to a sum of two positions to the sum of their responses."""
    one, other = stairs(1), stairs(2)
    for delay in DELAYS:
        parameters = (*lags_of(process), delay)
        both = process.respond(3 * one - 0.5 * other, parameters)
        apart = 3 * process.respond(one, parameters) - 0.5 * process.respond(other, parameters)
        with where(f"delay {delay:g} samples"):
            require_close(both, apart, "the response to a sum", atol=ROUNDING)


@demand("process", "must respond the same at any time and level")
def time_invariant(process: UnitGainProcess) -> None:
    """Shift a position in time and in level."""
    position = stairs(1)
    later = np.concatenate([np.full(17, position[0]), position]) - 1000
    for delay in DELAYS:
        parameters = (*lags_of(process), delay)
        response = process.respond(later, parameters)
        with where(f"delay {delay:g} samples"):
            require_close(response[:17], np.zeros(17), "the response before the first move", atol=ROUNDING)
            require_close(
                response[17:], process.respond(position, parameters), "the later response", atol=ROUNDING
            )


@demand("process", "must start after its delay and end at gain, or slope, one")
def delay_and_gain(process: UnitGainProcess) -> None:
    """Look at a step of 2 OP units."""
    step = np.where(np.arange(200) < 5, 50.0, 52.0)
    for delay in DELAYS:
        response = process.respond(step, (*lags_of(process), delay))
        first = 5 + int(delay)  # the step is in position(5)
        with where(f"delay {delay:g} samples"):
            require(not response[:first].any(), "PV moves before the delay is over")
            require(response[first] > 0, "PV does not move when the delay is over")
            end = 2 * (199 - 5 - (delay - 1)) if _integrates(process) else 2.0
            require_close(response[-1], end, "the end of a step of 2", rtol=1e-6, atol=ROUNDING)


@demand("process", "must be smooth where the delay becomes a whole sample")
def smooth_in_the_delay(process: UnitGainProcess) -> None:
    """Move the delay by very little."""
    position = stairs(1)
    for delay in (2.0, 3.0, 7.0):
        at = process.respond(position, (*lags_of(process), delay))
        for nudge in (-1e-7, 1e-7):
            near = process.respond(position, (*lags_of(process), delay + nudge))
            with where(f"delay {delay:g} samples, nudged by {nudge:g}"):
                require_close(near, at, "the response", atol=1e-4)


@demand("process", "must give NaN from a missing position on, and nothing before")
def missing_position(process: UnitGainProcess) -> None:
    """Lose one position."""
    position = stairs(1)
    position[40] = np.nan
    response = process.respond(position, (*lags_of(process), 3.5))
    require(np.isfinite(response[:43]).all(), "PV is missing before the missing position arrives")
    require(np.isnan(response[43:]).all(), "PV is a number after a missing position has arrived")


@demand("process", "must give no response to a delay beyond the record, nor to an empty record")
def beyond_the_record(process: UnitGainProcess) -> None:
    """Check a delay of 1e6 samples and a record of none."""
    lags = lags_of(process)
    late = process.respond(stairs(1), (*lags, 1e6))
    require_close(late, np.zeros(200), "the response before the delay", atol=ROUNDING)
    empty = process.respond(np.empty(0), (*lags, 3.0)).shape
    require(empty == (0,), f"an empty record gives shape {empty}")


@demand("process", "must count its response from the level that its kernel is given")
def level_of_the_kernel(process: UnitGainProcess) -> None:
    """Give the kernel another level than that of the first sample: an integrator ramps then."""
    position, out, delay = stairs(1), np.empty(200), 3.5
    process.kernel(position, position[0] - 2, *lags_of(process), delay, out)
    added: Any = 2 * np.maximum(0, np.arange(200) - (delay - 1)) if _integrates(process) else 2.0
    expected = process.respond(position, (*lags_of(process), delay)) + added
    require_close(out, expected, "the response of the kernel", atol=ROUNDING)


@demand("process", "must refuse a parameter out of bounds with a ValueError that names it")
def bounds(process: UnitGainProcess) -> None:
    """Break each bound, and the number of parameters."""
    lags = lags_of(process)
    for bad in (0.5, np.nan, np.inf):
        _refused(lambda bad=bad: process.respond(stairs(1), (*lags, bad)), "delay")  # type: ignore[misc]
    for at, parameter in enumerate(process.parameters[:-1]):
        values = (*lags[:at], 0.01, *lags[at + 1 :], 3.0)
        _refused(lambda values=values: process.respond(stairs(1), values), parameter.name)  # type: ignore[misc]
    _refused(lambda: process.respond(stairs(1), (1.0,) * (len(process.parameters) + 2)), "parameters")


def _refused(call: Callable[[], object], word: str) -> None:
    try:
        call()
    except ValueError as error:
        require(word in str(error), f"the refusal does not name {word!r}: {error}")
        return
    raise ContractError(f"a bad value of {word!r} is accepted")


CHECKS = (
    linear,
    time_invariant,
    delay_and_gain,
    smooth_in_the_delay,
    missing_position,
    beyond_the_record,
    level_of_the_kernel,
    bounds,
)
"""All checks of a process."""

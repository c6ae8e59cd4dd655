"""Calls of effects that others wrote: what they return is checked in each fit, what they raise is named."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.physics.effect import Effect

    FloatArray = NDArray[np.float64]

Returned = TypeVar("Returned")


class EffectError(ValueError):
    """An effect that others wrote failed in a fit; the text has its name, file and the contract."""


def result_of(effect: Effect, call: Callable[[], Returned]) -> Returned:
    """Return what a call of an effect returns.

    Raises:
        EffectError: The effect is not built in and raised something.
    """
    if is_built_in(effect):
        return call()
    try:
        return call()
    except Exception as error:  # the code of somebody else may raise anything
        words = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise EffectError(f"{subject(effect)} must not raise; it raised {words}") from error


def array_of(effect: Effect, samples: int, call: Callable[[], FloatArray]) -> FloatArray:
    """Return the array that a call of an effect returns, one row a sample.

    Raises:
        EffectError: The effect is not built in, and raised something or returned something else.
    """
    found = result_of(effect, call)
    if is_built_in(effect):
        return found
    if not isinstance(found, np.ndarray) or len(found) != samples:
        shape = getattr(found, "shape", type(found).__name__)
        raise EffectError(f"{subject(effect)} must return {samples} samples; it returned {shape}")
    if not np.isfinite(found).all():
        raise EffectError(f"{subject(effect)} must return finite numbers within all its bounds; one is not")
    return found


def is_built_in(effect: Effect) -> bool:
    """Return whether an effect comes with slipjump; its contract is tested."""
    return type(effect).__module__.startswith("agent.")


def subject(effect: Effect) -> str:
    """Return the name of an effect and its file."""
    return f"effect {effect.name} ({file_of(effect)})"


def file_of(member: object) -> str:
    """Return the file of a member's class; its module where it has none."""
    try:
        return inspect.getfile(type(member))
    except (TypeError, OSError):
        return type(member).__module__

"""What the effects of friction and slack share: where the stem rests at first, and values from bands."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

from agent.physics.effect import Facts, Parameter, ValveEffect

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.units import FrictionBands

    FloatArray = NDArray[np.float64]


@runtime_checkable
class HysteresisEffect(ValveEffect, Protocol):
    """A valve that answers OP by which way OP came; its error over S and J is a needle."""

    def values_of(self, bands: FrictionBands, start: float) -> FloatArray:
        """Return the values of this effect, in their order, nearest to a valve with ``bands``.

        ``start`` is as in ``start_of``.
        """
        ...


def start_of(facts: Facts) -> Parameter:
    """OP at the first slip less OP at the first sample; below 0 that slip is downward.

    Not where the stem rests: with this one S and J may change without moving the first slip, so that a search
    stays in its basin (docs/methods/free_run.md).
    """
    return Parameter("start", "OP", -facts.op_span, facts.op_span, of_record=True)


def rest_before(op: float, f_s_up: float, f_s_down: float, start: float) -> float:
    """Return where a stem rests before the first sample, OP units; friction holds it there.

    Args:
        op: First OP, OP units.
        f_s_up: Static friction against a rising stem, OP units.
        f_s_down: Static friction against a falling stem, OP units.
        start: As in ``start_of``, OP units.
    """
    rest = op + start - f_s_up if start >= 0.0 else op + start + f_s_down
    return min(max(rest, op - f_s_up), op + f_s_down)

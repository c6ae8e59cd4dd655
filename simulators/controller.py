"""The PI controller of the DCS: position form, limited, without wind-up."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from simulators.parameters import ControllerParameters


class Controller:
    """Samples PV and sets OP once per sampling time."""

    def __init__(self, parameters: ControllerParameters, op_range: tuple[float, float], ts: float) -> None:
        self._gain = parameters.kc if parameters.acting == "reverse" else -parameters.kc
        self._step = ts / parameters.ti
        self._low, self._high = op_range
        self._integral = parameters.op
        self._feed_forward = parameters.feed_forward

    def update(self, sp: float, pv: float, load: float = 0.0) -> float:
        """OP for the coming sampling time, OP units; ``sp`` and ``pv`` in PV units, the load in OP units."""
        pull = self._gain * (sp - pv)
        integral = self._integral + self._step * pull
        wanted = pull + integral - self._feed_forward * load
        op = min(max(wanted, self._low), self._high)
        if (wanted - op) * pull <= 0.0:  # at a limit the integral may only lead away from it
            self._integral = integral
        return op

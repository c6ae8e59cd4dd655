"""The interface of every stiction law."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.units import FrictionBands


class StictionLaw(Protocol):
    """Gives the valve position from OP alone. Compiled searches call the law's kernel instead."""

    @property
    def name(self) -> str:
        """Short name, that of the kernel and of the docs page."""
        ...

    @property
    def reference(self) -> str:
        """Where it is published."""
        ...

    def position(self, op: NDArray[np.float64], bands: FrictionBands, x0: float) -> NDArray[np.float64]:
        """Return the valve positions, OP units, shape (n,), from OP, OP units, shape (n,), NaN where missing.

        ``x0`` is the position of the resting stem before the first sample, OP units.
        """
        ...

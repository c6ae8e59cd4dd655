"""The interface of every process base of the workbench."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, runtime_checkable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from agent.physics.effect import Facts, Parameter

    FloatArray = NDArray[np.float64]


class RespondingProcess(Protocol):
    """A process with all its numbers."""

    def respond(self, position: FloatArray, ts: float) -> FloatArray:
        """Return PV, or its deviation for gain one where the base is linear, (n,)."""
        ...


class Base(Protocol):
    """The kind of process that a model begins with."""

    @property
    def name(self) -> str:
        """As the command line calls it."""
        ...

    @property
    def linear(self) -> bool:
        """Whether PV is gain times response plus level; otherwise the response is PV itself."""
        ...

    def parameters(self, facts: Facts) -> tuple[Parameter, ...]:
        """Return what is searched, with bounds that fit the record."""
        ...

    def process(self, values: FloatArray) -> RespondingProcess:
        """Return the process with these values."""
        ...


@runtime_checkable
class StartingBase(Protocol):
    """A base that gives its own start values for a fit, better than random ones."""

    def starts(self, op: FloatArray, pv: FloatArray, facts: Facts) -> FloatArray:
        """Return values (m, k) in the order of ``parameters``; OP and PV (n,) without gaps."""
        ...

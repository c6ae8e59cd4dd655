"""Numbers of many tags in one piece: what one request of a field bus brings, without an object for each."""

from __future__ import annotations

from collections.abc import AsyncGenerator, AsyncIterator
from contextlib import aclosing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from connectors.base import LoopRole, Order, Sample, Session

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Readings:
    """Values of many tags, all measured at one time."""

    tags: tuple[LoopRole, ...]
    """Those of a loop side by side. A session gives the same object again for the same tags."""
    time: float
    """Source time, s UTC."""
    values: NDArray[np.float64]
    """A value of each tag, shape (tags,). NaN and infinity count as missing."""

    def samples(self) -> list[Sample]:
        """Return a sample for each tag."""
        pairs = zip(self.tags, self.values.tolist(), strict=True)
        return [Sample.measured(tag, self.time, value) for tag, value in pairs]


@runtime_checkable
class ReadsTogether(Protocol):
    """A session that can also give what came in one piece as such."""

    def readings(self) -> AsyncIterator[Sample | Order | Readings]:
        """Yield the same as ``samples``, in fewer pieces; raises ConnectionLostError."""
        ...


def incoming(session: Session) -> AsyncIterator[Sample | Order | Readings]:
    """Return what comes in, in as few pieces as the session can give."""
    return session.readings() if isinstance(session, ReadsTogether) else session.samples()


async def one_by_one(pieces: AsyncGenerator[Sample | Order | Readings]) -> AsyncIterator[Sample | Order]:
    """Yield samples in place of readings."""
    async with aclosing(pieces):
        async for each in pieces:
            if isinstance(each, Readings):
                for sample in each.samples():
                    yield sample
            else:
                yield each

"""Loops that were read of a file, in a temporary file where they are large; each comes back when needed."""

from __future__ import annotations

import pickle
from collections.abc import Sequence
from typing import Protocol, TypeVar, overload

from connectors.exports.tables.spool import Spool


class _Named(Protocol):
    @property
    def name(self) -> str: ...


LoopT = TypeVar("LoopT", bound=_Named)


class StoredLoops(Sequence[LoopT]):
    """A sequence of loops of which only the names are in memory."""

    def __init__(self) -> None:
        """Make an empty one."""
        self._spool = Spool()
        self._places: list[tuple[int, int]] = []
        self.names: tuple[str, ...] = ()
        """Of the loops, in their order."""

    def append(self, loop: LoopT) -> None:
        """Take one more."""
        text = pickle.dumps(loop, pickle.HIGHEST_PROTOCOL)
        self._places.append((self._spool.put(text), len(text)))
        self.names = (*self.names, loop.name)

    def __len__(self) -> int:
        """Loops."""
        return len(self._places)

    @overload
    def __getitem__(self, place: int) -> LoopT: ...

    @overload
    def __getitem__(self, place: slice) -> Sequence[LoopT]: ...

    def __getitem__(self, place: int | slice) -> LoopT | Sequence[LoopT]:
        """Return a loop, or several."""
        if isinstance(place, slice):
            return [self[k] for k in range(len(self))[place]]
        loop: LoopT = pickle.loads(self._spool.get(*self._places[place]))  # noqa: S301 - put above
        return loop

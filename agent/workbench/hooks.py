"""What a session is handed: how to work on many trials, and who is informed of what is tried."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Protocol, TypeVar

Given = TypeVar("Given")
Found = TypeVar("Found")


class Map(Protocol):
    """``map``, or that of a pool of processes."""

    def __call__(self, function: Callable[[Given], Found], given: Iterable[Given], /) -> Iterable[Found]:
        """Yield the results in the order of ``given``."""
        ...


class Progress(Protocol):
    """Informed of what is tried next."""

    def __call__(self, what: str, done: int, of: int, /) -> None:
        """Say that ``what`` is being tried and that ``done`` ``of`` all are done."""
        ...


def silent(what: str, done: int, of: int, /) -> None:
    """Inform nobody."""

"""The interface of every place where recorded loops lie: which loops are there, and one of them read."""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Protocol, Self

if TYPE_CHECKING:
    from connectors.exports.recorded import RecordedLoop


@dataclass(frozen=True, slots=True)
class Held:
    """What a source holds."""

    loops: tuple[str, ...]
    """Names of its loops that have OP and PV, in its own order, each once."""
    problems: tuple[str, ...] = ()
    """What was left out, a line each."""


class LoopSource(Protocol):
    """An open source. Its methods block, and raise ConfigError where it cannot be read.

    A fault names the source and the line, row or tag; it never holds a password.
    """

    def loops(self) -> Held:
        """Return the names of the loops."""
        ...

    def read(self, loop: str) -> RecordedLoop:
        """Return one loop on its own times, as it stands in the source."""
        ...

    def version(self) -> str:
        """Return what changes where the content may have changed; the same for one that only grows."""
        ...

    def close(self) -> None:
        """Let go of files and connections; a second time does nothing."""
        ...

    def __enter__(self) -> Self:
        """Return itself."""
        ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        ...


class Closing:
    """A source as a context manager."""

    def close(self) -> None:
        """Let go of nothing: for sources that keep nothing open."""

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

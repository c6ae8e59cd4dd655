"""Where the tasks of a survey run: any number of processes, of this machine or of others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True)
class Done(Generic[T, R]):
    """The end of one task."""

    task: T
    result: R | None
    """None where it failed."""
    fault: str = ""
    """Why it failed, in words; empty where it did not."""


class BatchExecutor(Protocol):
    """Runs one function on many tasks.

    Each task ends exactly once, with its result or with a fault, also where the process that worked on it
    died: then it is repeated elsewhere. Tasks are taken from the iterable as they are needed, results come in
    the order in which they are ready.
    """

    def results(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[Done[T, R]]:
        """Yield the end of each task.

        Args:
            function: Module-level, so that it can be pickled; it never returns None.
            tasks: Its arguments; they can be pickled.

        Raises:
            ConfigError: There is nothing to run on (any more).
        """
        ...


def fault_of(error: BaseException) -> str:
    """Return one line that says what ended a task."""
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}" if words else type(error).__name__

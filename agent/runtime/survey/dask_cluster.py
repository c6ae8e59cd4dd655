"""The workers of a dask scheduler, on this machine or on others."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError
from itertools import islice
from typing import TYPE_CHECKING, Any, TypeVar

from agent.runtime.survey.executor import Done, fault_of
from connectors.base import ConfigError

if TYPE_CHECKING:
    from distributed import Client

T = TypeVar("T")
R = TypeVar("R")
AHEAD = 4
"""Tasks that the scheduler has for each thread of its workers: more would only take its memory."""
LEAST = 16
"""Tasks that it has at least: workers may join later."""
PATIENCE = 30.0
"""Longest time for the scheduler to answer, s."""
LOST = "the connection to the scheduler was lost; the same command goes on where it was interrupted"


class DaskCluster:
    """A scheduler by its address. It repeats a task whose worker died, three times by default.

    Workers need the same slipjump, the files at the same paths, and the credentials of historians.
    """

    def __init__(self, address: str) -> None:
        """Make it.

        Args:
            address: ``tcp://host:8786``, ``tls://host:8786``.

        Raises:
            ConfigError: The extra ``cluster`` is not installed.
        """
        try:
            import distributed  # noqa: F401, PLC0415 - an extra
        except ModuleNotFoundError as error:
            raise ConfigError(["--cluster needs the extra: pip install 'slipjump[cluster]'"]) from error
        self._address = address

    def results(self, function: Callable[[T], R], tasks: Iterable[T]) -> Iterator[Done[T, R]]:
        """Yield the end of each task; see ``BatchExecutor``."""
        from distributed import Client  # noqa: PLC0415 - an extra

        coming = iter(tasks)
        try:
            client = Client(self._address, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise ConfigError([f"--cluster {self._address}: {fault_of(error)}"]) from error
        with client:
            yield from self._results(client, function, coming)

    def _results(
        self, client: Client, function: Callable[[T], R], coming: Iterator[T]
    ) -> Iterator[Done[T, R]]:
        from distributed import as_completed  # noqa: PLC0415 - an extra

        running: dict[Any, T] = {}
        # The scheduler blames each task of a worker that died: one at a time shows which it was.
        suspects: list[T] = []
        alone = False
        ready = as_completed(loop=client.loop)
        while True:
            wanted = max(LEAST, AHEAD * self._threads(client)) - len(running)
            begun = list(islice(coming, max(0, wanted)))
            if not running and not begun:
                if not suspects:
                    return
                begun, alone = [suspects.pop()], True
            for task in begun:
                future = client.submit(function, task, pure=False)
                running[future] = task
                ready.add(future)
            future = next(ready)
            task = running.pop(future)
            if not alone and _killed_its_worker(future):
                suspects.append(task)
            else:
                yield self._done(client, task, future)

    def _done(self, client: Client, task: T, future: Any) -> Done[T, R]:  # noqa: ANN401 - untyped
        try:
            result: R = future.result()
        except CancelledError as error:
            raise ConfigError([f"--cluster {self._address}: {LOST}"]) from error
        except Exception as error:
            if client.status != "running":
                raise ConfigError([f"--cluster {self._address}: {LOST}"]) from error
            return Done(task, None, fault_of(error))
        return Done(task, result)

    def _threads(self, client: Client) -> int:
        try:
            return sum(client.nthreads().values())
        except OSError as error:
            raise ConfigError([f"--cluster {self._address}: {LOST}"]) from error


def _killed_its_worker(future: Any) -> bool:  # noqa: ANN401 - untyped
    """Whether the scheduler gave a task up because its workers died."""
    from distributed import KilledWorker  # noqa: PLC0415 - an extra

    return future.status == "error" and isinstance(future.exception(), KilledWorker)

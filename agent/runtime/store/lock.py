"""One agent per state file: two would both publish, and each would overwrite the other's state."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from agent.runtime.capabilities import try_lock
from connectors.base import ConfigError

LOG = logging.getLogger(__name__)


@contextmanager
def only_agent_of(state: Path | None) -> Iterator[None]:
    """Hold the lock of a state file, ``NAME.lock`` beside it; raises ConfigError where another agent does.

    The kernel lets go of it when the process ends, however it ends; the file stays and means nothing by
    itself. A file of its own, because SQLite loses its locks where a process closes its file once more. An
    agent that keeps nothing (None) needs no lock.
    """
    if state is None:
        yield
        return
    own = state.resolve()  # through a symlink it is the same file, and the same lock
    path = own.with_name(f"{own.name}.lock")
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        _warn_unlocked(path, error)
        yield
        return
    try:
        try:
            if not try_lock(handle):
                raise ConfigError([f"{state}: is used by another agent{_holder(handle)}"])
            os.ftruncate(handle, 0)
            os.lseek(handle, 0, os.SEEK_SET)
            os.write(handle, f"{os.getpid()}\n".encode())
        except OSError as error:
            _warn_unlocked(path, error)
        yield
    finally:
        os.close(handle)


def _holder(handle: int) -> str:
    os.lseek(handle, 0, os.SEEK_SET)
    holder = os.read(handle, 20).decode("ascii", "replace").strip()
    return f", process {holder}" if holder.isdigit() else ""


def _warn_unlocked(path: Path, error: OSError) -> None:
    """Log it only: as with the state file itself, a disk failure must not stop the agent."""
    LOG.warning("%s: %s; cannot check whether another agent uses the same state", path, error.strerror)

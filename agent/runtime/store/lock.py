"""One program per file that it keeps: two agents would both publish, and overwrite each other's state."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from agent.runtime.capabilities import try_lock
from connectors.base import ConfigError

LOG = logging.getLogger(__name__)
LOOK = 0.1
"""Time between two looks of a program that waits for the end of another one, s."""


@contextmanager
def only_agent_of(state: Path | None, *, wait: bool = False) -> Iterator[None]:
    """Hold the lock of a state file; where another agent does, raise ConfigError or wait until it ends.

    An agent that keeps nothing (None) needs no lock.
    """
    if state is None:
        yield
        return
    with only_user_of(state, "agent", wait=wait):
        yield


@contextmanager
def only_user_of(file: Path, who: str, *, wait: bool = False) -> Iterator[None]:
    """Hold the lock of a file, ``NAME.lock`` beside it; raises ConfigError where another process does.

    The kernel lets go of it when the process ends, however it ends; the file stays and means nothing by
    itself. A file of its own, because SQLite loses its locks where a process closes its file once more.

    Args:
        file: What is used by one process at a time.
        who: What such a process is called.
        wait: Until the other process ends.
    """
    own = file.resolve()  # through a symlink it is the same file, and the same lock
    path = own.with_name(f"{own.name}.lock")
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
    except OSError as error:
        _warn_unlocked(path, who, error)
        yield
        return
    try:
        try:
            while not try_lock(handle):
                if not wait:
                    raise ConfigError([f"{file}: is used by another {who}{_holder(handle)}"])
                time.sleep(LOOK)
            os.ftruncate(handle, 0)
            os.lseek(handle, 0, os.SEEK_SET)
            os.write(handle, f"{os.getpid()}\n".encode())
        except OSError as error:
            _warn_unlocked(path, who, error)
        yield
    finally:
        os.close(handle)


def _holder(handle: int) -> str:
    os.lseek(handle, 0, os.SEEK_SET)
    holder = os.read(handle, 20).decode("ascii", "replace").strip()
    return f", process {holder}" if holder.isdigit() else ""


def _warn_unlocked(path: Path, who: str, error: OSError) -> None:
    """Log it only: as with the state file itself, a disk failure must not stop the agent."""
    LOG.warning("%s: %s; cannot check whether another %s uses the same file", path, error.strerror, who)

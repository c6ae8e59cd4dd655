"""What this system can do, and another way where it cannot: the one file that knows of operating systems.

Each function looks for the capability itself, never for the name of a system, so a test can take it away.
Linux has all of them; macOS lacks processor affinity and systemd; Windows lacks forkserver, SIGHUP, signal
handlers of the event loop, ``flock``, Unix sockets and ``nice``.
"""

from __future__ import annotations

import asyncio
import importlib
import multiprocessing
import os
import signal
import socket
from collections.abc import Callable, Coroutine, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from types import ModuleType

T = TypeVar("T")
LOCKED_BYTE = 4096
"""Place of the byte that is locked where files are locked by bytes; behind what is written in the file."""
TICK = 0.5
"""Longest wait until a signal is seen where the event loop has no handlers for signals, s."""


def _module(name: str) -> ModuleType | None:
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        return None


fcntl: Any = _module("fcntl")
msvcrt: Any = _module("msvcrt")


def cores() -> int:
    """Return how many cores this process may use; without affinity, how many there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def start_method() -> str:
    """Return how processes are started: from one without threads and sockets, else each anew."""
    return "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"


def import_before_start(context: Any, modules: Iterable[str]) -> None:  # noqa: ANN401 - of any start method
    """Let workers of a context find modules imported, where all come from one process.

    That process starts now and imports on a core of its own, while this one goes on.
    """
    if context.get_start_method() == "forkserver":
        context.set_forkserver_preload([*modules])
        importlib.import_module("multiprocessing.forkserver").ensure_running()


def step_back(by: int) -> None:
    """Leave the processor to others, where a process can."""
    if hasattr(os, "nice"):
        os.nice(by)


def run_event_loop(main: Coroutine[Any, Any, T]) -> T:
    """Run an event loop that watches sockets for writing: the MQTT client needs it, Windows' own cannot."""
    if not hasattr(asyncio, "ProactorEventLoop"):
        return asyncio.run(main)
    with asyncio.Runner(loop_factory=asyncio.SelectorEventLoop) as runner:
        return runner.run(main)


def on_signals(actions: Mapping[str, Callable[[], object]]) -> None:
    """Call an action in the running event loop at each signal of a name; an unknown name is left out.

    Args:
        actions: Name, such as ``SIGTERM``, -> action.
    """
    loop = asyncio.get_running_loop()
    for name, action in actions.items():
        number = getattr(signal, name, None)
        if number is None:
            continue
        try:
            loop.add_signal_handler(number, action)
        except NotImplementedError:
            signal.signal(number, _caller(loop, action))
            _tick(loop)


def try_lock(handle: int) -> bool:
    """Lock an open file for this process; return False where another process has it.

    Raises:
        OSError: It cannot be locked.
    """
    if fcntl is not None:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
    if msvcrt is None:
        raise OSError(None, "this system cannot lock files")
    os.lseek(handle, LOCKED_BYTE, os.SEEK_SET)
    try:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    except PermissionError:
        return False
    return True


def notification_socket() -> socket.socket | None:
    """Return a socket to a service manager on this machine, which never waits; None without Unix sockets."""
    if not hasattr(socket, "AF_UNIX"):
        return None
    found = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    found.setblocking(False)
    return found


def _caller(loop: asyncio.AbstractEventLoop, action: Callable[[], object]) -> Callable[..., None]:
    def call(*_: object) -> None:
        loop.call_soon_threadsafe(action)

    return call


def _tick(loop: asyncio.AbstractEventLoop) -> None:
    """Wake the loop up now and then: a signal does not end its wait."""
    loop.call_later(TICK, _tick, loop)

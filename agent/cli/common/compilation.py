"""Message of a command while numba compiles, so that a cold cache does not look like a hang."""

from __future__ import annotations

import sys
import threading
from multiprocessing.synchronize import Event

COMPILING = (
    "slipjump: compiling numerical kernels that are needed here for the first time (about a minute) ..."
)


def announce_compilation(announced: Event | threading.Event) -> None:
    """Print a message when this process compiles; ``announced`` is shared, so only one process prints it."""
    from agent.jit import before_compilation

    def announce() -> None:
        if not announced.is_set():
            announced.set()
            print(COMPILING, file=sys.stderr, flush=True)  # noqa: T201 - the command line speaks

    before_compilation(announce)

"""What a command says while numba compiles, so that a cold cache does not look like a hang."""

from __future__ import annotations

import sys
import threading
from multiprocessing.synchronize import Event

COMPILING = "slipjump: compiling the numerical kernels, once (about a minute) ..."


def announce_compilation(told: Event | threading.Event) -> None:
    """Say on stderr when this process has to compile; ``told`` is shared, so that one process says it."""
    from agent.jit import before_compilation

    def tell() -> None:
        if not told.is_set():
            told.set()
            print(COMPILING, file=sys.stderr, flush=True)  # noqa: T201 - the command line speaks

    before_compilation(tell)

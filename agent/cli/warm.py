"""``slipjump warm``: compile the kernels once, so that the first diagnosis is as fast as the next."""

from __future__ import annotations

import time


def warm() -> None:
    """Compile the numerical kernels into their cache."""
    import numpy as np

    from agent.analysis.diagnose import diagnose
    from agent.analysis.quantify import QUANTIFIERS
    from agent.analysis.recording import LoopHints, LoopWindow

    print("slipjump: compiling the numerical kernels, once ...", flush=True)  # noqa: T201 - the command's output
    started = time.perf_counter()
    t = np.arange(120.0)
    op = 50 + 5 * np.sin(2 * np.pi * t / 40)
    pv = 20 + 2 * np.sin(2 * np.pi * (t - 6) / 40)
    for quantifier in QUANTIFIERS:
        for order in (1, 2):
            for integrating in (False, True):
                hints = LoopHints(integrating=integrating, delay=2, order=order)
                diagnose(LoopWindow("warm", 0.0, 1.0, op, pv, hints=hints), quantifier=quantifier)
    print(f"slipjump: done in {time.perf_counter() - started:.1f} s")  # noqa: T201

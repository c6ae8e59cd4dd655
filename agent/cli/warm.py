"""``slipjump warm``: compile the kernels once, so that the first diagnosis is as fast as the next."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow


def warm() -> None:
    """Compile the numerical kernels into their cache."""
    import numpy as np

    from agent.analysis.diagnose import diagnose
    from agent.analysis.quantify import QUANTIFIERS
    from agent.analysis.record.recording import LoopHints, LoopWindow
    from agent.analysis.seen import look

    print("slipjump: compiling the numerical kernels, once ...", flush=True)  # noqa: T201 - the command's output
    started = time.perf_counter()
    t = np.arange(600.0)
    op = 50 + 5 * np.sin(2 * np.pi * t / 40)
    pv = 20 + 2 * np.sin(2 * np.pi * (t - 6) / 40)
    look(LoopWindow("warm", 0.0, 1.0, op, pv))  # in fewer samples some detectors see too little
    _warm_workbench(LoopWindow("warm", 0.0, 1.0, op, pv))  # behind thirty lags, too
    op, pv = op[:120], pv[:120]
    for quantifier in QUANTIFIERS:
        for order in (1, 2):
            for integrating in (False, True):
                hints = LoopHints(integrating=integrating, delay=2, order=order)
                diagnose(LoopWindow("warm", 0.0, 1.0, op, pv, hints=hints), quantifier=quantifier)
    print(f"slipjump: done in {time.perf_counter() - started:.1f} s")  # noqa: T201


def _warm_workbench(window: LoopWindow) -> None:
    """Fit every effect on every base that it applies to, in the middle of its parameters."""
    import numpy as np

    from agent.checks.plug_ins import usable_effects
    from agent.physics.bases import BASES
    from agent.physics.loop_model import LoopModel
    from agent.workbench.fit import fit_at
    from agent.workbench.library import applies
    from agent.workbench.objective import objective_of
    from agent.workbench.prediction_search import predictor
    from agent.workbench.projection import target_of
    from agent.workbench.record import bare_record

    record = bare_record(window)
    effects = usable_effects().effects
    for base in BASES:
        own = [effect for effect in effects if applies(effect, base)]
        for model in (LoopModel(base), *(LoopModel(base, (effect,)) for effect in own)):
            target = target_of(record, record.weight, linear=base.linear)
            objective = objective_of(model, record, target)
            # Parts of several points lie otherwise in memory than those of one, and in the middle a number
            # that may have either sign is none.
            points = np.full((2, len(objective.space)), [[0.5], [0.4]])
            objective.errors(points)
            fitted = fit_at(model, record, target, objective.space.values(points[0]))
        if base.linear:
            predictor(fitted, record)

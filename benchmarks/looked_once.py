"""CPU of a window that is due: one call that looks once, against the way before that looked twice."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.analysis.routine import routine_diagnosis
from agent.analysis.seen import look, worth_a_fit
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.random_plants import random_plant
from simulators.plant import simulate

LOOPS = 5
FULL_LOOPS = 40
SEED = 8200
"""First of the loops; nothing was set on them."""
KINDS = ("stiction", "tuning")
SAMPLES = 1500


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time of one window, s."""

    once: float
    twice: float

    @property
    def ratio(self) -> float:
        """Of the one way to the other."""
        return self.once / self.twice


def run(options: Options) -> None:
    """Print the ratio for windows that stick and windows that do not, all in one run."""
    rows = []
    for kind in KINDS:
        costs = [cost_of(window_of(SEED + k, kind)) for k in range(FULL_LOOPS if options.full else LOOPS)]
        ratios = [each.ratio for each in costs]
        rows.append(
            (
                kind,
                str(len(costs)),
                f"{median(each.once for each in costs):.3f}",
                f"{median(each.twice for each in costs):.3f}",
                f"{median(ratios):.2f}",
                f"{sum(each.once for each in costs) / sum(each.twice for each in costs):.2f}",
            )
        )
    columns = ("loops", "windows", "looked at once", "looked at twice", "ratio, median", "ratio of the sums")
    print(table(f"### A window that is due, {SAMPLES} samples, CPU seconds in the median", columns, rows))


def window_of(seed: int, kind: str) -> LoopWindow:
    """Return the first samples of a simulated loop."""
    scenario = random_plant(seed, kind)
    record = simulate(scenario)
    return LoopWindow(scenario.loop, 0.0, scenario.ts, record.op[:SAMPLES], record.pv[:SAMPLES])


def cost_of(window: LoopWindow) -> Cost:
    """Return the CPU time of both ways; what is compiled or cached is so before."""
    routine_diagnosis(window, diagnose)
    once = _cpu_seconds(lambda: routine_diagnosis(window, diagnose))
    twice = _cpu_seconds(lambda: worth_a_fit(look(window)) and diagnose(window))
    return Cost(once, twice)


def _cpu_seconds(call: Callable[[], object]) -> float:
    started = time.process_time()
    call()
    return time.process_time() - started

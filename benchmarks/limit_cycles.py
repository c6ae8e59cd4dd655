"""What `compare --auto` names in loops that oscillate by themselves: sticking valves, tight tuning, waves.

The loops of `hidden_effects` follow a set point that moves, so that a first fit that fails in a limit cycle
is not seen there (decision 111). The seeds are those of nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.runtime.loop.process_pool import process_pool
from agent.workbench.session import Workbench
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.random_plants import Kind, random_draw
from simulators.plant import simulate

FIRST_SEED = 94000
LOOPS, LOOPS_FULL = 10, 40
"""Of each kind."""
SAMPLES = 1200
KINDS: tuple[Kind, ...] = ("stiction", "tuning", "sinusoid", "none_noise")
HYSTERESIS = {each.name for each in EFFECTS if each.family == "valve_hysteresis"}


@dataclass(frozen=True, slots=True)
class Cycle:
    """What was named in one loop."""

    kind: Kind
    effects: tuple[str, ...]
    """Of the last model."""
    suggested: tuple[str, ...]
    """By the verdict on it, those that would explain it as well among them."""
    left: float
    """Held-out error of the last model over that of the base."""
    cpu: float
    """s"""

    @property
    def named(self) -> bool:
        """Whether the hysteresis of a valve was."""
        return bool(HYSTERESIS & {*self.effects})

    @property
    def hinted(self) -> bool:
        """Whether it was suggested alone."""
        return not self.named and bool(HYSTERESIS & {*self.suggested})


def run(options: Options) -> None:
    """Print the table."""
    count = options.loops or (LOOPS_FULL if options.full else LOOPS)
    jobs = [(kind, FIRST_SEED + i) for kind in KINDS for i in range(count)]
    with process_pool() as pool:
        found = pool.map(cycle, *zip(*jobs, strict=True))
        cycles = list(track(found, "limit cycles", len(jobs), console=Console(stderr=True)))
    print(report(cycles))


def cycle(kind: Kind, seed: int) -> Cycle:
    """Run the workbench on one loop, of which it gets OP and PV alone."""
    scenario = random_draw(seed, kind).scenario
    record = simulate(scenario)
    window = LoopWindow(scenario.loop, 0.0, scenario.ts, record.op[:SAMPLES], record.pv[:SAMPLES])
    bench = Workbench(window)
    started = time.process_time()
    steps = bench.auto()
    spent = time.process_time() - started
    if not steps:
        return Cycle(kind, (), (), 1.0, spent)
    verdict = bench.comparison().verdict
    suggested = () if verdict.effect is None else (verdict.effect, *verdict.indistinguishable)
    left = steps[-1].held_out.rmse / steps[0].held_out.rmse
    return Cycle(kind, steps[-1].effects, suggested, left, spent)


def report(cycles: Sequence[Cycle]) -> str:
    """Return a row for each kind."""
    rows = []
    for kind in KINDS:
        ones = [each for each in cycles if each.kind == kind]
        rows.append(
            (
                f"`{kind}`",
                len(ones),
                sum(each.named for each in ones),
                sum(each.hinted for each in ones),
                sum(bool({*each.effects} - HYSTERESIS) for each in ones),
                f"{np.median([each.left for each in ones]):.2f}",
                f"{np.mean([each.cpu for each in ones]):.1f}",
            )
        )
    columns = (
        "kind",
        "loops",
        "valve hysteresis named",
        "suggested",
        "another effect named",
        "held-out error, of the base's, median",
        "CPU s, mean",
    )
    return table("### Loops that oscillate by themselves", columns, rows)

"""What the wave of a load is worth as the rival of a sticking valve, by leaving it out.

Loops whose set point moves, sound ones beside a load that oscillates and sticking ones with and without one
(``simulators.draws.hidden_effects``). Nothing was set on the seeds. By default there are twelve seeds, which
takes some minutes of CPU; ``--loops N`` makes it N, ``--full`` 48.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import product
from unittest.mock import patch

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.hidden_effects import HiddenTruth, hidden_effect_plant

SEEDS = range(98452, 98500)
USUAL = 12
TRUTHS: tuple[HiddenTruth, ...] = (
    "none",
    "load_step",
    "sinusoid",
    "wave",
    "stiction",
    "deadband",
    "asymmetric_stiction",
    "stiction_sinusoid",
)
RIVAL = "agent.analysis.innovations.with_load_wave"


@dataclass(frozen=True, slots=True)
class Compared:
    """Whether the verdict on a loop is stiction."""

    truth: HiddenTruth
    without: bool
    with_it: bool


def run(options: Options) -> None:
    """Print a row for each truth."""
    seeds = SEEDS[: options.loops or (len(SEEDS) if options.full else USUAL)]
    jobs = list(product(seeds, TRUTHS))
    with process_pool() as pool:
        found = list(
            track(pool.map(compared, jobs), "outside waves", len(jobs), console=Console(stderr=True))
        )
    rows = []
    for truth in TRUTHS:
        cases = [each for each in found if each.truth == truth]
        rows.append(
            (
                truth,
                f"{sum(each.without for each in cases)} of {len(cases)}",
                f"{sum(each.with_it for each in cases)} of {len(cases)}",
            )
        )
    columns = ("truth", "calls stiction without the rival", "with it")
    print(table(f"### A wave of the load as a rival, {len(seeds)} seeds", columns, rows))


def compared(job: tuple[int, HiddenTruth]) -> Compared:
    """Return the verdicts without the rival and with it."""
    seed, truth = job
    plant = hidden_effect_plant(seed, truth)
    window = LoopWindow(truth, 0.0, plant.scenario.ts, plant.op, plant.pv, plant.sp)
    with patch(RIVAL, lambda *_: -math.inf):
        without = diagnose(window).verdict == "stiction"
    return Compared(truth, without, diagnose(window).verdict == "stiction")

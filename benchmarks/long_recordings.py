"""Long recordings judged as a whole and by stretches: sound valves accused, S, and time.

Loops whose set point moves (``simulators.draws.hidden_effects``), 24,000 samples each, half of them with a
valve that sticks, a sixth beside a load that oscillates. Nothing was set on the seeds. By default there are
four seeds, which takes some minutes of CPU; ``--loops N`` makes it N, ``--full`` 24.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from statistics import median

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.analysis.recording_diagnosis import diagnose_recording
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.hidden_effects import HiddenTruth, hidden_effect_plant

SEEDS = range(98408, 98432)
USUAL = 4
LENGTH = 24_000
SOUND: tuple[HiddenTruth, ...] = ("none", "slow_drift", "sinusoid")
STICKING: tuple[HiddenTruth, ...] = ("stiction", "deadband", "stiction_sinusoid")


@dataclass(frozen=True, slots=True)
class Judged:
    """A loop, judged in one way."""

    truth: HiddenTruth
    stiction: bool
    """Whether the verdict is that."""
    miss: float | None
    """|S error|, spans of OP; None where the verdict is another or nothing sticks."""
    covered: bool
    """Whether the interval of S holds it."""
    seconds: float


def run(options: Options) -> None:
    """Print a row for each truth and way."""
    seeds = SEEDS[: options.loops or (len(SEEDS) if options.full else USUAL)]
    jobs = list(product(seeds, (*SOUND, *STICKING)))
    with process_pool() as pool:
        found = list(track(pool.map(both, jobs), "long recordings", len(jobs), console=Console(stderr=True)))
    rows = []
    for truth in (*SOUND, *STICKING):
        for way, title in enumerate(("as a whole", "by stretches")):
            cases = [each[way] for each in found if each[way].truth == truth]
            misses = [each.miss for each in cases if each.miss is not None]
            rows.append(
                (
                    truth,
                    title,
                    f"{sum(each.stiction for each in cases)} of {len(cases)}",
                    f"{100 * median(misses):.2f}" if misses else "",
                    f"{sum(each.covered for each in cases)} of {len(misses)}" if misses else "",
                    f"{median(each.seconds for each in cases):.1f}",
                )
            )
    columns = ("truth", "judged", "calls stiction", "S error, median, % of span", "interval holds S", "s")
    print(table(f"### Recordings of {LENGTH} samples, {len(seeds)} seeds", columns, rows))


def both(job: tuple[int, HiddenTruth]) -> tuple[Judged, Judged]:
    """Return the result of both ways."""
    seed, truth = job
    plant = hidden_effect_plant(seed, truth, (LENGTH, LENGTH + 1))
    window = LoopWindow(truth, 0.0, plant.scenario.ts, plant.op, plant.pv, plant.sp)
    s = plant.scenario.truth.f_s + plant.scenario.truth.f_d
    answers = []
    for found in (diagnose(window), diagnose_recording(window)[0]):
        sticking = None if found.quantification is None else found.quantification.stiction
        miss, covered = None, False
        if found.verdict == "stiction" and truth in STICKING and sticking is not None:
            miss = abs(sticking.s.value - s) / float(np.ptp(plant.op))
            covered = (sticking.s.low or 0.0) <= s <= (np.inf if sticking.s.high is None else sticking.s.high)
        answers.append(Judged(truth, found.verdict == "stiction", miss, covered, found.seconds))
    return answers[0], answers[1]

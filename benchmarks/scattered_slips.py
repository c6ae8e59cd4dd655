"""What slips that scatter are worth in the diagnosis, by leaving them out.

Sticking valves whose friction differs from one stop of the stem to the next, by a factor whose logarithm has
a standard deviation of 0 to 0.3, and sound ones. Nothing was set on the seeds. By default there are twelve
seeds, which takes some minutes of CPU; ``--loops N`` makes it N, ``--full`` all of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from unittest.mock import patch

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.record.recording import LoopWindow
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, STICKING, AnyKind, random_scenario, window_kept
from benchmarks.tables.markdown import table
from simulators.draws.seldom_moves import SeldomKind, seldom_moved
from simulators.historian import Historian
from simulators.scenario import Scenario

SEEDS = range(98700, 98748)
USUAL = 12
SCATTERS = (0.0, 0.1, 0.2, 0.3)
SELDOM: tuple[SeldomKind, ...] = ("seldom", "seldom_stiction")
RIVAL = "agent.analysis.innovations.with_scatter"


@dataclass(frozen=True, slots=True)
class Job:
    """One loop."""

    kind: AnyKind | SeldomKind
    scatter: float
    seed: int

    @property
    def sticks(self) -> bool:
        return self.kind in STICKING or self.kind == "seldom_stiction"


@dataclass(frozen=True, slots=True)
class Compared:
    """What is said of a loop without slips that scatter and with them."""

    job: Job
    calls_stiction: tuple[bool, bool]
    nats: tuple[float, float]
    """Log likelihood ratios, 0 where there are none."""


def run(options: Options) -> None:
    """Print a row for each scatter, and one for each kind of sound valve."""
    seeds = SEEDS[: options.loops or (len(SEEDS) if options.full else USUAL)]
    jobs = [
        job
        for kind, scatter, seed in product((*KINDS, *SELDOM), SCATTERS, seeds)
        if (job := Job(kind, scatter, seed)).sticks or scatter == 0.0
    ]
    with process_pool() as pool:
        found = list(
            track(pool.map(compared, jobs), "scattered slips", len(jobs), console=Console(stderr=True))
        )
    sticking = [
        (f"{scatter:g}", [each for each in found if each.job.sticks and each.job.scatter == scatter])
        for scatter in SCATTERS
    ]
    sound = [
        (kind, [each for each in found if each.job.kind == kind and not each.job.sticks])
        for kind in (*KINDS, *SELDOM)
        if kind not in STICKING and kind != "seldom_stiction"
    ]
    columns = ("calls stiction without", "with", "more than 40 nats without", "with")
    title = f"### Slips that scatter, {len(seeds)} seeds"
    print(table(f"{title}: valves that stick", ("scatter", *columns), [row(*each) for each in sticking]))
    print(table(f"{title}: sound valves", ("kind", *columns), [row(*each) for each in sound]))


def row(name: str, cases: list[Compared]) -> tuple[str, ...]:
    """Return how many are called sticking, and how many have many nats, without and with."""
    of = len(cases)
    called = [f"{sum(each.calls_stiction[way] for each in cases)} of {of}" for way in (0, 1)]
    many = [f"{sum(each.nats[way] > 40 for each in cases)} of {of}" for way in (0, 1)]
    return name, *called, *many


def compared(job: Job) -> Compared:
    """Return the verdicts without slips that scatter and with them."""
    window = window_of_job(job)
    with patch(RIVAL, lambda *_: None):
        without = diagnose(window)
    found = diagnose(window)
    called = without.verdict == "stiction", found.verdict == "stiction"
    return Compared(job, called, (nats(without), nats(found)))


def nats(diagnosis: Diagnosis) -> float:
    found = diagnosis.quantification
    return 0.0 if found is None else found.log_likelihood_ratio or 0.0


def window_of_job(job: Job) -> LoopWindow:
    """Simulate the loop, with the friction of its valve scattered."""
    historian = Historian()
    if job.kind in SELDOM:
        scenario, historian = seldom_moved(job.seed, job.kind)
    else:
        scenario, _ = random_scenario(job.kind, job.seed)
    return window_kept(scenario.loop, scattered(scenario, job.scatter), historian)


def scattered(scenario: Scenario, scatter: float) -> Scenario:
    return scenario.model_copy(update={"valve": scenario.valve.model_copy(update={"scatter": scatter})})

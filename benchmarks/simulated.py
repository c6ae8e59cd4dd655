"""Random simulated loops whose valves obey Karnopp or LuGre: how often the verdict and the amounts are right.

The quantifiers get OP and PV only. The seeds are not those from which thresholds were set (0 to 39), nor
those of tests (100 to 119).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import DEFAULT_QUANTIFIER
from agent.analysis.quantify import QUANTIFIERS
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.case import Case, judge, warm
from benchmarks.cases.case_file import append_cases, read_cases
from benchmarks.cases.options import Options
from benchmarks.tables.accuracy_tables import (
    KINDS,
    coverage,
    errors_by_method,
    errors_by_stratum,
    evidence,
    verdicts,
)
from benchmarks.tables.targets import targets
from simulators.draws.random_plants import Kind

FIRST_SEED = 1000
STICKING, STICKING_FULL = 200, 600
OTHERS = 4
"""A sound loop of each kind to so many sticking ones."""
SUBSET = 20
"""All quantifiers see one loop in so many; the default one and ``lee2008`` see all."""
ON_ALL = (DEFAULT_QUANTIFIER, "lee2008")


@dataclass(frozen=True, slots=True)
class Job:
    """A loop to simulate, and the methods to run on it."""

    kind: Kind
    seed: int
    methods: tuple[str, ...]

    def work_out(self) -> list[Case]:
        return judge(self.kind, self.seed, self.methods)


def run(options: Options) -> None:
    """Print the tables; with ``options.save`` continue from that file, and write the rest to it."""
    wanted = jobs(options.loops or (STICKING_FULL if options.full else STICKING))
    done = read_cases(options.save) if options.save else []
    wanted_keys = {(job.kind, job.seed, method) for job in wanted for method in job.methods}
    cases = [case for case in done if (case.kind, case.seed, case.method) in wanted_keys]
    cases += work_out(left_of(wanted, cases), options.save)
    everyone = [each.name for each in QUANTIFIERS]
    print(verdicts(cases, ON_ALL))
    print(evidence(cases, DEFAULT_QUANTIFIER))
    print(targets(cases, DEFAULT_QUANTIFIER))
    for method in ON_ALL:
        print(errors_by_stratum(cases, method))
    print(coverage(cases, DEFAULT_QUANTIFIER))
    print(errors_by_method(cases, everyone))


def jobs(sticking: int) -> list[Job]:
    everyone = tuple(each.name for each in QUANTIFIERS)
    found = []
    for kind in KINDS:
        count = sticking if kind == "stiction" else -(-sticking // OTHERS)
        in_subset = -(-count // SUBSET)
        found += [Job(kind, FIRST_SEED + i, everyone if i < in_subset else ON_ALL) for i in range(count)]
    return found


def left_of(wanted: Sequence[Job], cases: Sequence[Case]) -> list[Job]:
    """Return the jobs without what is already known."""
    known = {(case.kind, case.seed, case.method) for case in cases}
    left = [
        Job(
            job.kind, job.seed, tuple(each for each in job.methods if (job.kind, job.seed, each) not in known)
        )
        for job in wanted
    ]
    return [job for job in left if job.methods]


def work_out(left: Sequence[Job], save: Path | None) -> list[Case]:
    """Judge the loops in a process for each core, and save each as it is done."""
    cases: list[Case] = []
    for found in track(
        in_processes(left), "simulated loops", total=len(left), console=Console(stderr=True), disable=not left
    ):
        if save is not None:
            append_cases(save, found)
        cases += found
    return cases


def in_processes(left: Sequence[Job]) -> Iterator[list[Case]]:
    with process_pool(None, get_ready) as pool:
        for future in as_completed([pool.submit(job.work_out) for job in left]):
            yield future.result()


def get_ready() -> None:
    """Prepare a process of the pool."""
    warm([each.name for each in QUANTIFIERS])

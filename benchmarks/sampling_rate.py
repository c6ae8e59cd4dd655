"""Simulated loops at 4 to 120 samples a period, sampled and averaged: verdicts and intervals at each rate.

The limit on samples a period, the widening of the intervals and the cap of the probability were learnt on the
seeds from 7000, without that limit (``rated_loops(..., gated=False)``), what OP moves between two samples on
those from 8700 to 8732; the tables are of other seeds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import as_completed

from rich.console import Console
from rich.progress import track

from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.rated_loop import HOWS, RATES, RatedLoop, rated_loops
from benchmarks.simulated import get_ready
from benchmarks.tables.markdown import table
from simulators.draws.random_plants import Kind

FIRST_SEED = 8740
STICKING, STICKING_FULL = 6, 30
SOUND: tuple[Kind, ...] = ("sinusoid", "tuning")
"""Sound loops that oscillate; of each a third as many as of sticking ones."""
Job = tuple[Kind, int, int]
"""Kind, seed and rate."""


def run(options: Options) -> None:
    """Print a table of verdicts and one of intervals."""
    count = options.loops or (STICKING_FULL if options.full else STICKING)
    wanted = jobs(count)
    found = track(in_processes(wanted), "rates", total=len(wanted), console=Console(stderr=True))
    loops = [each for part in found for each in part]
    print(verdicts(loops))
    print(intervals(loops))


def jobs(sticking: int) -> list[Job]:
    """Return what is simulated, each rate of each loop by itself, so that no process waits for long."""
    kinds: list[tuple[Kind, int]] = [("stiction", sticking), *((kind, -(-sticking // 3)) for kind in SOUND)]
    return [
        (kind, FIRST_SEED + i, rate)
        for rate in reversed(RATES)
        for kind, count in kinds
        for i in range(count)
    ]


def in_processes(wanted: Sequence[Job]) -> Iterator[list[RatedLoop]]:
    with process_pool(None, get_ready) as pool:
        for future in as_completed([pool.submit(work_out, job) for job in wanted]):
            yield future.result()


def work_out(job: Job) -> list[RatedLoop]:
    kind, seed, rate = job
    return rated_loops(kind, seed, (rate,))


def verdicts(loops: Sequence[RatedLoop]) -> str:
    """Return shares of verdicts by rate, of loops that stick and of sound ones."""

    def row(ones: Sequence[RatedLoop]) -> list[str]:
        sticking = [each for each in ones if each.sticks]
        sound = [each for each in ones if not each.sticks]
        return [
            str(len(ones)),
            count(ones, lambda each: each.wrong),
            count(sticking, lambda each: each.right),
            count(sound, lambda each: each.right),
            count(ones, lambda each: each.verdict == "undecided"),
            count(ones, lambda each: each.verdict == "not_testable"),
            extreme(ones),
        ]

    columns = (
        "samples a period",
        "record of",
        "records",
        "firm and wrong",
        "sticking: firm and right",
        "sound: firm and right",
        "undecided",
        "not testable",
        "probability, least and most",
    )
    return table("### Verdicts by sampling rate, records", columns, rows_of(loops, row))


def intervals(loops: Sequence[RatedLoop]) -> str:
    """Return how many 90 % intervals of S hold the truth, and how wide they are."""

    def row(ones: Sequence[RatedLoop]) -> list[str]:
        given = [each for each in ones if each.covered is not None]
        held = sum(bool(each.covered) for each in given)
        widths = sorted(100 * ((each.s_high or 0) - (each.s_low or 0)) / each.op_span for each in given)
        if not given:
            return ["0", "", ""]
        return [str(len(given)), f"{100 * held / len(given):.0f}", f"{widths[len(widths) // 2]:.0f}"]

    columns = ("samples a period", "record of", "intervals of S", "hold the truth, %", "width, % of OP span")
    return table("### 90 % intervals of S by sampling rate", columns, rows_of(loops, row))


def rows_of(
    loops: Sequence[RatedLoop], row: Callable[[Sequence[RatedLoop]], list[str]]
) -> Iterator[list[str]]:
    for rate in RATES:
        for how in HOWS:
            ones = [each for each in loops if (each.rate, each.how) == (rate, how)]
            if ones:
                yield [str(rate), how, *row(ones)]


def count(ones: Sequence[RatedLoop], which: Callable[[RatedLoop], bool]) -> str:
    return f"{sum(map(which, ones))} of {len(ones)}"


def extreme(ones: Sequence[RatedLoop]) -> str:
    known = [each.probability for each in ones if each.probability is not None]
    return f"{min(known):.2f} to {max(known):.2f}" if known else ""

"""Simulated weeks of a plant: who is accused or suspected, when, how well P is calibrated, wear and repairs.

Physical friction, virtual time (`simulators.draws.valve_weeks`); odd seeds, which nothing was tuned on. A
window a day by default, as the memory counts them. With ``--full`` it is a plant of 300 loops and six weeks.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.memory.weighing_windows import BASE_RATE
from agent.analysis.wear.trend import trend_of
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.followed import days_held, found_after, repair_noticed
from benchmarks.cases.options import Options
from benchmarks.cases.weeks import DiagnosedValve, WeeksJob, diagnosed_valve
from benchmarks.tables.calibration import calibration_error, error_by_chance
from benchmarks.tables.markdown import table
from benchmarks.tables.ranking import area

LOOPS, LOOPS_FULL = 10, 300
WINDOWS, WINDOWS_FULL = 6, 42
DAYS = 42.0
WEEK = 7.0
COURSES, COURSES_FULL = 2, 40
"""Valves that wear, that are repaired, and that begin to stick."""
WEEKS = 28.0
"""Length of such a course, days; a repair and an onset are in its middle."""
SOON = 3.0
"""Days within which a repair should be noticed."""
SHOWN = 0.5
"""Probability from which a valve counts as found."""


def run(options: Options) -> None:
    """Print the tables."""
    loops = options.loops or (LOOPS_FULL if options.full else LOOPS)
    windows = WINDOWS_FULL if options.full else WINDOWS
    courses = COURSES_FULL if options.full else COURSES
    jobs = [WeeksJob(2 * k + 1, DAYS, windows, k % 5 == 0) for k in range(loops)]
    changing = [WeeksJob(2 * k + 1, WEEKS, windows, True, "wear") for k in range(courses)]
    changing += [WeeksJob(2 * k + 1, WEEKS, windows, True, "repair") for k in range(courses)]
    changing += [WeeksJob(2 * k + 1, WEEKS, windows, True, "onset") for k in range(courses)]
    with process_pool() as pool:
        answers = pool.map(diagnosed_valve, [*jobs, *changing])
        console = Console(stderr=True)
        valves = list(track(answers, "valves", len(jobs) + len(changing), console=console))
    print_weeks(valves[: len(jobs)])
    wear, repair, onset = (valves[len(jobs) + k * courses :][:courses] for k in range(3))
    print(courses_table(wear, repair))
    print(onset_table(onset))


def print_weeks(valves: Sequence[DiagnosedValve]) -> None:
    rows = []
    for sticks in (True, False):
        ones = [each for each in valves if each.sticks == sticks]
        accused = sum(any(each.accused) for each in ones)
        at = [sum(found_by(each, days) for each in ones) for days in (WEEK, DAYS)]
        last = [each.memories[-1].probability() for each in ones]
        median = f"{np.median(last):.2f}" if last else ""
        rows.append(("sticks" if sticks else "sound", len(ones), accused, *at, median))
    columns = ("valve", "valves", "some window accuses it", "P > 0.5 within a week", "at the end", "median P")
    print(table("### Simulated weeks", columns, rows))
    print(ranking_table(valves))
    p, stuck = [each.memories[-1].probability() for each in valves], [each.sticks for each in valves]
    errors = f"{calibration_error(p, stuck):.3f}, {error_by_chance(p, stuck):.3f} by chance alone"
    print(f"Expected calibration error at the base rate {BASE_RATE}: {errors}\n")


def ranking_table(valves: Sequence[DiagnosedValve]) -> str:
    """Return how well P at the end ranks valves that stick before sound ones, by how often they move."""
    rows = []
    for title, seldom in (("seldom", True), ("often", False)):
        ones = [each for each in valves if each.name.startswith("seldom") == seldom]
        p = [[each.memories[-1].probability() for each in ones if each.sticks == s] for s in (True, False)]
        error = calibration_error([*p[0], *p[1]], [True] * len(p[0]) + [False] * len(p[1]))
        rows.append((title, len(p[0]), len(p[1]), f"{area(*p):.2f}", f"{error:.3f}"))
    columns = ("moves", "stick", "sound", "area under the curve", "calibration error")
    return table("### Ranking by P at the end", columns, rows)


def found_by(valve: DiagnosedValve, days: float) -> bool:
    """Whether P exceeded one half, or a window accused it, at the last window before a day."""
    known = [k for k, day in enumerate(valve.days) if day <= days]
    return bool(known) and valve.memories[known[-1]].probability() > SHOWN


def courses_table(wear: Sequence[DiagnosedValve], repair: Sequence[DiagnosedValve]) -> str:
    """Return how often a slope has the right sign, a repair is seen, and the interval of S holds."""
    trends = [trend_of(each.memories[-1].s_days) for each in wear]
    signs = sum(each is not None and each.slope > 0 for each in trends)
    noticed = [found for each in repair if (found := repair_noticed(each, WEEKS / 2)) is not None]
    soon = sum(found <= SOON for found in noticed)
    rows = [
        ("wear from S to 4 S", len(wear), *showing(wear), f"rises: {signs}"),
        ("repair", len(repair), *showing(repair), f"noticed: {len(noticed)}, within {SOON:g} days: {soon}"),
    ]
    columns = ("course", "valves", "with a trend", "days on which S is within its 90 % interval", "right")
    return table(f"### Wear and repair in {WEEKS:g} days", columns, rows)


def onset_table(valves: Sequence[DiagnosedValve]) -> str:
    """Return how soon valves that begin to stick have P > 0.5."""
    begins = WEEKS / 2
    early = sum(found_by(each, begins) for each in valves)
    after = [found for each in valves if (found := found_after(each, begins, SHOWN)) is not None]
    within = sum(days <= WEEK for days in after)
    median = f"{np.median(after):.1f}" if after else ""
    columns = (
        "valves",
        "P > 0.5 before",
        f"within {WEEK:g} days",
        f"within {WEEKS - begins:g}",
        "median, days",
    )
    rows = [(len(valves), early, within, len(after), median)]
    return table("### Valves that begin to stick", columns, rows)


def showing(valves: Sequence[DiagnosedValve]) -> tuple[int, str]:
    """Return how many valves have a trend, and how often its interval has the true S."""
    held = [days_held(each) for each in valves]
    return sum(days > 0 for _, days in held), f"{sum(k for k, _ in held)} of {sum(n for _, n in held)}"

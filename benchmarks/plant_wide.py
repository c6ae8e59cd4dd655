"""Plants of 8 to 20 coupled loops: groups that are right, roots that are named first.

A plant is right where every group is: each loop that a root reaches plainly is in its group, no other loop
is, and no group joins loops that nothing connects. Roots are counted over all groups that were found. Without
a diagnosis of the loops the wave alone decides; with ``--full`` the diagnoses of the loops count as well.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.plant.plant import PlantFinding, plant_finding
from agent.analysis.record.recording import LoopWindow
from agent.runtime.loop.process_pool import process_pool
from agent.runtime.plant_wide import MOST_LOOPS, MOST_SAMPLES
from benchmarks.cases.options import Options
from benchmarks.tables.markdown import table
from simulators.draws.coupled_plants import CASES, CoupledPlant, coupled_plant

PLANTS, PLANTS_FULL = 14, 70
SEED = 100
"""First of the plants; the weights of the clues were fitted on those below 14."""
COST_SEED = 63900
"""Of the noise of the loops whose comparison is timed."""
WAVES, FIRST_PERIOD, RATIO = 10, 40.0, 1.27
"""Of these loops: oscillations, each of several loops; the shortest period, s; and one over the next."""


@dataclass(frozen=True, slots=True)
class JudgedPlant:
    """What was found of one plant."""

    case: str
    loops: int
    right: bool
    """Whether its groups are right."""
    found: int
    """Roots whose group was found."""
    first: int
    """Of these, roots that are named first."""
    first_diagnosed: int
    """The same with diagnoses; 0 without."""


def run(options: Options) -> None:
    """Print the table."""
    count = options.loops or (PLANTS_FULL if options.full else PLANTS)
    jobs = [(SEED + k, options.full) for k in range(count)]
    with process_pool() as pool:
        answers = pool.map(judged_plant, jobs)
        judged = list(track(answers, "plants", count, console=Console(stderr=True)))
    names = [*dict.fromkeys(each.case for each in judged)]
    rows = [_row(name, [each for each in judged if each.case == name]) for name in names]
    rows.append(_row("all", judged))
    columns = ("roots", "plants", "groups right", "roots found", "named first", "with diagnoses")
    print(table("### Plants of coupled loops", columns, rows))
    cost = look_cost()
    print(f"One look of the agent at {MOST_LOOPS} loops of {MOST_SAMPLES} samples: {cost:.1f} s of CPU\n")


def look_cost(loops: int = MOST_LOOPS, samples: int = MOST_SAMPLES) -> float:
    """Return the time of a core, s, that loops with several oscillations and with none take."""
    rng, moments = np.random.default_rng(COST_SEED), np.arange(float(samples))
    waves = [np.sign(np.sin(2 * np.pi * moments / (FIRST_PERIOD * RATIO**k))) for k in range(WAVES)]
    waves += [np.zeros(samples)] * 2
    windows = []
    for k in range(loops):
        slow = np.convolve(rng.normal(size=samples), np.full(20, 1 / 20), "same")
        moved = waves[k % len(waves)] + slow
        pv = 80 + moved + 0.2 * rng.normal(size=samples)
        windows.append(LoopWindow(f"FIC{k}", 0.0, 1.0, 50 - moved, pv, np.full(samples, 80.0)))
    started = time.process_time()
    plant_finding(windows)
    return time.process_time() - started


def _row(name: str, judged: Sequence[JudgedPlant]) -> tuple[object, ...]:
    found = sum(each.found for each in judged)
    return (
        name,
        len(judged),
        sum(each.right for each in judged),
        found,
        f"{sum(each.first for each in judged)} of {found}",
        f"{sum(each.first_diagnosed for each in judged)} of {found}",
    )


def judged_plant(job: tuple[int, bool]) -> JudgedPlant:
    """Draw a plant and judge it; runs in a process of the pool."""
    seed, diagnosed = job
    plant = coupled_plant(seed)
    windows = windows_of(plant)
    finding = plant_finding(windows)
    first = roots_first(plant, finding)
    found = sum(_group_of(plant, root, finding) is not None for root in plant.roots)
    with_fits = 0
    if diagnosed:
        again = plant_finding(windows, _diagnoses(windows, finding))
        with_fits = roots_first(plant, again)
    case = " and ".join(CASES[seed % len(CASES)])
    return JudgedPlant(case, len(windows), groups_right(plant, finding), found, first, with_fits)


def windows_of(plant: CoupledPlant) -> list[LoopWindow]:
    """Return what a historian keeps of a plant."""
    return [
        LoopWindow(each.name, 0.0, 1.0, each.op, each.pv, np.full(len(each.op), each.sp))
        for each in plant.loops
    ]


def groups_right(plant: CoupledPlant, finding: PlantFinding) -> bool:
    """Whether every root has its group, and no group joins what nothing connects."""
    said = [{each.loop for each in group.suspects} for group in finding.groups]
    trees = {
        root: {root} | {each.name for each in plant.loops if root in each.reached} for root in plant.roots
    }
    for root in plant.roots:
        sure, either = plant.members(root)
        if len(sure) > 1 and not any(sure <= each <= sure | either for each in said):
            return False
    return all(any(each <= tree for tree in trees.values()) for each in said)


def roots_first(plant: CoupledPlant, finding: PlantFinding) -> int:
    """Return how many roots are named first in their group."""
    groups = [_group_of(plant, root, finding) for root in plant.roots]
    return sum(
        names is not None and names[0] == root for root, names in zip(plant.roots, groups, strict=True)
    )


def _group_of(plant: CoupledPlant, root: str, finding: PlantFinding) -> list[str] | None:
    """Return the loops of the group in which most of what a root reaches is, the likeliest first."""
    sure, _ = plant.members(root)
    said = [[each.loop for each in group.suspects] for group in finding.groups]
    best = max(said, key=lambda names: len(sure & set(names)), default=[])
    return best if len(sure) > 1 and root in best else None


def _diagnoses(windows: Sequence[LoopWindow], finding: PlantFinding) -> list[Diagnosis]:
    grouped = {each.loop for group in finding.groups for each in group.suspects}
    return [diagnose(window) for window in windows if window.loop in grouped]

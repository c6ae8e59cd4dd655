"""Plants whose loops disturb each other: where an oscillation begins is known, and whom it reaches.

Each root (a valve that sticks, a loop that is tuned too tight, a load from outside) has a tree of loops below
it: the control error of a loop is a load of the loops that follow it, behind a lag and a dead time. There is
no recycle: nothing returns to a root. What a loop would do without the load of its tree is simulated with the
same noise, so the size of what reaches it is known exactly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from simulators.draws.periodicity import period_and_strength
from simulators.draws.random_plants import Kind, random_plant
from simulators.plant import SimulatedPlant

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from simulators.scenario import Scenario

    FloatArray = NDArray[np.float64]

WARM_UP, SAMPLES = 1000, 2000
"""Of a record with a sampling time of 1 s."""
CASES: tuple[tuple[Kind, ...], ...] = (
    ("stiction",),
    ("stiction", "stiction"),
    ("sinusoid",),
    ("tuning",),
    ("stiction", "sinusoid"),
    ("stiction", "tuning"),
    ("stiction", "stiction", "sinusoid", "tuning"),
)
"""Roots of a plant; a plant has the case of its seed."""
LOOPS = (8, 20)
APART = 1.2
"""Least ratio of the periods of two roots: closer ones nobody can keep apart in one record."""
REACHED = 0.7
"""Standard deviation of what reaches a loop, over that of all else in its control error, from which the loop
belongs to the group."""
UNREACHED = 0.15
"""Below it does not; what lies between is right either way."""
SIZES = (0.8, 8.0)
"""Range of what reaches a loop, over all else in its control error, standard deviations."""
LARGEST_LOAD = 10.0
"""Standard deviation of a load of another loop, OP units."""


@dataclass(frozen=True, slots=True)
class CoupledLoop:
    """One loop of a plant, with its truth."""

    name: str
    kind: Kind
    op: FloatArray
    """OP units, (n,)."""
    pv: FloatArray
    """PV units, (n,)."""
    sp: float
    """PV units."""
    sticks: bool
    reached: dict[str, float]
    """Root -> what comes from it, over all else, in standard deviations; a root itself is not in it."""


@dataclass(frozen=True, slots=True)
class CoupledPlant:
    """Loops of one plant on one clock, 1 s."""

    loops: tuple[CoupledLoop, ...]
    roots: tuple[str, ...]

    def members(self, root: str) -> tuple[set[str], set[str]]:
        """Return the loops that oscillate with a root, and those of which that may be said or not."""
        sure = {each.name for each in self.loops if each.reached.get(root, 0.0) >= REACHED}
        low = {each.name for each in self.loops if UNREACHED < each.reached.get(root, 0.0) < REACHED}
        return sure | {root}, low


def coupled_plant(seed: int) -> CoupledPlant:
    """Draw and simulate a plant; the same seed gives the same one."""
    rng = np.random.default_rng([seed, 28])
    kinds = CASES[seed % len(CASES)]
    count = int(rng.integers(max(LOOPS[0], 3 * len(kinds) + 2), LOOPS[1] + 1))
    scenarios = _roots(rng, kinds)
    errors, loops = [], []
    order = rng.permutation(count)
    names = [f"LOOP{1 + place:02d}" for place in order]
    for name, kind, scenario in zip(names, kinds, scenarios, strict=False):
        op, pv = _run(scenario)
        errors.append(pv - scenario.controller.sp)
        loops.append(_loop(name, kind, scenario, op, pv, {}))
    trees = [[k] for k in range(len(kinds))]
    for place in range(len(kinds), count):
        scenario = random_plant(int(rng.integers(2**31)), "none_noise")
        alone = _run(scenario)
        tree = _tree_of(rng, place, len(kinds))
        if tree is None:
            op, pv, reached = *alone, {}
        else:
            parent = int(rng.choice(trees[tree]))
            load = _carried(rng, errors[parent])
            own = float(np.std(alone[1][WARM_UP:]))
            wanted = own * math.exp(rng.uniform(*np.log(SIZES)))
            gain = float(np.std((_run(scenario, load)[1] - alone[1])[WARM_UP:]))  # of a load of 1 OP unit
            op, pv = _run(scenario, min(wanted / gain, LARGEST_LOAD) * load)
            reached = {names[tree]: float(np.std((pv - alone[1])[WARM_UP:])) / own}
            trees[tree].append(place)
        errors.append(pv - scenario.controller.sp)
        loops.append(_loop(names[place], "none_noise", scenario, op, pv, reached))
    return CoupledPlant(tuple(sorted(loops, key=lambda each: each.name)), tuple(names[: len(kinds)]))


def _roots(rng: np.random.Generator, kinds: tuple[Kind, ...]) -> list[Scenario]:
    """Draw roots whose periods are apart, also those of a multiple of each other."""
    found: list[Scenario] = []
    periods: list[float] = []
    for kind in kinds:
        while True:
            scenario = random_plant(int(rng.integers(2**31)), kind)
            period = period_and_strength((_run(scenario)[1] - scenario.controller.sp)[WARM_UP:])[0]
            logs = [abs(math.log(period / each)) for each in periods] if period > 0 else [0.0]
            if all(abs(each - math.log(n)) > math.log(APART) for each in logs for n in (1, 2, 3)):
                break
        found.append(scenario)
        periods.append(period)
    return found


def _tree_of(rng: np.random.Generator, place: int, roots: int) -> int | None:
    """Return the tree of a loop, None for one that nothing reaches; each root has at least two followers."""
    first = place - roots
    if first < 2 * roots:
        return first % roots
    return int(rng.integers(roots)) if rng.random() < 0.4 else None


def _carried(rng: np.random.Generator, error: FloatArray) -> FloatArray:
    """Return the load that a control error is for the next loop, of 1 OP unit, same shape."""
    keep = math.exp(-1.0 / math.exp(rng.uniform(math.log(1.0), math.log(20.0))))
    delay = int(rng.integers(1, 11))
    sign = rng.choice([-1.0, 1.0])
    through, level = np.empty_like(error), 0.0
    for k, each in enumerate(np.concatenate((np.zeros(delay), error[:-delay]))):
        level = each + (level - each) * keep
        through[k] = level
    return np.asarray(sign * through / np.std(through[WARM_UP:]))


def _run(scenario: Scenario, load: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Return OP and PV from rest, the warm-up included, (n,) each."""
    whole = scenario.model_copy(update={"warm_up": 0.0, "duration": float(WARM_UP + SAMPLES)})
    plant = SimulatedPlant(whole)
    op, pv = np.empty(whole.samples), np.empty(whole.samples)
    for k in range(whole.samples):
        row = plant.advance(0.0 if load is None else float(load[k]))
        op[k], pv[k] = row.values["op"], row.values["pv"]
    return op, pv


def _loop(
    name: str,
    kind: Kind,
    scenario: Scenario,
    op: FloatArray,
    pv: FloatArray,
    reached: dict[str, float],
) -> CoupledLoop:
    return CoupledLoop(
        name, kind, op[WARM_UP:], pv[WARM_UP:], scenario.controller.sp, kind == "stiction", reached
    )

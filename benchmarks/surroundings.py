"""How the diagnosis does where a loop's surroundings are other than those that it was set on.

Noise and loads that come in bursts, as the innovations of real recordings do; historians that keep one sample
in five or ten of the controller's; loads that the controller sees and feeds forward, so that OP moves and PV
stands, as large as the draws have them and four times as large. Weights, thresholds and search were set
without any of these. ``--loops N`` takes N seeds, ``--full`` all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from rich.console import Console
from rich.progress import track

from agent.analysis.diagnose import diagnose
from agent.runtime.loop.process_pool import process_pool
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, STICKING, AnyKind, random_scenario, window_kept
from benchmarks.scattered_slips import nats
from benchmarks.tables.markdown import table
from simulators.draws.other_recordings import with_loads
from simulators.historian import Historian
from simulators.parameters import Bursts
from simulators.scenario import Scenario

SEEDS = range(99200, 99224)
USUAL = 6
MANY = 40
"""Log likelihood ratio, nats, from which little else is needed for a verdict."""
LARGER = 4.0
"""Of loads that are fed forward."""
EVERY = (5, 10)


@dataclass(frozen=True, slots=True)
class Said:
    """What is said of one loop."""

    surroundings: str
    sticks: bool
    calls_stiction: bool
    nats: float


def in_bursts(std: float) -> Callable[[Scenario], Scenario]:
    return lambda scenario: scenario.model_copy(update={"bursts": Bursts(std=std, correlation=10.0)})


def loads(larger: float, fed_forward: float) -> Callable[[Scenario], Scenario]:
    """Return what makes loads larger and feeds a part of them forward."""

    def changed(scenario: Scenario) -> Scenario:
        controller = scenario.controller.model_copy(update={"feed_forward": fed_forward})
        return with_loads(scenario, larger).model_copy(update={"controller": controller})

    return changed


def quicker(every: int) -> Callable[[Scenario], Scenario]:
    return lambda scenario: scenario.model_copy(update={"ts": scenario.ts / every})


class Surroundings(NamedTuple):
    """What is other than drawn."""

    change: Callable[[Scenario], Scenario]
    historian: Historian = Historian()


SURROUNDINGS: Mapping[str, Surroundings] = {
    "as drawn": Surroundings(lambda scenario: scenario),
    "in bursts, 0.3": Surroundings(in_bursts(0.3)),
    "in bursts, 0.6": Surroundings(in_bursts(0.6)),
    **{
        f"one sample in {every} kept": Surroundings(quicker(every), Historian(every=every)) for every in EVERY
    },
    "loads fed forward": Surroundings(loads(1.0, 1.0)),
    "loads four times as large": Surroundings(loads(LARGER, 0.0)),
    "the same, fed forward": Surroundings(loads(LARGER, 1.0)),
}


def run(options: Options) -> None:
    """Print a row for each of the surroundings."""
    seeds = SEEDS[: options.loops or (len(SEEDS) if options.full else USUAL)]
    jobs = [*product(SURROUNDINGS, KINDS, seeds)]
    with process_pool() as pool:
        answers = pool.map(said, *zip(*jobs, strict=True), chunksize=1)
        found = list(track(answers, "surroundings", len(jobs), console=Console(stderr=True)))
    columns = ("surroundings", "sticking, found", "more than 40 nats", "sound, accused", "more than 40 nats")
    rows = [row(name, [each for each in found if each.surroundings == name]) for name in SURROUNDINGS]
    print(table(f"### Other surroundings, {len(seeds)} seeds of {len(KINDS)} kinds", columns, rows))


def row(name: str, cases: list[Said]) -> tuple[str, ...]:
    """Return how many of the valves are called sticking, and how many have many nats."""
    numbers = []
    for sticks in (True, False):
        ones = [each for each in cases if each.sticks == sticks]
        called = sum(each.calls_stiction for each in ones)
        numbers += [f"{called} of {len(ones)}", f"{sum(each.nats > MANY for each in ones)} of {len(ones)}"]
    return name, *numbers


def said(surroundings: str, kind: AnyKind, seed: int) -> Said:
    """Simulate a loop in its surroundings, and diagnose it."""
    change, historian = SURROUNDINGS[surroundings]
    scenario = change(random_scenario(kind, seed)[0])
    found = diagnose(window_kept(scenario.loop, scenario, historian))
    return Said(surroundings, kind in STICKING, found.verdict == "stiction", nats(found))

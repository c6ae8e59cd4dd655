"""One loop with a hidden effect, and the result of the workbench from OP, PV and SP alone."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Literal, get_args

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.physics.effects import EFFECTS
from agent.workbench.hypotheses import CONFIRMED
from agent.workbench.nuisance import nuisance
from agent.workbench.record import Record
from agent.workbench.session import Workbench
from agent.workbench.step import Step, Verdict
from benchmarks.cases.decoy import Decoy
from simulators.draws.effect_draws import SETTLING
from simulators.draws.hidden_effects import EVEN, HiddenEffectPlant, HiddenTruth, hidden_effect_plant
from simulators.draws.open_records import open_record
from simulators.parameters import Bursts

RecordKind = Literal["closed_loop", "steps", "bump", "prbs"]
RECORD_KINDS: tuple[RecordKind, ...] = get_args(RecordKind)
DECOYS = 2
BURST = 10.0
"""How long a burst lasts, s."""
FAMILIES = {effect.name: effect.family for effect in EFFECTS}
LAG_FAMILY = "extra_lag"
LAGS = tuple(name for name, family in FAMILIES.items() if family == LAG_FAMILY)


@dataclass(frozen=True, slots=True)
class HiddenCase:
    """A row of the file that `--save` writes; lists are words with a space between."""

    truth: HiddenTruth
    seed: int
    samples: int
    share_percent: float
    """Of the residual variance of the base that is not the floor's: what the effect carries."""
    floor: float
    """RMS of PV that no model of OP explains, level and drift removed as the base does; PV units."""
    kind: str
    """Of the verdict that led to the first step; of the last verdict where there is none. ``not_testable``:
    the record could not be tested, and there are no numbers."""
    effects: str
    """Of the last model that were confirmed, in the order in which they were added."""
    alike: str
    """Effects from which the record could not distinguish them."""
    rmse_base: float
    """Held out, PV units, like the next."""
    rmse_last: float
    floor_low: float
    """Of the reported interval, PV units."""
    floor_high: float
    covered: int
    """True parameters of effects that were named within their 90 % intervals."""
    parameters: int
    """How many there were."""
    without_kind: str
    """Verdict with a library without the true family and its indistinguishable effects; empty: not run."""
    cpu_seconds: float
    """Of ``auto`` alone."""
    record: RecordKind = "closed_loop"
    without_effect: str = ""
    """That this verdict names; empty where it names none."""
    own_lag: bool = False
    """Whether a lag was named whose interval holds one of the valve, which every simulated valve has."""

    @property
    def testable(self) -> bool:
        """Whether the record could be tested."""
        return self.kind != "not_testable"

    @property
    def true_effects(self) -> set[str]:
        return set(effects_of(self.truth))

    @property
    def true_families(self) -> set[str]:
        return {FAMILIES[effect] for effect in self.true_effects}

    @property
    def named(self) -> list[str]:
        """Effects named, those of decoys left out."""
        return [effect for effect in self.effects.split() if effect in FAMILIES]

    @property
    def families(self) -> set[str]:
        return {FAMILIES[effect] for effect in self.named}

    @property
    def decoys(self) -> int:
        return len(self.effects.split()) - len(self.named)

    @property
    def wrong(self) -> bool:
        """Whether a family was named that the loop does not have; the lag of its stem it has."""
        own = {LAG_FAMILY} if self.own_lag else set()
        return bool(self.families - self.true_families - own)

    @property
    def family_right(self) -> bool:
        return bool(self.true_families) and self.true_families <= self.families

    @property
    def exact(self) -> bool:
        """Whether every true effect was named, or is in the set that could not be distinguished."""
        return bool(self.true_effects) and self.true_effects <= {*self.named, *self.alike.split()}


def effects_of(truth: HiddenTruth) -> tuple[str, ...]:
    """Return the effects of a truth by their names in the library."""
    return tuple(truth.split("_")) if truth == "stiction_sinusoid" else (truth,) * (truth in FAMILIES)


def judge(
    truth: HiddenTruth,
    seed: int,
    record: RecordKind = "closed_loop",
    bursts: float = 0.0,
    *,
    test_without: bool = True,
) -> HiddenCase:
    """Draw one loop and let the workbench find what it hides in a record of this kind.

    ``bursts``: deviation of the logarithm of how strong noise and loads are.
    ``test_without``: where one effect is hidden, run it again with the true family out of the library.
    """
    plant, window = drawn(truth, seed, record, bursts)
    decoys = tuple(Decoy(DECOYS * seed + each) for each in range(DECOYS))
    started = time.process_time()
    bench = Workbench(window, extra=decoys)
    steps = bench.auto()
    spent = time.process_time() - started
    if not steps:
        return _untestable(truth, seed, record, len(window.op), spent)
    found = bench.comparison()
    last = steps[-1]
    floor = floor_of(plant, bench.record)
    took = [step for step in steps if step.added in last.effects and step.verdict is not None]
    alike = set(chain.from_iterable(step.verdict.indistinguishable for step in took if step.verdict))
    first = took[0].verdict if took else found.verdict
    covered = covers(parameters_of(plant, record), last)
    one_effect = test_without and len(plant.effects) == 1
    without = without_truth(window, plant, alike, decoys) if one_effect else None
    return HiddenCase(
        truth=truth,
        seed=seed,
        samples=len(window.op),
        share_percent=100 * max(0.0, 1 - (floor / steps[0].rmse_fit) ** 2),
        floor=floor,
        kind=first.kind if first is not None else "",
        effects=" ".join(step.added for step in took if step.verdict and step.verdict.kind in CONFIRMED),
        alike=" ".join(sorted(alike)),
        rmse_base=steps[0].held_out.rmse,
        rmse_last=last.held_out.rmse,
        floor_low=found.noise_floor.low if found.noise_floor else np.nan,
        floor_high=found.noise_floor.high if found.noise_floor else np.nan,
        covered=sum(covered),
        parameters=len(covered),
        without_kind=without.kind if without else "",
        cpu_seconds=spent,
        record=record,
        without_effect=(without.effect if without else None) or "",
        own_lag=any(covers({f"{name}.tau": lags_of_valve(plant) for name in LAGS}, last)),
    )


def drawn(
    truth: HiddenTruth, seed: int, record: RecordKind, bursts: float = 0.0
) -> tuple[HiddenEffectPlant, LoopWindow]:
    """Return a loop in a record of this kind, and what the workbench gets of it: in manual no set point."""
    uneven = Bursts(std=bursts, correlation=BURST) if bursts else EVEN
    plant = hidden_effect_plant(seed, truth, bursts=uneven)
    scenario = plant.scenario
    if record == "closed_loop":
        return plant, LoopWindow(scenario.loop, 0.0, scenario.ts, plant.op, plant.pv, plant.sp)
    manual = open_record(seed, record, truth, uneven)
    plant = replace(
        plant, scenario=manual.scenario, op=manual.op, pv=manual.pv, sp=manual.pv, floor=manual.floor
    )
    return plant, LoopWindow(scenario.loop, 0.0, scenario.ts, manual.op, manual.pv)


def parameters_of(plant: HiddenEffectPlant, record: RecordKind) -> dict[str, tuple[float, ...]]:
    """Return the true parameters; a record in manual has no samples before it that settle the loop."""
    early = 0.0 if record == "closed_loop" else SETTLING * plant.scenario.ts
    return {
        name: tuple(each + early for each in values) if name.endswith(".time") else values
        for name, values in plant.parameters.items()
    }


def lags_of_valve(plant: HiddenEffectPlant) -> tuple[float, ...]:
    """Return lags of a stroke without friction behind OP, s: of the stem, and with the positioner.

    The shorter lag of the positioner may be a part of the dead time.
    """
    valve = plant.scenario.valve
    return valve.damping, valve.tau_ip + valve.damping


def _untestable(truth: HiddenTruth, seed: int, record: RecordKind, samples: int, spent: float) -> HiddenCase:
    numbers = dict.fromkeys(
        ("share_percent", "floor", "rmse_base", "rmse_last", "floor_low", "floor_high"), np.nan
    )
    return HiddenCase(
        truth=truth,
        seed=seed,
        samples=samples,
        kind="not_testable",
        effects="",
        alike="",
        covered=0,
        parameters=0,
        without_kind="",
        cpu_seconds=spent,
        record=record,
        **numbers,
    )


def without_truth(
    window: LoopWindow, plant: HiddenEffectPlant, alike: set[str], decoys: tuple[Decoy, ...]
) -> Verdict:
    """Return the verdict with a library without the true family and its indistinguishable effects."""
    out = {FAMILIES[name] for name in (*plant.effects, *alike) if name in FAMILIES}
    return Workbench(window, without=out, extra=decoys).comparison().verdict


def floor_of(plant: HiddenEffectPlant, record: Record) -> float:
    counts = record.weight > 0
    columns = nuisance(len(record), record.period)[counts]
    floor = plant.floor[counts]
    left = floor - columns @ np.linalg.lstsq(columns, floor, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)))


def covers(known: Mapping[str, Sequence[float]], step: Step) -> list[bool]:
    """Return for each known parameter of a named effect whether its interval holds the truth."""
    return [
        any(parameter.low <= value <= parameter.high for value in known[parameter.name])
        for parameter in step.parameters
        if parameter.name in known
    ]

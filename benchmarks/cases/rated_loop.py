"""A simulated loop that oscillates, recorded at many rates: its diagnosis at each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from agent.analysis.diagnose import diagnose
from agent.analysis.evidence.weighing import features
from agent.analysis.gates import closed_kinds, gates
from agent.analysis.gates.fault import ALL_KINDS
from agent.analysis.gates.rhythm import COARSE
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.analysis.record.reversals import significant_reversals
from agent.analysis.seen import Seen
from agent.analysis.stiction import detect_stiction
from simulators.draws.periodicity import period_and_strength
from simulators.draws.random_plants import STEADY, Kind, random_draw
from simulators.plant import SimulatedRecord, simulate
from simulators.scenario import Scenario

How = Literal["samples", "means"]

SCANS = 240
"""Scans of the controller a period: a record at any of the rates takes a whole number of them."""
PERIODS = 30
"""Length of a record in periods, so that four samples a period are more than the hundred that are needed."""
SETTLING = 10
"""Periods that a loop runs before its record begins."""
RATES = (4, 5, 6, 8, 10, 12, 16, 20, 30, 48, 120)
"""Samples a period."""
LONGEST = 3000
"""Samples that a record has at most."""
HOWS: tuple[How, ...] = ("samples", "means")


@dataclass(frozen=True, slots=True)
class RatedLoop:
    """What the diagnosis of one record says; amounts in OP units, None where it says nothing."""

    kind: str
    seed: int
    how: How
    rate: int
    """Samples a period."""
    verdict: str
    confidence: float
    probability: float | None
    period: float | None
    """That was detected, over the true one."""
    gates: str
    """Names, with spaces between."""
    op_span: float
    op_step: float
    """Movement of OP from one sample to the next, median of those that move."""
    true_s: float
    true_j: float
    s: float | None
    s_low: float | None
    s_high: float | None
    j: float | None
    j_low: float | None
    j_high: float | None
    evidence: float | None
    quick: float | None
    likelihood: float | None
    fit: float | None
    """Of the model that sticks, %."""

    @property
    def sticks(self) -> bool:
        """Whether the valve does."""
        return self.kind == "stiction"

    @property
    def firm(self) -> bool:
        """Whether the verdict is a label."""
        return self.verdict in {"stiction", "no_stiction"}

    @property
    def right(self) -> bool:
        """Whether it is firm and true."""
        return self.verdict == ("stiction" if self.sticks else "no_stiction")

    @property
    def wrong(self) -> bool:
        """Whether it is firm and false."""
        return self.firm and not self.right

    @property
    def covered(self) -> bool | None:
        """Whether the interval holds S; None where there is none, or nothing to hold."""
        if not self.sticks or self.s_low is None or self.s_high is None:
            return None
        return self.s_low <= self.true_s <= self.s_high


def rated_loops(
    kind: Kind, seed: int, rates: Sequence[int] = RATES, *, gated: bool = True
) -> list[RatedLoop]:
    """Simulate the loop of a kind and a seed, record it at some rates, and diagnose each record.

    Args:
        kind: One whose loops oscillate: ``stiction``, ``tuning`` or ``sinusoid``.
        seed: Of the draw.
        rates: Samples a period, of ``RATES``.
        gated: Whether the limit on samples a period is in force; without it the limit is learnt.
    """
    drawn = finely_scanned(kind, seed)
    if drawn is None:
        return []
    scenario, record = drawn
    found = []
    for rate, how, op, pv in recordings(record, rates):
        window = LoopWindow(f"{kind}-{seed}", 0.0, scenario.ts * SCANS / rate, op, pv)
        found.append(_judged(window, scenario, kind, seed, how, rate, gated=gated))
    return found


def finely_scanned(kind: Kind, seed: int) -> tuple[Scenario, SimulatedRecord] | None:
    """Return a drawn loop whose controller has ``SCANS`` scans a period; None where it then is steady."""
    scenario = random_draw(seed, kind).scenario
    period, _ = period_and_strength(simulate(scenario).mv)
    ts = period * scenario.ts / SCANS
    changed = {"ts": ts, "duration": PERIODS * SCANS * ts, "warm_up": SETTLING * SCANS * ts}
    scenario = scenario.model_copy(update=changed)
    if kind == "tuning":
        scenario = _as_tight(scenario)
    record = simulate(scenario)
    found, strength = period_and_strength(record.mv)
    if strength < STEADY or not 0.5 * SCANS < found < 2 * SCANS:
        return None
    return scenario, record


def _as_tight(scenario: Scenario) -> Scenario:
    """Return a loop that scans finely with a gain that brings it as close to its limit as it was."""
    while scenario.peak_sensitivity < 12.0:
        controller = scenario.controller.model_copy(update={"kc": 1.03 * scenario.controller.kc})
        scenario = scenario.model_copy(update={"controller": controller})
    return scenario


def recordings(
    record: SimulatedRecord, rates: Sequence[int] = RATES
) -> Iterator[tuple[int, How, FloatArray, FloatArray]]:
    """Yield rate, how it was recorded, OP and PV, each (n,)."""
    for rate in rates:
        every = round(SCANS / rate)
        samples = min(len(record.op) // every, LONGEST)
        cut = slice(0, samples * every)
        yield rate, "samples", record.op[cut][::every], record.pv[cut][::every]
        op, pv = (each[cut].reshape(samples, every).mean(axis=1) for each in (record.op, record.pv))
        yield rate, "means", op, pv


def _judged(
    window: LoopWindow, scenario: Scenario, kind: str, seed: int, how: How, rate: int, *, gated: bool
) -> RatedLoop:
    seen = None if gated else _without_limit(window)
    found = diagnose(window, seen)
    fit = found.quantification
    stiction = None if fit is None else fit.stiction
    period = scenario.ts * SCANS
    said = found.oscillation.period if found.oscillation is not None else None
    steps = np.abs(np.diff(window.op))
    truth = scenario.truth
    weight = (None, None, None) if fit is None or fit.failure is not None else features(fit)[:3]
    return RatedLoop(
        kind=kind,
        seed=seed,
        how=how,
        rate=rate,
        verdict=found.verdict,
        confidence=found.confidence,
        probability=found.probability,
        period=None if said is None else said / period,
        gates=" ".join(found.gates),
        op_span=window.op_span,
        op_step=float(np.median(steps[steps > 0])) if (steps > 0).any() else 0.0,
        true_s=truth.f_s + truth.f_d,
        true_j=truth.f_s - truth.f_d,
        s=None if stiction is None else stiction.s.value,
        s_low=None if stiction is None else stiction.s.low,
        s_high=None if stiction is None else stiction.s.high,
        j=None if stiction is None else stiction.j.value,
        j_low=None if stiction is None else stiction.j.low,
        j_high=None if stiction is None else stiction.j.high,
        evidence=weight[0],
        quick=weight[1],
        likelihood=weight[2],
        fit=None if fit is None else fit.free_run_percent,
    )


def _without_limit(window: LoopWindow) -> Seen:
    """Return the first look at a window as if any number of samples a period were enough."""
    oscillation = detect_oscillation(window)
    faults = tuple(each for each in gates(window, oscillation) if each.name != COARSE)
    methods = {} if closed_kinds(faults) == ALL_KINDS else detect_stiction(window, oscillation, faults)
    return Seen(oscillation, faults, significant_reversals(window.op), methods)

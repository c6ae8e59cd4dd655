"""Simulated loops of every kind, as the diagnosis gets them, with their truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from agent.analysis.record.recording import FloatArray, LoopHints, LoopWindow
from agent.analysis.record.window_of_recording import NO_HINTS
from agent.analysis.results import Cause
from simulators.draws.random_cascades import CascadeKind, random_cascade
from simulators.draws.random_flows import FlowKind, random_flow
from simulators.draws.random_moves import MovedKind, random_moved
from simulators.draws.random_plants import Kind, random_draw
from simulators.historian import Historian, kept
from simulators.plant import SimulatedRecord, simulate
from simulators.scenario import Scenario

AnyKind = Literal[Kind, MovedKind, FlowKind, CascadeKind]
MOVED: tuple[MovedKind | FlowKind | CascadeKind, ...] = (
    *get_args(MovedKind),
    *get_args(FlowKind),
    *get_args(CascadeKind),
)
STEADY: tuple[Kind, ...] = get_args(Kind)
KINDS: tuple[AnyKind, ...] = (*STEADY, *MOVED)
STICKING = {
    "stiction",
    "set_point_stiction",
    "stiction_sinusoid",
    "flow_stiction",
    "cascade_stiction",
    "one_way_stiction",
}
CAUSES: dict[AnyKind, set[Cause]] = {
    "stiction": {"stiction"},
    "none_noise": {"no_oscillation"},
    "tuning": {"tight_tuning"},
    "sinusoid": {"external_disturbance"},
    "drift": {"no_oscillation", "external_disturbance"},
    "set_point": {"no_oscillation", "external_disturbance"},
    "set_point_stiction": {"stiction"},
    "stiction_sinusoid": {"stiction"},
    "flow": {"no_oscillation", "external_disturbance"},
    "flow_stiction": {"stiction"},
    "cascade": {"no_oscillation", "external_disturbance"},
    "cascade_stiction": {"stiction"},
    "one_way": {"no_oscillation", "external_disturbance"},
    "one_way_stiction": {"stiction"},
}
"""Causes that count as right; a load that wanders may look like an oscillation or not."""
STEM_NOISE = 0.02
"""Of the measured stem, over its standard deviation."""


@dataclass(frozen=True, slots=True)
class RandomLoop:
    """One loop."""

    kind: AnyKind
    seed: int
    window: LoopWindow
    """OP and PV, and SP where it moves."""
    stem: FloatArray
    """Measured stem, OP units, (n,)."""
    noise_percent: float | None
    """Of the standard deviation of PV without noise; None where nothing but noise moves PV, or SP does."""

    @property
    def sticks(self) -> bool:
        return self.kind in STICKING


def random_loop(kind: AnyKind, seed: int) -> RandomLoop:
    """Draw and simulate a loop; the same seed gives the same loop."""
    scenario, noise = random_scenario(kind, seed)
    record = simulate(scenario)
    rng = np.random.default_rng(seed)
    stem = record.mv + STEM_NOISE * np.std(record.mv) * rng.standard_normal(len(record.mv))
    return RandomLoop(kind, seed, window_of(scenario, record), stem, noise)


def random_scenario(kind: AnyKind, seed: int) -> tuple[Scenario, float | None]:
    """Draw a loop; return it with its noise, as ``RandomLoop`` has it."""
    match kind:
        case "flow" | "flow_stiction":
            return random_flow(seed, kind), None
        case "cascade" | "cascade_stiction" | "one_way" | "one_way_stiction":
            return random_cascade(seed, kind), None
        case "set_point" | "set_point_stiction" | "stiction_sinusoid":
            return random_moved(seed, kind), None
    draw = random_draw(seed, kind)
    return draw.scenario, None if draw.noise_share is None else 100 * draw.noise_share


def window_kept(
    loop: str, scenario: Scenario, historian: Historian, hints: LoopHints = NO_HINTS
) -> LoopWindow:
    """Run a scenario, and return what a historian keeps of it: SP only where it moves."""
    record = kept(simulate(scenario), historian)
    sp = record.sp if scenario.set_points else None
    ts = historian.every * scenario.ts
    return LoopWindow(loop, scenario.start, ts, record.op, record.pv, sp, hints=hints)


def window_of(scenario: Scenario, record: SimulatedRecord) -> LoopWindow:
    """Return the record that a historian keeps of a run: SP only where it moves."""
    sp = record.sp if scenario.set_points else None
    return LoopWindow(scenario.loop, 0.0, scenario.ts, record.op, record.pv, sp)

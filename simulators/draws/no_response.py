"""Random loops whose PV does not respond to OP, each for a known cause, from some time of the record on.

They are loops of ``random_flows`` whose set point steps. A draw in which OP does not travel far after the
fault, or in which the stem does not do what its kind requires, is discarded and the next one tried.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.units import FrictionBands
from simulators.draws.random_flows import random_draw_of_flow
from simulators.draws.random_moves import log_uniform
from simulators.parameters import Drift, FieldFault, SetPointStep, SinusoidParameters, Wander
from simulators.plant import SimulatedRecord, simulate

if TYPE_CHECKING:
    from simulators.scenario import Scenario

SilentKind = Literal["dead_transmitter", "no_flow", "stuck_valve", "jammed"]

DURATION = (800.0, 2000.0)
"""Range of the length of a record, s."""
BEGINS = (0.0, 0.5)
"""When the fault begins, part of the record."""
FAR = 8.0
"""Travel of OP after the fault, at least, OP units of a range of 100."""
QUIET = 0.2
"""Size of loads over that of ``random_flows``: PV stands."""
CUT_OFF = 0.01
"""Of a flow transmitter, over the operating point of PV; in half of the loops there is none."""
S = (12.0, 40.0)
"""Range of S of a valve that is stuck and slips at last, OP units."""
STOOD = 0.35
"""Part of the record for which nothing responds, at least."""

MEAN = 25
"""Samples of the mean of PV by which it is seen whether it stands."""
STANDS = 0.2
"""Span of that mean, over what the travel of OP would have given, up to which PV stands."""
NOISES = 8.0
"""Standard deviations of the noise that a slip exceeds."""


def random_silent(seed: int, kind: SilentKind) -> Scenario:
    """Draw a loop of a kind; the same seed gives the same loop.

    - ``dead_transmitter``: it holds its last value, or goes to one end of its range.
    - ``no_flow``: pump off or block valve closed; PV falls to zero.
    - ``stuck_valve``: the stem stands while OP travels far, then it slips.
    - ``jammed``: the stem stands to the end of the record.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    while True:
        scenario = _quiet(random_draw_of_flow(rng, f"{kind}-{seed}", seed, sticks=False), rng)
        scenario = _stuck(scenario, rng) if kind == "stuck_valve" else _faulty(scenario, rng, kind)
        record = simulate(scenario)
        if _stands_and_slips(record, scenario) if kind == "stuck_valve" else _travels(record, scenario):
            return scenario


def _quiet(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    """Return the loop with small loads and a set point that steps a few times."""
    duration = float(round(log_uniform(rng, *DURATION)))
    reach = abs(scenario.process.gain) * log_uniform(rng, 3.0, 15.0)
    times = np.sort(rng.uniform(0.0, 0.9 * duration, int(rng.integers(1, 7))))
    steps = tuple(
        SetPointStep(time=float(t), sp=float(scenario.controller.sp + reach * rng.uniform(-1, 1)))
        for t in times
    )
    drift, wander, wave = scenario.drift, scenario.wander, scenario.disturbance
    return scenario.model_copy(
        update={
            "duration": duration,
            "set_points": steps,
            "drift": Drift(ramp=QUIET * drift.ramp, walk=QUIET * drift.walk),
            "wander": Wander(std=QUIET * wander.std, correlation=wander.correlation),
            "disturbance": SinusoidParameters(amplitude=QUIET * wave.amplitude, period=wave.period),
            "load_steps": (),
        }
    )


def _faulty(scenario: Scenario, rng: np.random.Generator, kind: SilentKind) -> Scenario:
    level, time = scenario.controller.sp, float(rng.uniform(*BEGINS) * scenario.duration)
    match kind:
        case "no_flow":
            cut_off = CUT_OFF * level * rng.integers(2)
            fault = FieldFault(kind="no_flow", time=time, cut_off=float(cut_off))
        case "jammed":
            fault = FieldFault(kind="jammed", time=time)
        case _ if rng.random() < 0.5:
            fault = FieldFault(kind="transmitter_holds", time=time)
        case _:
            value = float(rng.choice([-0.05, 2.0]) * level)
            fault = FieldFault(kind="transmitter_fails", time=time, value=value)
    return scenario.model_copy(update={"fault": fault})


def _stuck(scenario: Scenario, rng: np.random.Generator) -> Scenario:
    s = log_uniform(rng, *S)
    bands = FrictionBands.from_s_j(s, j=s * rng.uniform(0.5, 1.0))
    valve = scenario.valve.model_copy(update={"law": "karnopp", "f_s": bands.f_s, "f_d": bands.f_d})
    return scenario.model_copy(update={"valve": valve})


def _travels(record: SimulatedRecord, scenario: Scenario) -> bool:
    after = record.op[int(scenario.fault.time / scenario.ts) + 1 :]
    far = np.flatnonzero(np.abs(after - after[0]) >= FAR)
    return bool(far.size and len(after) - far[0] >= STOOD * len(record.op))


def _stands_and_slips(record: SimulatedRecord, scenario: Scenario) -> bool:
    """Whether stem and PV stand while OP travels far, for long, and slip before the end, above the noise."""
    moves = np.flatnonzero(np.abs(np.diff(record.mv)) > 0.01)
    edges = np.concatenate(([0], moves + 1, [len(record.mv)]))
    longest = int(np.argmax(np.diff(edges)))
    begin, end = int(edges[longest]), int(edges[longest + 1])
    if end >= len(record.mv) - 20 or end - begin < STOOD * len(record.mv):
        return False
    gain, travel = abs(scenario.process.gain), float(np.ptp(record.op[begin:end]))
    jump = float(np.ptp(record.mv[end - 1 : end + 5]))
    pv = np.convolve(record.pv[begin:end], np.full(MEAN, 1 / MEAN), "valid")
    stands = float(np.ptp(pv)) <= STANDS * gain * travel
    return travel >= FAR and stands and gain * jump >= NOISES * scenario.noise.std

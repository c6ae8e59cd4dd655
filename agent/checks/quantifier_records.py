"""Records that quantifiers are checked on, and the rules that each of their answers keeps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.checks.contract import require
from agent.physics.processes import PROCESSES
from agent.physics.processes.arx import Arx, simulate_arx
from agent.physics.valves.he2007 import he2007

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.results import Quantification

    FloatArray = NDArray[np.float64]

N = 600
HINTS = LoopHints(order=1, integrating=False, acting="reverse")
FIRST_ORDER = Arx(a1=0.9, a2=0.0, b1=0.15, b2=0.0, bias=0.0, delay=4)


def swinging_op(samples: int = N) -> FloatArray:
    """Return a noisy wave of 60 samples with a span of 20 and a mean of 50 OP units, (n,)."""
    random = np.random.default_rng(0)
    op = np.sin(2 * np.pi * np.arange(samples) / 60) + 0.05 * random.standard_normal(samples)
    return np.asarray(50 + 20 * (op - op.mean()) / np.ptp(op), dtype=np.float64)


def loop(f_s: float, f_d: float, samples: int = N) -> LoopWindow:
    """Return a loop whose valve is that of He et al., with noise of 0.02 PV units."""
    op = swinging_op(samples)
    mv = he2007(op, f_s, f_d, op[0])
    model = np.nan_to_num(simulate_arx(FIRST_ORDER, mv - mv.mean(), np.zeros(samples)))
    pv = 100 + model + 0.02 * np.random.default_rng(1).standard_normal(samples)
    return LoopWindow("FIC101", 0.0, 2.0, op, pv, hints=HINTS)


STUCK = loop(4.0, 1.0)
STUCK_WITHOUT_KINETIC = loop(5.0, 0.0)
"""Of the same S; for a method whose valve has one parameter."""
FREE = loop(0.0, 0.0)
HALF = loop(4.0, 1.0, N // 2)
"""Five periods; where only the rules of an answer are checked."""


def with_gaps(window: LoopWindow, share: float) -> LoopWindow:
    """Return a window that has lost half the share of OP and half of PV, sample by sample."""
    random = np.random.default_rng(2)
    op, pv = window.op.copy(), window.pv.copy()
    op[random.random(N) < share / 2] = np.nan
    pv[random.random(N) < share / 2] = np.nan
    return replace(window, op=op, pv=pv)


def response(op: FloatArray) -> FloatArray:
    """Return PV of a free valve, PV units, (n,)."""
    return 100 + PROCESSES[0].respond(op, (10.0, 3.0))


def without_stiction() -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield records, OP and PV, in which nobody can see a valve stick."""
    random = np.random.default_rng(5)
    some = random.random(N) < 0.5
    nan, op, pv = np.nan, STUCK.op, STUCK.pv
    yield "all NaN", np.full(N, nan), np.full(N, nan)
    yield "no PV", op, np.full(N, nan)
    yield "constant OP", np.full(N, 42.0), pv
    yield "constant PV", op, np.full(N, 3.0)
    yield "20 samples", op[:20], pv[:20]
    yield "one sample", op[:1], pv[:1]
    yield "nothing", op[:0], pv[:0]
    yield "OP and PV never together", np.where(some, op, nan), np.where(some, nan, pv)
    yield "19 of 20 missing", np.where(random.random(N) < 0.05, op, nan), pv
    yield "known only at the end", np.where(np.arange(N) > N - 30, op, nan), pv
    step, ramp = np.where(np.arange(N) < N / 2, 40.0, 60.0), np.linspace(40.0, 60.0, N)
    yield "OP a step", step, response(step)
    yield "OP a noisy step", step, response(step) + 0.1 * random.standard_normal(N)
    yield "OP a ramp", ramp, response(ramp)
    yield "OP a ramp that PV does not lag", ramp, 10 + 15 * ramp
    yield "OP a noisy ramp", ramp, response(ramp) + 0.05 * random.standard_normal(N)
    noise = np.random.default_rng(3)
    yield "noise", noise.standard_normal(N), noise.standard_normal(N)


def odd_records() -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield records, OP and PV, short, torn or of a strange size, of which nobody says what the answer is."""
    random = np.random.default_rng(6)
    op, pv = STUCK.op, STUCK.pv
    three = 50 + 10 * np.round((op - 50) / 10)
    scattered = np.isin(np.arange(N), random.choice(N, 80, replace=False))
    block = (np.arange(N) >= 200) & (np.arange(N) < 280)
    yield "three values of OP, PV its response", three, response(three) + 0.01 * random.standard_normal(N)
    yield "OP moves three times", np.where(np.isin(np.arange(N), [100, 250, 400]), 50.1, 50.0), pv
    yield "60 samples", op[:60], pv[:60]
    yield "80 scattered samples", np.where(scattered, op, np.nan), np.where(scattered, pv, np.nan)
    yield "80 samples in a row", np.where(block, op, np.nan), np.where(block, pv, np.nan)
    yield "a spike of PV", op, np.where(np.arange(N) == 300, 1e12, pv)
    yield "far from zero", op + 1e9, pv - 1e9
    for scale in (1e-100, 1e-12, 1e12, 1e100):
        yield f"times {scale:g}", scale * op, scale * pv


def records_of_no_valve() -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield records, OP and PV, that no valve with a process explains: a search looks at them for long."""
    op, pv = STUCK.op, STUCK.pv
    yield "three values of OP", 50 + 10 * np.round((op - 50) / 10), pv
    yield "two values of PV", HALF.op, np.where(HALF.pv > HALF.pv.mean(), 1.0, 0.0)
    yield "a spike of OP", np.where(np.arange(N) == 300, 1e12, op), pv


def numbers(found: Quantification) -> list[float]:
    """Return all numbers of an answer that a reader may print."""
    estimates = found.stiction and (
        found.stiction.f_s,
        found.stiction.f_d,
        found.stiction.s,
        found.stiction.j,
    )
    process = found.process and (
        found.process.gain,
        found.process.tau,
        found.process.delay,
        found.process.tau2,
    )
    printed = [found.free_run_percent, found.linear_percent, found.evidence]
    printed += [estimate.value for estimate in estimates or ()] + list(process or ())
    return [number for number in printed if number is not None]


def sound(found: Quantification, window: LoopWindow) -> Quantification:
    """Return an answer that keeps the rules of ``Quantification``.

    Raises:
        ContractError: It breaks one.
    """
    require(all(math.isfinite(number) for number in numbers(found)), "a number is not finite")
    if found.failure is not None:
        require(found.decision == "not_applicable", f"it failed, and its decision is {found.decision!r}")
        answered = [name for name in ("stiction", "process", "evidence") if getattr(found, name) is not None]
        require(not answered, f"it failed, and has {', '.join(answered)}")
        return found
    decisions = ("stiction", "no_stiction", "undecided")
    require(found.decision in decisions, f"it did not fail, and its decision is {found.decision!r}")
    require(found.evidence is not None and found.evidence >= 1, f"its evidence is {found.evidence}")
    require(found.decision != "stiction" or found.stiction is not None, "it finds stiction without bands")
    if found.stiction is not None:
        f_s, f_d, s = found.stiction.f_s.value, found.stiction.f_d.value, found.stiction.s.value
        require(0 <= f_d <= f_s + 1e-9, f"f_D is {f_d:g} and f_S {f_s:g}")
        require(s <= window.op_span * (1 + 1e-9), f"S is {s:g}, more than the span of OP")
    require(found.process is not None, "it did not fail, and has no process")
    if found.process is not None:
        require(found.process.delay >= window.ts * (1 - 1e-9), f"its delay is {found.process.delay:g} s")
    for name in ("model_mv", "model_pv"):
        shape = np.shape(getattr(found, name))
        require(shape == (len(window),), f"{name} has shape {shape}")
    return found

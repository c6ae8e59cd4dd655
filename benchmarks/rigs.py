"""The workbench on laboratory rigs, against a linear output-error model of order three.

Real ones are read from the folder that SLIPJUMP_RIGS names, a CSV file each with OP and PV: the first half of
it is for the models, the second half for their validation, or all of it and `NAME.validation.csv`. Without
the folder simulated ones alone: those of `simulators.balances`.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track

from agent.analysis.record.recording import LoopWindow
from agent.analysis.record.window_of_recording import loop_window
from agent.identify.problem import bridge
from agent.runtime.loop.process_pool import process_pool
from agent.workbench.session import Workbench
from benchmarks.cases.options import Options
from benchmarks.cases.third_order import output_error
from benchmarks.tables.markdown import table
from connectors.recording import read_recording
from simulators.balances.laboratory_rigs import LABORATORY_RIGS, laboratory_rig
from simulators.balances.linear_rigs import LINEAR_RIGS, linear_rig
from simulators.balances.nonlinear_plants import NONLINEAR, nonlinear_record

FIRST_SEED = 95000
SEEDS, SEEDS_FULL = 2, 10
"""Of each simulated rig."""
VALIDATION = ".validation"


@dataclass(frozen=True, slots=True)
class Rig:
    """Two records of one rig."""

    name: str
    fitted: LoopWindow
    other: LoopWindow


@dataclass(frozen=True, slots=True)
class Scored:
    """How the models do on the other record, PV units."""

    name: str
    refused: str | None
    """In words why the workbench cannot test it."""
    base: str
    effects: tuple[str, ...]
    kind: str
    """Of the last verdict."""
    workbench: float
    third_order: float


def run(options: Options) -> None:
    """Print the table."""
    seeds = options.loops or (SEEDS_FULL if options.full else SEEDS)
    rigs = [*real_rigs(), *simulated(range(FIRST_SEED, FIRST_SEED + seeds))]
    with process_pool() as pool:
        found = list(track(pool.map(scored, rigs), "rigs", len(rigs), console=Console(stderr=True)))
    print(report(found))


def real_rigs() -> Iterator[Rig]:
    """Yield those of the folder that SLIPJUMP_RIGS names; none without one."""
    folder = os.environ.get("SLIPJUMP_RIGS")
    for path in sorted(Path(folder).glob("*.csv")) if folder else ():
        if path.stem.endswith(VALIDATION):
            continue
        window = loop_window(read_recording(path))
        other = path.with_name(f"{path.stem}{VALIDATION}.csv")
        if other.exists():
            yield Rig(path.stem, window, loop_window(read_recording(other)))
        else:
            yield in_halves(path.stem, window)


def simulated(seeds: Sequence[int]) -> Iterator[Rig]:
    """Yield those of the simulators."""
    for seed in seeds:
        for name in LINEAR_RIGS:
            rig = linear_rig(seed, name)
            yield in_halves(f"{name} {seed}", LoopWindow(name, 0.0, 1.0, rig.op, rig.pv))
        for known in LABORATORY_RIGS:
            sampled = laboratory_rig(seed, known)
            window = LoopWindow(known, 0.0, sampled.ts, sampled.op, sampled.pv)
            yield in_halves(f"{known} {seed}", window)
        for law in NONLINEAR:
            record = nonlinear_record(seed, law, "none")
            yield in_halves(f"{law} {seed}", LoopWindow(law, 0.0, 1.0, record.op, record.pv))


def in_halves(name: str, window: LoopWindow) -> Rig:
    """Return a rig of one record: the model sees the first half alone."""
    half = len(window.op) // 2
    parts = [
        LoopWindow(window.loop, 0.0, window.ts, window.op[part], window.pv[part])
        for part in (slice(None, half), slice(half, None))
    ]
    return Rig(name, *parts)


def scored(rig: Rig) -> Scored:
    """Fit both to one record, and run them on the other."""
    op, pv, other_op, other_pv = map(bridge, (rig.fitted.op, rig.fitted.pv, rig.other.op, rig.other.pv))
    linear = output_error(op, pv).rmse_on(other_op, other_pv)
    bench = Workbench(rig.fitted, base="auto", validate=rig.other)
    if bench.reason is not None:
        return Scored(rig.name, bench.reason, "", (), "", np.nan, linear)
    step, verdict = bench.auto()[-1], bench.comparison().verdict
    own = np.nan if step.rmse_validation is None else step.rmse_validation
    return Scored(rig.name, None, bench.base.name, step.effects, verdict.kind, own, linear)


def report(found: Sequence[Scored]) -> str:
    """Return a row for each rig."""
    rows = [
        (
            each.name,
            each.refused or f"`{each.base}`",
            ", ".join(f"`{name}`" for name in each.effects),
            each.kind,
            f"{each.workbench:.3g}",
            f"{each.third_order:.3g}",
            f"{each.workbench / each.third_order:.2f}",
        )
        for each in found
    ]
    columns = ("rig", "base", "effects", "verdict", "error on the other record", "of order three", "ratio")
    tested = [each for each in found if each.refused is None]
    better = sum(each.workbench <= each.third_order for each in tested)
    return "\n".join(
        (
            table("### Laboratory rigs", columns, rows),
            "",
            f"{len(tested)} of {len(found)} tested; {better} with at most the error of order three.",
        )
    )

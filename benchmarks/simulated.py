"""Random simulated loops whose valves obey Karnopp or LuGre: how often the verdict and the amount are right.

Nothing is told to the quantifiers but OP and PV. The seeds are not those that the threshold of ``lee2008``
was read off (0 to 39), nor those its tests use (100 to 119).
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import get_args

import numpy as np

from agent.analysis.diagnose import diagnose
from agent.analysis.quantify import quantifier
from agent.analysis.recording import LoopWindow
from agent.units import FrictionBands
from benchmarks.markdown import table
from simulators.plant import simulate
from simulators.random_plants import SHAPES, Kind, random_plant

FIRST_SEED = 1000
QUANTIFIERS = ("free_run", "lee2008")
KINDS: tuple[Kind, ...] = get_args(Kind)
SHAPE_NAMES = ("dead band", "both", "stick-slip")
SHAPE_LIMITS = [0.0, *((high + low) / 2 for (_, high), (low, _) in pairwise(SHAPES))]
"""J/S from which a valve counts to each of the shapes."""


@dataclass(frozen=True, slots=True)
class Case:
    """What one quantifier made of one simulated loop."""

    kind: Kind
    method: str
    verdict: str
    evidence: float
    shape: str
    """One of ``SHAPE_NAMES``; empty without stiction."""
    error_s: float
    """|S - true S| in % of the OP span of the record; NaN where there is no estimate, or no truth."""
    error_j: float
    seconds: float


def run(*, full: bool) -> None:
    """Print the tables of 20 loops of each kind, or of 60."""
    count = 60 if full else 20
    jobs = [(FIRST_SEED + seed, kind) for kind in KINDS for seed in range(count)]
    context = multiprocessing.get_context("forkserver")
    with ProcessPoolExecutor(len(os.sched_getaffinity(0)), mp_context=context) as pool:
        cases = [case for both in pool.map(judge, jobs) for case in both]
    print(verdicts(cases, count))
    print(evidence(cases))
    print(amounts(cases))


def judge(job: tuple[int, Kind]) -> list[Case]:
    """Simulate one loop and quantify it by each method; runs in a process of the pool."""
    seed, kind = job
    record = simulate(random_plant(seed, kind))
    truth = FrictionBands(record.truth.f_s, record.truth.f_d)
    window = LoopWindow(f"{kind}-{seed}", 0.0, 1.0, record.op, record.pv)
    cases = []
    for method in QUANTIFIERS:
        diagnosis = diagnose(window, quantifier=quantifier(method))
        found = diagnosis.quantification
        estimate = found.stiction if found is not None and truth.s > 0 else None
        percent = 100 / window.op_span if window.op_span else np.nan
        cases.append(
            Case(
                kind=kind,
                method=method,
                verdict=diagnosis.verdict,
                evidence=found.evidence if found is not None and found.evidence is not None else np.nan,
                shape=shape_of(truth.j / truth.s) if truth.s > 0 else "",
                error_s=abs(estimate.s.value - truth.s) * percent if estimate else np.nan,
                error_j=abs(estimate.j.value - truth.j) * percent if estimate else np.nan,
                seconds=diagnosis.seconds,
            )
        )
    return cases


def verdicts(cases: Sequence[Case], count: int) -> str:
    rows = []
    for kind in KINDS:
        row = [f"`{kind}`"]
        for method in QUANTIFIERS:
            ones = [case.verdict for case in cases if (case.kind, case.method) == (kind, method)]
            row += [share(ones, "stiction"), share(ones, "undecided")]
        rows.append(row)
    columns = ["kind", *(f"`{m}` {v}" for m in QUANTIFIERS for v in ("stiction", "undecided"))]
    return table(f"### Simulated loops, {count} of each kind: verdicts, %", columns, rows)


def share(verdicts: Sequence[str], wanted: str) -> str:
    return f"{100 * sum(verdict == wanted for verdict in verdicts) / len(verdicts):.0f}"


def evidence(cases: Sequence[Case]) -> str:
    rows = []
    for kind in KINDS:
        values = [case.evidence for case in cases if (case.kind, case.method) == (kind, "free_run")]
        known = np.array([value for value in values if np.isfinite(value)])
        marks = [f"{np.quantile(known, q):.2f}" for q in (0.1, 0.5, 0.9, 0.95, 1.0)]
        rows.append((f"`{kind}`", *marks, *(f"{100 * np.mean(known >= limit):.0f}" for limit in (1.25, 1.5))))
    columns = ("kind", "10 %", "median", "90 %", "95 %", "largest", "share >= 1.25, %", "share >= 1.5, %")
    return table("### Evidence of `free_run` on them", columns, rows)


def amounts(cases: Sequence[Case]) -> str:
    sticking = [case for case in cases if case.kind == "stiction"]
    groups = {
        "all": sticking,
        "called stiction": [case for case in sticking if case.verdict == "stiction"],
        **{name: [case for case in sticking if case.shape == name] for name in SHAPE_NAMES},
    }
    rows = []
    for name, group in groups.items():
        for method in QUANTIFIERS:
            ones = [case for case in group if case.method == method]
            told = [case for case in ones if np.isfinite(case.error_s)]
            s, j = (np.array([getattr(case, key) for case in told]) for key in ("error_s", "error_j"))
            rows.append(
                (
                    name,
                    f"`{method}`",
                    f"{len(told)} of {len(ones)}",
                    *two_quantiles(s),
                    f"{100 * np.mean(s <= 2):.0f}" if told else "",
                    *two_quantiles(j),
                )
            )
    columns = (
        "valves",
        "quantifier",
        "with a number",
        "S error, median",
        "90 %",
        "within 2 %",
        "J error, median",
        "90 %",
    )
    return table("### How much: errors in % of the OP span", columns, rows)


def shape_of(j_ratio: float) -> str:
    """Return the name of the shape that a valve with this J/S has."""
    return SHAPE_NAMES[sum(j_ratio >= limit for limit in SHAPE_LIMITS) - 1]


def two_quantiles(errors: np.ndarray[tuple[int], np.dtype[np.float64]]) -> tuple[str, str]:
    if not errors.size:
        return "", ""
    return f"{np.median(errors):.2f}", f"{np.quantile(errors, 0.9):.1f}"

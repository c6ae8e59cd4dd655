"""The weights of the evidence, from simulated loops: prints what `agent/analysis/evidence/weights.py` holds.

Logistic regression with a small penalty; no weight may be below zero. The seeds are used for nothing else.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import track
from scipy.optimize import minimize

from agent.analysis.diagnose import with_innovations
from agent.analysis.evidence.weighing import SAYS, features
from agent.analysis.gates import gates
from agent.analysis.oscillation import detect_oscillation
from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import FloatArray, LoopWindow
from agent.analysis.results import MethodResult
from agent.analysis.stiction import DETECTORS, detect_stiction
from benchmarks.cases.options import Options
from benchmarks.cases.random_loop import KINDS, AnyKind, RandomLoop, random_loop

SEEDS = range(3000, 3014)
MORE_SEEDS = range(3040, 3065)
HARD: tuple[AnyKind, ...] = (
    "drift",
    "set_point",
    "set_point_stiction",
    "stiction_sinusoid",
    "flow",
    "flow_stiction",
)
"""Kinds of which ``MORE_SEEDS`` are drawn as well: the others are easy to distinguish."""
FIT_NAMES = ("FREE_RUN", "FREE_RUN_QUICK", "INNOVATIONS_OVER_TURNS", "INNOVATIONS")
"""Of the weights of ``features``."""
PENALTY = 0.5
"""On half the sum of squares of the weights: keeps a weight small if few loops determine it."""
STEM_METHODS = ("kano_a", "kano_b", "yamashita", "damarla")
"""Those that take the measured stem where there is one."""


class Case(NamedTuple):
    """The results of all methods on one loop."""

    sticks: bool
    fit: tuple[float, float, float, float]
    """``features`` of ``free_run``."""
    says: list[int]
    """1, -1 or 0 of each detector."""
    says_with_stem: list[int]
    """The same of ``STEM_METHODS`` where the stem is measured."""


def run(_options: Options) -> None:
    """Print the table of weights."""
    jobs = [(kind, seed) for seed in SEEDS for kind in KINDS]
    jobs += [(kind, seed) for seed in MORE_SEEDS for kind in HARD]
    console = Console(stderr=True)
    print_weights([case(*job) for job in track(jobs, "training loops", console=console)])


def case(kind: AnyKind, seed: int) -> Case:
    loop = random_loop(kind, seed)
    found = with_innovations(quantifier("free_run").quantify(loop.window), loop.window)
    return case_of(loop, features(found))


def case_of(loop: RandomLoop, fit: tuple[float, float, float, float]) -> Case:
    with_stem = detected(replace(loop.window, mv=loop.stem))
    said = detected(loop.window)
    return Case(
        loop.sticks,
        fit,
        [SAYS.get(said[each.name].verdict, 0) for each in DETECTORS],
        [SAYS.get(with_stem[name].verdict, 0) for name in STEM_METHODS],
    )


def detected(window: LoopWindow) -> Mapping[str, MethodResult]:
    oscillation = detect_oscillation(window)
    return detect_stiction(window, oscillation, gates(window, oscillation))


def print_weights(cases: Sequence[Case]) -> None:
    sticks = np.array([each.sticks for each in cases], dtype=np.float64)
    names = [each.name for each in DETECTORS]
    said = np.array([[*each.fit, *each.says] for each in cases], dtype=np.float64)
    bias, *weights = learnt(said, sticks, np.zeros(len(cases)), with_bias=True)
    fit, detectors = weights[: len(FIT_NAMES)], dict(zip(names, weights[len(FIT_NAMES) :], strict=True))
    others = [name not in STEM_METHODS for name in names]
    known = bias + said @ np.array([*fit, *(np.array(weights[len(FIT_NAMES) :]) * others)])
    stem = np.array([each.says_with_stem for each in cases], dtype=np.float64)
    with_stem = dict(zip(STEM_METHODS, learnt(stem, sticks, known, with_bias=False)[1:], strict=True))
    for name, weight in zip(("BIAS", *FIT_NAMES), (bias, *fit), strict=True):
        print(f"{name} = {weight:.2f}")
    for title, table in (("DETECTORS", detectors), ("WITH_STEM", with_stem)):
        print(f"{title} = {{")
        for name, weight in table.items():
            print(f'    "{name}": {weight:.2f},')
        print("}")


def learnt(said: FloatArray, sticks: FloatArray, known: FloatArray, *, with_bias: bool) -> list[float]:
    """Return bias and weights (k + 1,) of the most likely log odds ``known`` + bias + ``said`` @ weights.

    Args:
        said: Result of each method on each loop, (n, k).
        sticks: 1 where the valve sticks, (n,).
        known: Log odds that are already known, (n,).
        with_bias: Whether the bias may be other than 0.
    """

    def cost(parameters: FloatArray) -> tuple[float, FloatArray]:
        log_odds = known + parameters[0] + said @ parameters[1:]
        wrong = np.logaddexp(0, log_odds) - sticks * log_odds
        slope = 1 / (1 + np.exp(-log_odds)) - sticks
        penalty = PENALTY * parameters * (np.arange(len(parameters)) > 0)
        return float(wrong.sum() + penalty @ parameters / 2), np.append(slope.sum(), slope @ said) + penalty

    free = (None, None) if with_bias else (0.0, 0.0)
    bounds = [free, *[(0.0, None)] * said.shape[1]]
    found = minimize(cost, np.zeros(said.shape[1] + 1), jac=True, method="L-BFGS-B", bounds=bounds)
    return [float(each) for each in found.x]

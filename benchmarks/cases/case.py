"""One simulated loop, and the result of one quantifier."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import LoopWindow
from simulators.draws.random_plants import SHAPES, Kind, random_draw
from simulators.plant import simulate

Amount = Literal["s", "j", "f_s", "f_d"]

SHAPE_NAMES = ("dead band", "both", "stick-slip")
SHAPE_LIMITS = [0.0, *((high + low) / 2 for (_, high), (low, _) in pairwise(SHAPES))]
"""J/S from which a valve counts to each of the shapes."""


@dataclass(frozen=True, slots=True)
class Case:
    """A row of the file that `--save` writes. None is not known, or does not apply."""

    kind: Kind
    seed: int
    method: str
    law: str
    """``none``, ``karnopp`` or ``lugre``."""
    process: str
    shape: str
    """One of ``SHAPE_NAMES``; ``none`` without stiction."""
    noise_percent: float | None
    """Of the standard deviation of PV without noise."""
    quantised: bool
    """Whether PV is."""
    op_span: float
    """OP units, as are all amounts below."""
    true_f_s: float
    true_f_d: float
    verdict: str
    evidence: float | None
    failure: str | None
    cpu_seconds: float
    """Of the quantifier alone."""
    identifiable_s: bool | None
    identifiable_j: bool | None
    f_s: float | None
    f_s_low: float | None
    f_s_high: float | None
    f_d: float | None
    f_d_low: float | None
    f_d_high: float | None
    s: float | None
    s_low: float | None
    s_high: float | None
    j: float | None
    j_low: float | None
    j_high: float | None

    def truth(self, amount: Amount) -> float:
        """Return the true amount, OP units."""
        return {
            "s": self.true_f_s + self.true_f_d,
            "j": self.true_f_s - self.true_f_d,
            "f_s": self.true_f_s,
            "f_d": self.true_f_d,
        }[amount]

    def error(self, amount: Amount) -> float:
        """Return |estimate - truth| in % of the OP span; infinite where there is no estimate."""
        value = getattr(self, amount)
        return np.inf if value is None else 100 * abs(value - self.truth(amount)) / self.op_span

    def has_interval(self, amount: Amount) -> bool:
        return getattr(self, f"{amount}_low") is not None and getattr(self, f"{amount}_high") is not None

    def covers(self, amount: Amount) -> bool:
        """Whether the interval, which must exist, holds the truth."""
        return bool(getattr(self, f"{amount}_low") <= self.truth(amount) <= getattr(self, f"{amount}_high"))

    def width(self, amount: Amount) -> float:
        """Return the width of the interval, which must exist, in % of the OP span."""
        return float(100 * (getattr(self, f"{amount}_high") - getattr(self, f"{amount}_low")) / self.op_span)


def warm(methods: Sequence[str]) -> None:
    """Load or compile what the methods need, so that the time of no case contains it."""
    t = np.arange(300.0)
    window = LoopWindow("warm", 0.0, 1.0, np.sin(t / 6), np.sin(t / 6 - 1))
    for method in methods:
        quantifier(method).quantify(window)


def judge(kind: Kind, seed: int, methods: Sequence[str]) -> list[Case]:
    """Simulate one loop and run each method on OP and PV alone, without any detector."""
    draw = random_draw(seed, kind)
    scenario = draw.scenario
    record = simulate(scenario)
    window = LoopWindow(scenario.loop, 0.0, scenario.ts, record.op, record.pv)
    cases = []
    for method in methods:
        started = time.process_time()
        found = quantifier(method).quantify(window)
        spent = time.process_time() - started
        stiction = found.stiction
        amounts: dict[str, float | None] = {}
        for amount in ("f_s", "f_d", "s", "j"):
            estimate = getattr(stiction, amount, None)
            amounts[amount] = getattr(estimate, "value", None)
            amounts[f"{amount}_low"] = getattr(estimate, "low", None)
            amounts[f"{amount}_high"] = getattr(estimate, "high", None)
        cases.append(
            Case(
                kind=kind,
                seed=seed,
                method=method,
                law=scenario.valve.law,
                process=scenario.process.kind.replace("_", " "),
                shape=shape_of(record.truth.f_s, record.truth.f_d),
                noise_percent=None if draw.noise_share is None else 100 * draw.noise_share,
                quantised=scenario.quantisation.pv > 0,
                op_span=window.op_span,
                true_f_s=record.truth.f_s,
                true_f_d=record.truth.f_d,
                verdict=found.decision,
                evidence=found.evidence,
                failure=found.failure,
                cpu_seconds=spent,
                identifiable_s=stiction.identifiable_s if stiction is not None else None,
                identifiable_j=stiction.identifiable_j if stiction is not None else None,
                **amounts,
            )
        )
    return cases


def shape_of(f_s: float, f_d: float) -> str:
    """Return the name of the shape of stiction that a valve with these bands has."""
    if f_s == 0:
        return "none"
    ratio = (f_s - f_d) / (f_s + f_d)
    return SHAPE_NAMES[sum(ratio >= limit for limit in SHAPE_LIMITS) - 1]

"""What must hold of the default quantifier (issue 3), target beside measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.cases.case import Amount, Case
from benchmarks.tables.markdown import table
from benchmarks.tables.quantiles import number, quantile
from benchmarks.tables.strata import LITTLE_NOISE, has_little_noise, of_method, sound, sticking, with_interval


@dataclass(frozen=True, slots=True)
class Target:
    """A number that must lie in a range."""

    what: str
    measured: float
    """NaN where there was nothing to measure, which does not hold."""
    least: float
    most: float
    cases: int

    @property
    def holds(self) -> bool:
        return self.least <= self.measured <= self.most

    def row(self) -> tuple[object, ...]:
        wanted = f"<= {self.most:g}" if self.least == 0 else f">= {self.least:g}"
        if self.least > 0 and self.most < 100:
            wanted = f"{self.least:g} to {self.most:g}"
        holds = "not measured" if np.isnan(self.measured) else "yes" if self.holds else "**no**"
        return self.what, self.cases, wanted, number(self.measured), holds


def targets(cases: Sequence[Case], method: str) -> str:
    ones = of_method(cases, method)
    quiet = [case for case in sticking(ones) if has_little_noise(case)]
    known_j = [case for case in quiet if case.identifiable_j]
    rows = [
        *errors("S", "s", quiet, 0.5, 2),
        *errors("J where identifiable", "j", known_j, 2, 8),
        share("J identifiable, % of the loops", [case.identifiable_j is True for case in quiet], 75, 100),
    ]
    amounts: tuple[tuple[str, Amount], ...] = (("S", "s"), ("J", "j"))
    for name, amount in amounts:
        for known, most in ((True, 97.0), (False, 100.0)):
            held = [case.covers(amount) for case in with_interval(quiet, amount, identifiable=known)]
            where = "identifiable" if known else "not identifiable"
            rows.append(share(f"intervals of {name} that hold the truth, {where}, %", held, 85, most))
    rows.append(
        share("sound loops called sticking, %", [case.verdict == "stiction" for case in sound(ones)], 0, 2)
    )
    title = f"### What must hold of `{method}`, on sticking loops with noise <= {LITTLE_NOISE:g} %"
    return table(title, ("what", "cases", "target", "measured", "holds"), [row.row() for row in rows])


def errors(
    name: str, amount: Amount, cases: Sequence[Case], median: float, ninth_decile: float
) -> list[Target]:
    values = [case.error(amount) for case in cases]
    limits = {"median": (0.5, median), "90th percentile": (0.9, ninth_decile)}
    return [
        Target(f"error of {name}, % of OP span, {word}", quantile(values, q), 0, most, len(cases))
        for word, (q, most) in limits.items()
    ]


def share(what: str, hits: Sequence[bool], least: float, most: float) -> Target:
    return Target(what, 100 * float(np.mean(hits)) if hits else np.nan, least, most, len(hits))

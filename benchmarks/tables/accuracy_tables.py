"""Tables of cases: errors of the amounts, coverage of the intervals, verdicts on sound loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

from benchmarks.cases.case import Amount, Case
from benchmarks.tables.markdown import table
from benchmarks.tables.quantiles import number, percent, quantile, two_quantiles
from benchmarks.tables.strata import (
    LITTLE_NOISE,
    STRATA,
    has_little_noise,
    of_method,
    sound,
    sticking,
    with_interval,
)
from simulators.draws.random_plants import Kind

AMOUNTS: dict[Amount, str] = {"s": "S", "j": "J", "f_s": "f_S", "f_d": "f_D"}
KINDS: tuple[Kind, ...] = get_args(Kind)
ERROR_COLUMNS = (
    "loops",
    "with a number",
    "S",
    "J",
    "f_S",
    "f_D",
    "J where identifiable",
    "S identifiable, %",
    "J identifiable, %",
    "CPU s, median",
)


def verdicts(cases: Sequence[Case], methods: Sequence[str]) -> str:
    rows = []
    for kind in KINDS:
        ones = {
            method: [case for case in of_method(cases, method) if case.kind == kind] for method in methods
        }
        counts = [
            percent(case.verdict == verdict for case in ones[method])
            for method in methods
            for verdict in ("stiction", "undecided")
        ]
        rows.append((f"`{kind}`", len(ones[methods[0]]), *counts))
    columns = (
        "kind",
        "loops",
        *(f"`{method}` {verdict}" for method in methods for verdict in ("stiction", "undecided")),
    )
    return table("### Verdicts on simulated loops, %", columns, rows)


def evidence(cases: Sequence[Case], method: str) -> str:
    """Return how the evidence is spread, to judge its thresholds by."""
    rows = []
    for kind in KINDS:
        values = [case.evidence for case in of_method(cases, method) if case.kind == kind]
        known = [value for value in values if value is not None]
        marks = [number(quantile(known, q)) for q in (0.1, 0.5, 0.9, 0.95, 1.0)]
        rows.append(
            (f"`{kind}`", *marks, *(percent(value >= limit for value in known) for limit in (1.25, 1.75)))
        )
    columns = ("kind", "10 %", "median", "90 %", "95 %", "largest", "share >= 1.25, %", "share >= 1.75, %")
    return table(f"### Evidence of `{method}` on them", columns, rows)


def errors_by_stratum(cases: Sequence[Case], method: str) -> str:
    ones = sticking(of_method(cases, method))
    rows = [error_row(name, [case for case in ones if belongs(case)]) for name, belongs in STRATA.items()]
    title = f"### How much, by `{method}`: errors in % of the OP span, median / 90th percentile"
    return table(title, ("sticking valves", *ERROR_COLUMNS), rows)


def errors_by_method(cases: Sequence[Case], methods: Sequence[str]) -> str:
    """Return a row for each method on the loops that all of them were run on."""
    shared = set.intersection(
        *({(case.kind, case.seed) for case in of_method(cases, each)} for each in methods)
    )
    common = [case for case in cases if (case.kind, case.seed) in shared]
    rows = []
    for method in methods:
        ones = of_method(common, method)
        row = error_row(f"`{method}`", [case for case in sticking(ones) if has_little_noise(case)])
        called = percent(case.verdict == "stiction" for case in sticking(ones))
        rows.append((*row, called, percent(case.verdict == "stiction" for case in sound(ones))))
    title = (
        f"### Quantifiers on the same {len(shared)} loops: errors with noise <= {LITTLE_NOISE:g} %, "
        "in % of the OP span, median / 90th percentile"
    )
    columns = ("quantifier", *ERROR_COLUMNS, "sticking called so, %", "sound called sticking, %")
    return table(title, columns, rows)


def error_row(name: str, cases: Sequence[Case]) -> tuple[object, ...]:
    known_j = [case for case in cases if case.identifiable_j]
    return (
        name,
        len(cases),
        sum(case.s is not None for case in cases),
        *(two_quantiles([case.error(amount) for case in cases]) for amount in AMOUNTS),
        two_quantiles([case.error("j") for case in known_j]),
        percent(case.identifiable_s is True for case in cases),
        percent(case.identifiable_j is True for case in cases),
        number(quantile([case.cpu_seconds for case in cases], 0.5)),
    )


def coverage(cases: Sequence[Case], method: str) -> str:
    """Return how often the 90 % intervals hold the truth, where it is called identifiable and where not."""
    rows = []
    sticky = sticking(of_method(cases, method))
    for amount, name in AMOUNTS.items():
        for word, known in (("yes", True), ("no", False)):
            ones = with_interval(sticky, amount, identifiable=known)
            widths = [case.width(amount) for case in ones]
            rows.append(
                (
                    name,
                    word,
                    len(ones),
                    percent(case.covers(amount) for case in ones),
                    number(quantile(widths, 0.5)),
                    number(quantile(widths, 0.9), 1),
                )
            )
    columns = (
        "amount",
        "identifiable",
        "intervals",
        "hold the truth, %",
        "width in % of OP span, median",
        "90 %",
    )
    return table(f"### 90 % intervals of `{method}`", columns, rows)

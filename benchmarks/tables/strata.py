"""Which cases go into a row of a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from benchmarks.cases.case import SHAPE_NAMES, Amount, Case

LITTLE_NOISE = 15.0
"""Noise up to which the targets hold, % of the standard deviation of PV."""

JUDGED_BY: dict[Amount, str] = {
    "s": "identifiable_s",
    "j": "identifiable_j",
    "f_s": "identifiable_j",
    "f_d": "identifiable_j",
}
"""f_S and f_D are (S + J)/2 and (S - J)/2, known no better than J, the less certain of the two."""

Belongs = Callable[[Case], bool]


def has_little_noise(case: Case) -> bool:
    return case.noise_percent is not None and case.noise_percent <= LITTLE_NOISE


def where(field: str, value: str | bool) -> Belongs:  # noqa: FBT001 - a value to compare with
    """Return a test for cases whose ``field`` is ``value``."""
    return lambda case: getattr(case, field) == value


STRATA: dict[str, Belongs] = {
    "all": lambda _: True,
    f"noise <= {LITTLE_NOISE:g} %": has_little_noise,
    f"noise > {LITTLE_NOISE:g} %": lambda case: not has_little_noise(case),
    **{name: where("shape", name) for name in SHAPE_NAMES},
    **{name: where("process", name) for name in ("first order", "second order", "integrating")},
    **{name: where("law", name) for name in ("karnopp", "lugre")},
    "PV quantised": where("quantised", True),
    "PV not quantised": where("quantised", False),
}
"""Of the sticking loops."""


def of_method(cases: Sequence[Case], method: str) -> list[Case]:
    return [case for case in cases if case.method == method]


def sticking(cases: Sequence[Case]) -> list[Case]:
    return [case for case in cases if case.kind == "stiction"]


def sound(cases: Sequence[Case]) -> list[Case]:
    return [case for case in cases if case.kind != "stiction"]


def with_interval(cases: Sequence[Case], amount: Amount, *, identifiable: bool) -> list[Case]:
    """Return the cases whose ``amount`` has an interval and is, or is not, called identifiable."""
    return [
        case
        for case in cases
        if case.has_interval(amount) and getattr(case, JUDGED_BY[amount]) is identifiable
    ]

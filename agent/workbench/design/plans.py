"""Tests that a person can do at a loop in manual: what OP does, by size and by how long a level is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from agent.durations import duration_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

PlanKind = Literal["still", "step", "bump", "back_in_steps", "staircase"]
PLAN_KINDS: tuple[PlanKind, ...] = get_args(PlanKind)
"""From the least work to the most."""
SIZES = (0.25, 0.5, 1.0)
"""Parts of the span that OP had in the record: no test goes where the loop has not been."""
HOLDS = (0.3, 1.0, 3.0)
"""How long a level is held, in the time for which OP affects PV."""
SMALL = 10
"""Small steps of a way back."""
STAIRS = 4


@dataclass(frozen=True, slots=True)
class Plan:
    """What OP does."""

    kind: PlanKind
    size: float
    """OP units; 0 where OP stands."""
    hold: int
    """Samples for which a level is held."""
    op: FloatArray
    """OP units, (n,)."""


def plans(low: float, high: float, settling: float) -> Iterator[Plan]:
    """Yield tests within ``low`` and ``high``, OP units.

    ``settling``: for how long OP affects PV, samples.
    """
    holds = sorted({max(2, round(settling * each)) for each in HOLDS})
    for hold in holds:
        yield Plan("still", 0.0, hold, np.full(4 * hold, 0.5 * (low + high)))
        for size in (part * (high - low) for part in SIZES):
            first = 0.5 * (low + high - size)
            for kind in PLAN_KINDS[1:]:
                levels = first + size * np.array([0.0, *_levels(kind), *_levels(kind)[-1:]])
                yield Plan(kind, size, hold, np.repeat(levels, hold))


def plan_words(plan: Plan, ts: float) -> str:
    """Return what to do, as a sentence without its stop."""
    first, size = f"{plan.op[0]:.4g}", f"{plan.size:.3g}"
    held, whole = duration_words(plan.hold * ts), duration_words(len(plan.op) * ts)
    if plan.kind == "still":
        return f"in manual, keep OP at {first} for {whole}"
    begin = f"in manual, hold OP at {first} for {held}"
    by = {
        "step": f"step it up by {size} and hold it for another {duration_words(2 * plan.hold * ts)}",
        "bump": f"step it up by {size}, hold it for {held}, and step it back",
        "back_in_steps": (
            f"step it up by {size}, then back in {SMALL} steps of {plan.size / SMALL:.3g}, "
            f"each held for {held}"
        ),
        "staircase": (
            f"step it up {STAIRS} times by {plan.size / STAIRS:.3g} and down again, "
            f"each level held for {held}"
        ),
    }
    return f"{begin}, then {by[plan.kind]}: {whole} in all"


def _levels(kind: PlanKind) -> list[float]:
    """Return the levels after the first, parts of the size."""
    if kind == "step":
        return [1.0]
    if kind == "bump":
        return [1.0, 0.0]
    if kind == "back_in_steps":
        return [1.0, *(1.0 - np.arange(1, SMALL + 1) / SMALL).tolist()]
    up = np.arange(1, STAIRS + 1) / STAIRS
    return [*up.tolist(), *up[-2::-1].tolist(), 0.0]

"""Stems that valves which stick may have, and the process behind each."""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from agent.analysis.innovations.process_search import best_process
from agent.analysis.innovations.scattered_slips import ScatteredSlips, with_scattered_slips
from agent.analysis.innovations.stem import StickingStem
from agent.analysis.innovations.valve_search import best_valve
from agent.identify.objective import J_RATIO, S, valve_position

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.analysis.record.recording import FloatArray, LoopHints, LoopWindow
    from agent.analysis.results import Quantification
    from agent.identify.problem import Problem

LEAST_S = 0.02
"""S below this share of the OP span takes noise off OP, which any record likes a little."""


class FoundValve(NamedTuple):
    """The valve that ``free_run`` found, OP less its least value in OP spans."""

    s: float
    j: float
    stem: FloatArray | None
    """How it moved, (n,); None where that is not known."""

    @property
    def bands(self) -> tuple[float, float]:
        """Return S and J, OP spans."""
        return self.s, self.j


def valve_of(window: LoopWindow, found: Quantification) -> FoundValve | None:
    """Return the valve of an answer; None where it has none."""
    if found.stiction is None or not found.stiction.s.value > 0:
        return None
    s, j = found.stiction.s.value, found.stiction.j.value
    moved = found.model_mv if found.sticking is None else found.sticking.mv
    if found.least_error is not None:
        s, j, moved = found.least_error.s, found.least_error.j, found.least_error.mv
    stem = None if moved is None else np.ascontiguousarray((moved - np.nanmin(window.op)) / window.op_span)
    return FoundValve(s / window.op_span, j / window.op_span, stem)


def stems_of(
    valve: FoundValve | None, whitened: Sequence[Problem], hints: LoopHints
) -> Iterator[StickingStem]:
    """Yield the stem of the valve that was found and of that of a search, with the process behind it.

    A stem counts whether it turns or not: the likelihood shows where it stood while OP moved, and a load that
    did the same is in the innovations of both models. With its stem known, each valve gets the processes
    that the model without one may have.
    """
    stems = [] if valve is None or valve.s < LEAST_S or valve.stem is None else [(valve.stem, valve.bands)]
    searched = best_valve(whitened, hints, None if valve is None else valve.bands)
    if searched is not None and searched.candidate[S] >= LEAST_S:
        s, j_ratio = searched.candidate[[S, J_RATIO]].tolist()
        stems.append((valve_position(searched.candidate, whitened[searched.noise]), (s, j_ratio * s)))
    for stem, bands in stems:
        moved = [each._replace(op=stem[: len(each.op)]) for each in whitened]
        fit = best_process(moved, hints)
        if fit is not None:
            yield StickingStem(fit, moved, bands)


def with_scatter(
    stems: Sequence[StickingStem], whitened: Sequence[Problem], hints: LoopHints
) -> ScatteredSlips | None:
    """Return the likeliest stem whose friction scatters, begun at those whose friction does not."""
    found = [with_scattered_slips(each, whitened, hints) for each in stems]
    return max((each for each in found if each is not None), key=attrgetter("stem.likelihood"), default=None)

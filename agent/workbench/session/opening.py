"""Begins with a recording: what of it counts, the base alone, and which blocks are held out."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from agent.identify.noise.autoregression import innovations
from agent.physics.bases.base import StartingBase
from agent.physics.loop_model import LoopModel
from agent.workbench.fit import Fit, fit, fit_at, refit_from, residual_of
from agent.workbench.folds import folds_of
from agent.workbench.innovations import likelihood_ratio
from agent.workbench.inputs.measured_input import MeasuredInput
from agent.workbench.projection import target_of
from agent.workbench.record import Record, bare_record, closed_by, record_of
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.solved.from_before import begun_in_motion
from agent.workbench.trials import Trials

if TYPE_CHECKING:
    from collections.abc import Iterable

    from agent.analysis.record.recording import LoopWindow
    from agent.physics.bases import Base
    from agent.physics.effect import Effect
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.trial import Tried


def opened(window: LoopWindow, base: Base, run: Map, progress: Progress) -> tuple[Trials, Tried] | str:
    """Return what can be tested on a recording and its base fitted, or in plain words why nothing can be."""
    record = record_of(window, from_start=not base.linear)
    if isinstance(record, str):
        return record
    progress(base.name, 0, 1)
    fitted = fit(LoopModel(base), record, record.weight)
    if base.linear:
        record, fitted = _begun(record, fitted)
    folds = folds_of(record, fitted)
    if isinstance(folds, str):
        return folds
    trials = Trials(window, record, folds, run, progress)
    return trials, trials.predicted(fitted)


def _begun(record: Record, fitted: Fit) -> tuple[Record, Fit]:
    """Return a record and its base with what is from before it, where that makes the record far likelier.

    Sought from the fit that had to explain it, and from the base's own first values, which had not.
    """
    before = innovations(residual_of(fitted, record), longest=True)
    best, most = (record, fitted), VERY_STRONG
    for first in (fitted, *_first_values(record, fitted)):
        moving, again = _in_motion(record, first)
        after = None if moving.start is None else innovations(residual_of(again, record), longest=True)
        if before is None or after is None or moving.start is None:
            continue
        likelier = likelihood_ratio(before, after) - moving.start.shape[1] * math.log(len(record))
        if likelier > most:
            best, most = (moving, again), likelier
    return best


def _first_values(record: Record, fitted: Fit) -> list[Fit]:
    """Return a base with its own first values; none where it has none."""
    base = fitted.model.base
    if not isinstance(base, StartingBase):
        return []
    target = target_of(record, record.weight, linear=base.linear)
    values = base.starts(record.op, record.pv, record.facts)
    return [fit_at(fitted.model, record, target, each) for each in values]


def _in_motion(record: Record, first: Fit) -> tuple[Record, Fit]:
    """Return a record with what is from before it, and the base refitted.

    It is computed twice: of a base that had to explain it, then of one that had not. A third time changes
    the error of 18 rigs (``simulators.balances.linear_rigs``) by less than 0.1 %.
    """
    moving = begun_in_motion(first, record)
    if moving.start is None:
        return record, first
    again = refit_from(first.model, moving, first.values)
    moving = begun_in_motion(again, moving)
    return moving, refit_from(again.model, moving, again.values)


def other_record(window: LoopWindow, base: Base) -> Record:
    """Return another recording of the loop, on which models are scored.

    Raises:
        ValueError: Nothing can be scored on it; the text says why.
    """
    closed = closed_by(window)
    if closed is not None:
        raise ValueError(f"{window.loop} cannot validate anything: {closed}")
    return bare_record(window, from_start=not base.linear)


def validation(
    window: LoopWindow | None, base: Base, effects: Iterable[Effect] = ()
) -> tuple[Record | None, str | None]:
    """Return ``other_record``, or in words why nothing can be scored on it; both None without a window.

    Args:
        window: The other recording.
        base: Of the models.
        effects: That they may have: each measured input must be known in the other recording, too.
    """
    if window is None:
        return None, None
    for each in effects:
        if isinstance(each, MeasuredInput) and each.elsewhere is None:
            return None, f"{window.loop} is not validated: its other recording has no input {each.name}"
    try:
        return other_record(window, base), None
    except ValueError as error:
        return None, str(error)

"""Begins with a recording: what of it counts, the base alone, and which blocks are held out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.physics.loop_model import LoopModel
from agent.workbench.fit import fit, refit_from
from agent.workbench.folds import folds_of
from agent.workbench.record import Record, bare_record, closed_by, record_of
from agent.workbench.solved.from_before import begun_in_motion
from agent.workbench.trials import Trials

if TYPE_CHECKING:
    from agent.analysis.record.recording import LoopWindow
    from agent.physics.bases import Base
    from agent.workbench.hooks import Map, Progress
    from agent.workbench.trial import Tried

BEGINS = 2
"""How often what is from before a record is computed: of a base that had to explain it, then of one that
had not. A third changes the error of 18 rigs (``simulators.balances.linear_rigs``) by less than 0.1 %."""


def opened(window: LoopWindow, base: Base, run: Map, progress: Progress) -> tuple[Trials, Tried] | str:
    """Return what can be tested on a recording and its base fitted, or in plain words why nothing can be."""
    record = record_of(window, from_start=not base.linear)
    if isinstance(record, str):
        return record
    progress(base.name, 0, 1)
    fitted = fit(LoopModel(base), record, record.weight)
    for _ in range(BEGINS * base.linear):
        record = begun_in_motion(fitted, record)
        fitted = refit_from(fitted.model, record, fitted.values)
    folds = folds_of(record, fitted)
    if isinstance(folds, str):
        return folds
    trials = Trials(window, record, folds, run, progress)
    return trials, trials.predicted(fitted)


def other_record(window: LoopWindow, base: Base) -> Record:
    """Return another recording of the loop, on which models are scored.

    Raises:
        ValueError: Nothing can be scored on it; the text says why.
    """
    closed = closed_by(window)
    if closed is not None:
        raise ValueError(f"{window.loop} cannot validate anything: {closed}")
    return bare_record(window, from_start=not base.linear)


def validation(window: LoopWindow | None, base: Base) -> tuple[Record | None, str | None]:
    """Return ``other_record``, or in words why nothing can be scored on it; both None without a window."""
    try:
        return (None if window is None else other_record(window, base)), None
    except ValueError as error:
        return None, str(error)

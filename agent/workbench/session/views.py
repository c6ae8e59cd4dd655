"""What one step shows: where its model fails, lines in its residual, and its noise floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.workbench.folds import block_losses
from agent.workbench.residual.axes import physical_axes
from agent.workbench.residual.line_spectrum import LineSpectrum, line_spectrum
from agent.workbench.residual.noise_floor import NoiseFloor, noise_floor
from agent.workbench.residual.where import Failure, beside, where_it_fails

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.record import Record
    from agent.workbench.step import Step
    from agent.workbench.trials import Trials


def failures(step: Step, trials: Trials) -> tuple[Failure, ...]:
    """Return the residual of a step against each physical axis, the largest share first.

    Of the model where it predicts best: where the free run has drifted from the truth, its residual follows
    an axis though nothing is missing, or no longer does though something is.
    """
    panels = where_it_fails(
        _left(step, trials.record), axes_of(step, trials), trials.block, np.random.default_rng(0)
    )
    return beside(panels, step.estimate.dependence, step.estimate.happened)


def axes_of(step: Step, trials: Trials) -> dict[str, FloatArray]:
    """Return the axes against which the residual of a step is tested, each (n,)."""
    fitted, record = step.fit, trials.record
    moved = any(each.stage == "valve" for each in fitted.model.effects)
    return physical_axes(
        record.op,
        record.facts.ts,
        record.period,
        position=fitted.model.position(record.op, fitted.values, record.facts) if moved else None,
        set_point=trials.window.sp,
        start=trials.window.start,
    )


def against(step: Step, trials: Trials, axis: str) -> tuple[FloatArray, FloatArray]:
    """Return an axis and the residual that is tested against it, each (n,), NaN where unknown."""
    return axes_of(step, trials)[axis], _left(step, trials.record)


def lines(step: Step, trials: Trials) -> LineSpectrum | None:
    """Return the spectrum of the residual of a step, with its lines; None where it has none.

    Of the model where it predicts best: a wave that moves OP too is in free run taken for OP's own doing.
    """
    record = trials.record
    return line_spectrum(_left(step, record), record.op, record.facts.ts)


def floor(step: Step, trials: Trials, rng: np.random.Generator) -> NoiseFloor:
    """Return the interval of the noise floor.

    Of the model with which the record is predicted best: in closed loop the free run's error may fall below
    the floor.
    """
    record = trials.record
    seen, hidden = block_losses(record, trials.folds, step.estimate.pv), step.held_out.losses
    return noise_floor(_left(step, record), seen if np.nansum(seen) > np.nansum(hidden) else hidden, rng)


def _left(step: Step, record: Record) -> FloatArray:
    """Return PV less the model where it predicts best, PV units, (n,), NaN where PV counts for nothing."""
    return np.where(record.weight > 0, record.pv - step.estimate.pv, np.nan)

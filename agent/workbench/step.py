"""One step of the staircase: which effects the model has, how far the error fell, and why it was taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from agent.workbench.certainty.intervals import Estimate, FittedParameter, estimated
from agent.workbench.evidence import criterion_of
from agent.workbench.library import acts_on_op
from agent.workbench.validation import rmse_on

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray
    from agent.workbench.fit import Fit
    from agent.workbench.folds import HeldOut
    from agent.workbench.hooks import Map
    from agent.workbench.predictor import Predictor
    from agent.workbench.record import Record
    from agent.workbench.trial import Tried

VerdictKind = Literal[
    "confirmed", "family", "suggested", "none_of_the_known", "no_failure_visible", "not_testable"
]


@dataclass(frozen=True, slots=True)
class Verdict:
    """Which effect is missing, as far as the record shows."""

    kind: VerdictKind
    effect: str | None = None
    family: str | None = None
    indistinguishable: tuple[str, ...] = ()
    """The others that this record cannot distinguish from ``effect``."""
    at_bound: tuple[str, ...] = ()
    """Parameters of ``effect`` that ran into a bound: what it stands for is not confirmed then. Without an
    effect those of the process that ran into the upper one: slower than any that the record can show."""
    lacks: tuple[str, ...] = ()
    """In words what else the model lacks with ``effect``, or what makes it a suggestion."""


@dataclass(frozen=True, slots=True)
class Step:
    """A model and what became of the error."""

    added: str | None
    """None for the base, and where an effect was taken out."""
    dropped: str | None
    fit: Fit
    held_out: HeldOut
    predicts: tuple[Predictor, FloatArray] | None
    """As in ``Tried``, like the two before."""
    rmse_fit: float
    """Of the samples that count, PV units."""
    fit_percent: float
    """100 (1 - ||PV - model|| / ||PV - mean PV||) of the same."""
    estimate: Estimate
    """Of the parameters: in closed loop those of the free run would be biased."""
    verdict: Verdict | None
    """That led to it; None for the base, and where an effect was taken out by hand."""
    rmse_validation: float | None
    """On the other recording, PV units; None without one."""
    of_laws: float = 0.0
    """How much likelier the record is with the effects of the model that act on OP, twice a logarithm."""

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the model's effects."""
        return tuple(each.name for each in self.fit.model.effects)

    @property
    def parameters(self) -> tuple[FittedParameter, ...]:
        """All that were searched, each with its interval."""
        return self.estimate.parameters

    @property
    def numbers(self) -> tuple[FittedParameter, ...]:
        """All that were searched, then all that were solved for, each with its interval."""
        return (*self.estimate.parameters, *self.estimate.solved)


def step_of(
    found: Tried,
    record: Record,
    validation: Record | None,
    verdict: Verdict | None = None,
    *,
    added: str | None = None,
    dropped: str | None = None,
    before: Step | None = None,
    run: Map = map,
) -> Step:
    """Return the step to a model that was tried on ``record``, scored on ``validation`` too.

    ``before``: the step that it was made from, with or without one effect; None of the base. ``run`` works on
    several at a time.
    """
    counts = record.weight > 0
    missed = (record.pv - found.fit.pv)[counts]
    spread = float(np.linalg.norm(record.pv[counts] - record.pv[counts].mean()))
    return Step(
        added=added,
        dropped=dropped,
        fit=found.fit,
        held_out=found.held_out,
        predicts=found.predicts,
        rmse_fit=float(np.sqrt(np.mean(missed**2))),
        fit_percent=100 * (1 - float(np.linalg.norm(missed)) / spread),
        estimate=estimated(found, record, run),
        verdict=verdict,
        rmse_validation=None if validation is None else rmse_on(found.fit, validation),
        of_laws=_of_laws(found, record, before, added),
    )


def _of_laws(found: Tried, record: Record, before: Step | None, added: str | None) -> float:
    """Return how much likelier the record is with what acts on OP; one that is taken out was idle."""
    if before is None:
        return 0.0
    if added is None or not acts_on_op(found.fit.model.effects[-1], record.facts):
        return before.of_laws
    return before.of_laws + criterion_of(before, found, record)

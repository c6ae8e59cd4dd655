"""The shortest test at the loop that distinguishes two effects between which a record cannot decide.

Both fitted models predict PV for a test that has not been done. What of their difference no level explains,
behind the filter of the noise, is by how much the record of that test will be likelier with the true one
than with the other, twice a logarithm, on average. Where the stem stands before the test is unknown: the
start that makes the models most alike counts. So does a change of the other model's numbers that its record
allows: the two records are explained together.
Source: W. Hunter, A. Reiner, Designs for discriminating between two rival models, Technometrics 7 (1965) 307.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from agent.durations import duration_words
from agent.physics.bases.linear_process import LinearProcess
from agent.workbench.design.plans import Plan, plan_words, plans
from agent.workbench.design.rival import Rival, rival_of
from agent.workbench.residual.very_strong import VERY_STRONG

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.identify.noise.autoregression import Innovations
    from agent.workbench.fit import Fit
    from agent.workbench.record import Record
    from agent.workbench.step import Step, Verdict
    from agent.workbench.trial import Tried

    FloatArray = NDArray[np.float64]

NEEDED = 2 * VERY_STRONG
"""Of the mean difference: half as much is very strong, and a test falls short of its mean as often as not."""
HOPELESS = 1e-3
"""Of the same, below which no repetition of the best test helps."""
ROUNDING = 1e-12
"""Part of the largest information below which a number is not known at all."""
LEAST = 40
"""Samples of a test, at least, so that the filter of the noise has its past."""


@dataclass(frozen=True, slots=True)
class NextTest:
    """A test, and what either model would measure."""

    first: str
    """Effect of the likelier model."""
    second: str
    plan: Plan | None
    """None: no test with OP and PV alone distinguishes them."""
    repeats: int
    """How often it is to be done."""
    difference: float
    """By how much likelier the record of all repeats will be with the true model, twice a logarithm."""
    ts: float
    """s."""
    predicted: tuple[FloatArray, FloatArray] | None
    """PV of both models without its level, PV units, each (n,)."""
    noise: float
    """Standard deviation of what neither model predicts, PV units."""
    held: tuple[str, ...] = ()
    """Measured inputs of the models, which have to stand still in the test."""

    @property
    def words(self) -> str:
        """What to do and why, as one sentence without its stop."""
        pair = " from ".join(each.replace("_", " ") for each in (self.first, self.second))
        if self.plan is None:
            return f"no test with OP and PV alone distinguishes {pair}: measure the valve's position as well"
        often = "" if self.repeats == 1 else f"; do it {self.repeats} times"
        lasts = "" if self.repeats == 1 else f", {duration_words(self.repeats * len(self.plan.op) * self.ts)}"
        held = f"; hold {', '.join(self.held)} still meanwhile" if self.held else ""
        return f"to distinguish {pair}: {plan_words(self.plan, self.ts)}{often}{lasts}{held}"


def next_test(step: Step, verdict: Verdict, models: dict[str, Tried]) -> NextTest | None:
    """Return the test for the effect of a verdict and the first that cannot be distinguished from it.

    Args:
        step: The model that lacks the effect.
        verdict: On it.
        models: With each effect that was tried.

    Returns:
        None where the verdict has no rivals, or the model makes no predictions.
    """
    pair = [each for each in (verdict.effect or "", *verdict.indistinguishable) if each in models]
    if len(pair) < 2 or step.predicts is None:
        return None
    record = step.predicts[0].objective.record
    first, second = (rival_of(models[each].fit, record.facts) for each in pair[:2])
    ahead = models[pair[0]].predicts or step.predicts
    noise, variance = ahead[0].noise, ahead[0].variance(ahead[1])
    known = _information(second, record, noise, variance)
    names, facts, settling = (pair[0], pair[1]), record.facts, memory(step.fit, record)
    held = tuple(dict.fromkeys((*first.held, *second.held)))
    best: tuple[float, Plan, tuple[FloatArray, FloatArray]] | None = None
    for plan in sorted(plans(facts.op_low, facts.op_high, settling), key=lambda each: len(each.op)):
        if len(plan.op) < LEAST:
            continue
        difference, both = _difference(first, second, plan.op, noise, variance, known)
        if difference >= NEEDED:
            return NextTest(*names, plan, 1, difference, facts.ts, both, variance**0.5, held)
        worth = difference / len(plan.op)
        if best is None or worth > best[0] / len(best[1].op):
            best = difference, plan, both
    if best is None or best[0] < HOPELESS * NEEDED:
        return NextTest(*names, None, 0, 0.0, facts.ts, None, variance**0.5, held)
    repeats = int(np.ceil(NEEDED / best[0]))
    return NextTest(*names, best[1], repeats, repeats * best[0], facts.ts, best[2], variance**0.5, held)


def memory(base: Fit, record: Record) -> float:
    """Return how long OP affects PV, samples: delay and three time constants, one period where unknown."""
    own = len(base.model.base.parameters(record.facts))
    process = base.model.base.process(base.values[:own])
    if not isinstance(process, LinearProcess) or process.integrates:
        return record.period
    return (process.delay + process.settling) / record.facts.ts


def _information(rival: Rival, record: Record, noise: Innovations, variance: float) -> FloatArray:
    """Return what the record determines of a model's numbers, of ``Rival.sensitivity``, (j, j)."""
    moved = noise.filtered(rival.sensitivity(record.op))[len(noise.coefficients) :]
    moved = (moved - moved.mean(axis=0)) * record.weight[len(noise.coefficients) :, np.newaxis]
    return np.asarray(moved.T @ moved / variance, dtype=np.float64)


def _difference(
    first: Rival, second: Rival, op: FloatArray, noise: Innovations, variance: float, known: FloatArray
) -> tuple[float, tuple[FloatArray, FloatArray]]:
    """Return the least difference of two models in a test, and what they predict where it is least.

    ``known``: what the record determines of the second one's numbers, (j, j).
    """
    order = len(noise.coefficients)
    level = noise.filtered(np.ones_like(op))[order:, np.newaxis]
    level /= max(float(np.linalg.norm(level)), np.finfo(float).tiny)

    def white(columns: FloatArray) -> FloatArray:
        new = noise.filtered(columns)[order:]
        return np.asarray(new - level @ (level.T @ new), dtype=np.float64)

    moved = white(second.sensitivity(op))
    joint = moved.T @ moved / variance + known
    inverse = np.linalg.pinv(joint, rcond=ROUNDING, hermitian=True)
    one, other = first.predictions(op), second.predictions(op)
    least, both = np.inf, (one[0], other[0])
    for mine in one:
        for its in other:
            apart = white((mine - its)[:, np.newaxis])[:, 0]
            along = moved.T @ apart / variance
            found = float(apart @ apart) / variance - float(along @ inverse @ along)
            if found < least:
                least, both = found, (mine - mine.mean(), its - its.mean())
    return max(least, 0.0), both

"""What mends a visible failure of a model, however little it lowers the error in free run.

A lag of half a sample lowers the squared error of a noisy record by a thousandth, and may still be all that a
model lacks. Such an effect is not confirmed, but the failure has a known explanation, which is suggested.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from agent.workbench.residual.holm import LEVEL
from agent.workbench.residual.state_dependence import fails, state_dependence

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from agent.workbench.hypotheses import Candidate
    from agent.workbench.residual.state_dependence import Dependence
    from agent.workbench.trial import Tried

LITTLE = "it lowers the held-out squared error by less than 5 %, but with it the model does not fail any more"
"""In words, of an effect of ``mended_by``."""


def mended_by(
    candidates: Iterable[Candidate],
    models: Mapping[str, Tried],
    dependence: Mapping[str, Dependence],
    rejected: Collection[str],
) -> tuple[Candidate, ...]:
    """Return the effects with which a failing model fails no more, the likeliest first.

    Args:
        candidates: On top of the model, the largest reduction first.
        models: With each.
        dependence: Of the model without any of them, on OP's level, rate, travel and time.
        rejected: Effects that a check lowers.
    """
    if not fails(dependence):
        return ()
    able = [
        each
        for each in candidates
        if each.odds > 0.0 and (each.p < LEVEL or not each.by_blocks)
        if each.objection is None and not each.at_bound and each.effect not in rejected
    ]
    complete = (each for each in able if _complete(models[each.effect]))
    return tuple(sorted(complete, key=lambda each: -each.criterion))


def _complete(found: Tried) -> bool:
    return found.predicts is not None and not fails(state_dependence(*found.predicts))

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

    from agent.workbench.decision import Candidate
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
    """Return the effects with which a failing model fails no more, the least likely by chance first.

    Args:
        candidates: On top of the model, the largest reduction first.
        models: With each.
        dependence: Of the model without any of them, on OP's level, rate, travel and time.
        rejected: Effects that a check rejects, or of which a parameter ran into a bound.
    """
    if not fails(dependence):
        return ()
    able = [
        each
        for each in candidates
        if each.p < LEVEL and each.objection is None and each.effect not in rejected
    ]
    return tuple(sorted((each for each in able if _complete(models[each.effect])), key=lambda each: each.p))


def _complete(found: Tried) -> bool:
    return found.predicts is not None and not fails(state_dependence(*found.predicts))

"""How likely a record would show a valve that sticks: what it says where none is found.

A window in which OP hardly moves, or noise hides what a slip does to PV, looks the same with and without
stiction. So "nothing found" speaks against stiction only as far as the record would have shown it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.evidence.weighing import LITTLE_LIKELIHOOD
from agent.analysis.innovations.whitened import fitted, log_likelihood
from agent.identify.free_run_error import response_to
from agent.identify.objective import fit_gain
from agent.physics.valves.he2007 import he2007

if TYPE_CHECKING:
    from agent.analysis.innovations.whitened import Fit
    from agent.identify.problem import Problem

S_OF_RANGE = (0.01, 0.02, 0.05, 0.1)
"""S, share of the OP range, each as likely as another: from the least that matters to one that is overdue."""
J_SHARE = 0.3
"""J over S: a slip of a third of the band. What a stem shows depends on S far more than on J."""
EVALUATIONS = 40
"""Of the simplex that fits the process without a valve."""


def chance_to_show(linear: Fit, problem: Problem, op_range: float) -> float:
    """Return how likely a valve that sticks would have been seen, 0 to 1: the mean over its S.

    The stem of each S moves the process that was found; the best process without a valve is fitted to that.
    What it leaves, against the innovations of the record, are the nats that such a valve would have had. A
    stem that never moves would leave PV without a response to OP. Of valves with ``LITTLE_LIKELIHOOD`` nats,
    which ``weighing`` takes for the price of the search, one in e is not seen.

    Args:
        linear: The best process without a valve, behind one of the filters.
        problem: The record behind that filter, OP from its least value.
        op_range: Units of ``problem.op``.
    """
    follows = response_to(problem.op, linear.candidate, linear.structure, problem)
    error, gain, _ = fit_gain(follows, linear.candidate, linear.structure, problem)
    count = float(problem.weight.sum())
    responds = log_likelihood(linear, problem) - log_likelihood(
        linear, problem._replace(op=np.zeros_like(problem.op))
    )
    shown = []
    for s in np.multiply(S_OF_RANGE, op_range).tolist():
        stem = he2007(problem.op, 0.5 * (1 + J_SHARE) * s, 0.5 * (1 - J_SHARE) * s, float(problem.op[0]))
        if np.ptp(stem) == 0:
            shown.append(responds)
            continue
        pv = response_to(stem, linear.candidate, linear.structure, problem)
        pv = gain * pv * problem.weight
        pv = (pv - problem.basis @ (problem.basis.T @ pv)) * problem.weight
        rest = fitted(linear.candidate, linear.structure, problem._replace(pv=pv), linear.noise, EVALUATIONS)
        left = count * math.exp(-2 * rest.score / count)
        shown.append(0.5 * count * math.log1p(left / max(error, 1e-300)))
    return float(np.mean([1 - math.exp(-max(nats, 0.0) / LITTLE_LIKELIHOOD) for nats in shown]))

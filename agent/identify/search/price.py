"""What a model costs beside its error: one criterion for better, everywhere in the search.

The search compares log likelihoods: -n/2 log(error) of n blocks, less log(n)/2 for each number that a model
has more than the simplest one (Schwarz, Annals of Statistics 6 (1978) 461), plus the log of a prior. As a
factor of the error that is n^(numbers / n) times that of the prior: it prefers a stem that comes to rest with
little force left, and stiff bristles: a record with one slip each way determines only S + rest J and
(1 - rest) J, and what bristles give trades off with f_S.
"""

from __future__ import annotations

import math

from agent.identify.arrays import FloatArray
from agent.identify.objective import BRISTLES, J_RATIO, LOG_REST, SOPDT, S
from agent.identify.problem import Problem
from agent.jit import kernel

DEAR = 0.3
"""Relative rise of the error that a full slip jump must be worth to rest at its break-away force. Of 64
simulated loops (trial in ``reference/search.md``) those that slip once each way had S off by 17 % of the span
without it."""
DEAR_BRISTLES = 4.0
"""Weight of the square of what bristles give in that, likewise."""


@kernel
def price(candidate: FloatArray, structure: int, problem: Problem, count: float) -> float:
    """Return the factor by which a candidate's error counts; ``count``: blocks that count."""
    numbers = 0.0
    if structure == SOPDT:
        numbers += 1.0
    if candidate[BRISTLES] > 0.0:
        numbers += 1.0
    jump = candidate[S] * candidate[J_RATIO] / problem.op_span
    unlikely = jump * (math.exp(candidate[LOG_REST]) + DEAR_BRISTLES * candidate[BRISTLES] ** 2)
    return float((1.0 + DEAR * unlikely) * math.exp(numbers * math.log(count) / count))

"""The numbers of a model that least squares solves for, each with its 90 % interval.

The coefficients and the searched values are uncertain together: their covariance is that of the innovations
by all of them. What a user reads, an amplitude, a gain after a change, is a function of the coefficients; its
interval is that of the same function of normal draws.
Source: L. Ljung, System Identification, 2nd ed., 9.3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from agent.physics.effect import SolvedEffect
from agent.workbench.certainty.likelihood_profile import WIDER
from agent.workbench.paired_blocks import CONFIDENCE
from agent.workbench.predictor import DIFFERENCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Solved
    from agent.workbench.predictor import Predictor

DRAWS = 2000
TINY = np.finfo(float).tiny


def solved_numbers(predicts: Predictor, best: FloatArray) -> tuple[tuple[str, Solved, float, float], ...]:
    """Return each number by its full name, with the ends of its interval: ``gain``, ``sinusoid.amplitude``.

    Args:
        predicts: Of a model; a response that is PV itself has no gain.
        best: The point of the unit cube where its predictions are best, (k,).
    """
    objective = predicts.objective
    mean = predicts.fit(best).coefficients
    spread = np.linalg.cholesky(_covariance(predicts, best, mean))
    normal = np.random.default_rng(0).standard_normal((DRAWS, len(spread)))
    draws = np.tile(mean, (DRAWS, 1))
    draws[:, len(mean) - len(spread) :] += WIDER * normal @ spread.T
    numbers = _number(_solved_by(predicts, objective.space.values(best)), mean, draws)
    return tuple((name, *each) for name, each in numbers.items())


def solved_at(predicts: Predictor, values: FloatArray, coefficients: FloatArray) -> dict[str, Solved]:
    """Return each number of ``solved_numbers`` alone.

    Args:
        predicts: Of a model.
        values: That are searched, own units, (k,).
        coefficients: Of its columns, (c,).
    """
    return _solved_by(predicts, values)(coefficients)


def _solved_by(predicts: Predictor, values: FloatArray) -> Callable[[FloatArray], dict[str, Solved]]:
    """Return what makes numbers of coefficients, (c,)."""
    objective, model = predicts.objective, predicts.objective.model
    fixed = objective.target.fixed_gain
    per = "PV/OP/s" if model.base.name == "integrator" else "PV/OP"
    owners = np.array(objective.layout.owners(objective.record.op, values))
    own = [
        (effect, owners == effect.name)
        for effect in model.effects
        if isinstance(effect, SolvedEffect) and effect.name in owners
    ]

    def numbers(coefficients: FloatArray) -> dict[str, Solved]:
        gain = float(coefficients[0])
        found: dict[str, Solved] = {} if fixed else {"gain": (gain, per)}
        for effect, columns in own:
            for name, each in effect.solved(coefficients[columns], gain).items():
                if not (fixed and each[1] == "PV/OP"):
                    found[f"{effect.name}.{name}"] = each
        return found

    return numbers


def _number(
    numbers: Callable[[FloatArray], dict[str, Solved]], mean: FloatArray, draws: FloatArray
) -> dict[str, tuple[Solved, float, float]]:
    best = numbers(mean)
    scattered = [numbers(each) for each in draws]
    found = {}
    for name, (value, unit) in best.items():
        off = np.array([each[name][0] for each in scattered]) - value
        if unit == "rad":
            off = np.mod(off + np.pi, 2 * np.pi) - np.pi
        low, high = value + np.quantile(off, ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2))
        found[name] = ((value, unit), float(low), float(high))
    return found


def _covariance(predicts: Predictor, best: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return the covariance of coefficients that are solved for, (c, c), searched values uncertain."""
    objective = predicts.objective
    white = predicts.whitened(predicts.solved_for(objective.columns(best)))
    count, moved = white.shape[1], np.empty((len(white), len(best)))
    for i, place in enumerate(best.tolist()):
        ends = np.vstack((best, best))
        ends[:, i] = max(place - DIFFERENCE, 0.0), min(place + DIFFERENCE, 1.0)
        rise = (objective.columns(ends[1]) - objective.columns(ends[0])) @ coefficients
        moved[:, i] = predicts.whitened(rise[:, np.newaxis])[:, 0] / (ends[1, i] - ends[0, i])
    both = np.hstack((white, np.nan_to_num(moved)))
    information = both.T @ both / predicts.variance(best)
    # One more observation of each searched value: it lies somewhere in the cube.
    prior = np.concatenate((1e-12 * np.diag(information)[:count] + TINY, np.ones(len(best))))
    scale = 1 / np.sqrt(np.diag(information) + prior)
    scaled = (information + np.diag(prior)) * np.outer(scale, scale)
    covariance = np.linalg.pinv(scaled, hermitian=True) * np.outer(scale, scale)
    own = covariance[:count, :count]
    return np.asarray(own + np.diag(1e-12 * np.diag(own) + TINY), dtype=np.float64)

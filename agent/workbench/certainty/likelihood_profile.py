"""How far a parameter can be moved before the record objects: a profile of the likelihood.

The error over S and J is a needle beside others, and over a rate or a stop it is no parabola, so that the
derivatives at the best say too little. Here one parameter is moved outward, all others refitted, until the
innovations, white as they are, are clearly less likely than the best ones. A refit that is likely enough is
not made better: whether there is one is all that a distance is for.
Source: Cox and Hinkley, Theoretical Statistics (1974), 9.3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np
from scipy import stats

from agent.physics.effects.hysteresis import MOTION
from agent.workbench.gauss_newton import lowest
from agent.workbench.paired_blocks import CONFIDENCE
from agent.workbench.search import COARSE, SAME, STEPS
from agent.workbench.simplex import lowered_by_simplex

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Parameter
    from agent.workbench.hooks import Map

WIDER = 1.1
"""Intervals of what answers OP over those of the books, which take OP for given; in closed loop it holds the
noise. Of 148 parameters of six effects (``simulators.draws.hidden_effects``, seeds 5145 to 5171) those of
the books hold 85 %, a fifth wider 91; of 118 that were named (5342 to 5369) a fifth wider hold 97, of 24
others (5349 to 5352) a tenth wider 79 (docs/decisions/0046)."""
QUANTILE = float(stats.norm.ppf(0.5 + CONFIDENCE / 2))
"""Half of an interval of the books, standard deviations."""
CLEARLY = (WIDER * QUANTILE) ** 2
"""Twice the logarithm of how much likelier the best is, from which on a value is distinguished from it."""
CLEARLY_AT_AN_INSTANT = float(-2 * np.log(1 - np.sqrt(CONFIDENCE)))
"""The same of an instant: it is at most x with a probability of (1 - exp(-x / 2))^2, that of a walk to either
side (D. Siegmund, Confidence sets in change-point problems, Int. Stat. Rev. 56 (1988) 31)."""
OUTWARD = (0.003, 0.01, 0.02, 0.04, 0.07, 0.11, 0.16, 0.24, 0.35, 0.5, 0.7, 1.0)
"""Distances from the best that are tried, parts of the parameter's range."""
PATIENCE = 3
"""Distances without an answer behind which one is still sought."""
HALVINGS = 4
"""Of the last distance, to find the end within it."""
EVALUATIONS = 25
"""Of a refit's simplex, for each parameter that moves."""
STEP = 0.02
"""First step of that refit, parts of a parameter's range."""


class Profiled(Protocol):
    """White residuals of a model, of one recording or of several, as a function of its values."""

    @property
    def count(self) -> int:
        """Samples."""

    @property
    def rough(self) -> bool:
        """Whether their squares have steps or kinks."""

    def residuals(self, points: FloatArray) -> FloatArray:
        """Return them at points of the unit cube, (m, k), each a row, (m, n), zeros between them allowed."""

    def error(self, at: FloatArray) -> float:
        """Return the sum of their squares at one of them; infinite where it has no answer."""

    def errors(self, points: FloatArray) -> FloatArray:
        """Return the same of points, (m,)."""


def by_derivatives(name: str) -> float:
    """Return half of the interval of a number that lasts, standard deviations by the derivatives.

    0 of a base, where the profile alone counts: two lags that are alike have no derivatives of their own.
    """
    return WIDER * QUANTILE if "." in name else 0.0


def as_likely(
    model: Profiled,
    best: FloatArray,
    parameters: Sequence[tuple[str, Parameter]],
    alike: tuple[int, ...],
    run: Map = map,
) -> FloatArray:
    """Return points as likely as the best, (m, k): the best, and the profiles of what lasts.

    Not of the motion of a stem, which a record mostly shows little of.

    Args:
        model: As ``likelihood_profile`` takes it, like ``best`` and ``alike``.
        best: (k,).
        parameters: With their names, of the first coordinates of the point.
        alike: Coordinates.
        run: Works on several at a time.
    """
    lasting = [
        at
        for at, (name, parameter) in enumerate(parameters)
        if not (parameter.constant or parameter.of_record or name.rpartition(".")[2] in MOTION)
    ]
    return np.vstack((best, *profiles(model, best, lasting, CLEARLY, alike, run)))


def profiles(
    model: Profiled,
    best: FloatArray,
    places: Sequence[int],
    clearly: float,
    alike: tuple[int, ...] = (),
    run: Map = map,
) -> list[FloatArray]:
    """Return ``likelihood_profile`` of several coordinates, ``run`` working on several at a time."""
    return list(run(_profile, [(model, best, at, clearly, alike) for at in places]))


def _profile(given: tuple[Profiled, FloatArray, int, float, tuple[int, ...]]) -> FloatArray:
    return likelihood_profile(*given)


def likelihood_profile(
    model: Profiled, best: FloatArray, at: int, clearly: float = CLEARLY, alike: tuple[int, ...] = ()
) -> FloatArray:
    """Return points as likely as the best, coordinate ``at`` from its least to its largest, (m, k).

    Args:
        model: Its innovations.
        best: Of the unit cube, (k,), where they are best.
        at: Which coordinate.
        clearly: Twice the logarithm of a ratio of likelihoods.
        alike: Coordinates that may change places, the largest first; they do not, but may be equal.
    """
    most = model.error(best) * float(np.exp(clearly / model.count))
    lower, upper = (_moved_outward(model, best, at, side, most, alike) for side in (-1.0, 1.0))
    return np.array([*lower[::-1], best, *upper])


def _moved_outward(
    model: Profiled, best: FloatArray, at: int, side: float, most: float, alike: tuple[int, ...]
) -> list[FloatArray]:
    """Return points with a coordinate ever farther to a ``side`` whose error is at most ``most``.

    Behind a few distances with more there may be others: a dead time has a valley within each sample.
    """
    found, inside = best, 0.0
    path: list[FloatArray] = []
    failed: list[float] = []
    room = float(1.0 - best[at] if side > 0 else best[at])
    for distance in (*(each for each in OUTWARD if each < room), room):
        moved, error = _in_order(model, found, at, best[at] + side * distance, most, alike)
        if error <= most:
            found, inside, failed = moved, distance, []
            path.append(moved)
        elif len(failed) < PATIENCE:
            failed.append(distance)
        else:
            break
    outside = failed[0] if failed else room
    for _ in range(HALVINGS if failed else 0):
        between = 0.5 * (inside + outside)
        moved, error = _in_order(model, found, at, best[at] + side * between, most, alike)
        if error > most:
            outside = between
        else:
            found, inside = moved, between
            path.append(moved)
    return path


def _in_order(
    model: Profiled, start: FloatArray, at: int, place: float, most: float, alike: tuple[int, ...]
) -> tuple[FloatArray, float]:
    """Return ``refitted``, with those of ``alike`` that would pass the coordinate at its place."""
    moved, error = refitted(model, start, (at,), place, most)
    if at in alike:
        own = alike.index(at)
        passed = [each for each in alike[:own] if moved[each] < place]
        passed += [each for each in alike[own + 1 :] if moved[each] > place]
        if passed:
            return refitted(model, moved, (at, *passed), place, most)
    return moved, error


def refitted(
    model: Profiled, start: FloatArray, held: tuple[int, ...], place: float, most: float
) -> tuple[FloatArray, float]:
    """Return a point near ``start`` with the coordinates ``held`` at ``place``, and its error.

    The best one, but that the simplex, where steps or kinks stopped Gauss and Newton, ends at ``most``.
    """
    moves = ~np.isin(np.arange(len(start)), held)

    def whole(others: FloatArray) -> FloatArray:
        points = np.tile(start, (len(others), 1))
        points[:, ~moves], points[:, moves] = place, others
        return points

    def errors(others: FloatArray) -> FloatArray:
        return model.errors(whole(others))

    found = start[moves]
    if len(found):
        found = lowest(lambda others: model.residuals(whole(others)), found, STEPS, COARSE)
    point = whole(found[np.newaxis])[0]
    error = model.error(point)
    if not (len(found) and model.rough and error > most):
        return point, error
    flat = SAME / model.count * most
    found = lowered_by_simplex(errors, found, STEP, EVALUATIONS, near=1.0, flat=flat, enough=most)
    point = whole(found[np.newaxis])[0]
    return point, model.error(point)

"""Ellipse through the OP-PV plot of a swinging loop, and the apparent stiction read off it.

Choudhury, Shah, Thornhill and Shook (2006), Control Engineering Practice 14:1395: the width of the ellipse
along OP. It is called apparent because controller and process widen it too (reference ``methods.md`` 3.8).
The fit is the direct least-squares fit of Fitzgibbon, Pilu and Fisher (1999) in the numerically stable form
of Halir and Flusser (1998).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

FEWEST_POINTS = 6
"""An ellipse has five parameters."""
THINNEST = 1e-6
"""Width over length below which the points lie on a line."""


@dataclass(frozen=True, slots=True)
class Ellipse:
    """The points with a u^2 + b u v + c v^2 = 1, where u = x - x0 and v = y - y0."""

    x0: float
    """Units of x."""
    y0: float
    """Units of y."""
    a: float
    """One over the square of the units of x."""
    b: float
    """One over the units of x and of y."""
    c: float
    """One over the square of the units of y."""

    @property
    def chord(self) -> float:
        """Width through the centre along x, units of x."""
        return float(2 / np.sqrt(self.a))


def fit_ellipse(x: FloatArray, y: FloatArray) -> Ellipse | None:
    """Fit an ellipse to points (x, y), both of shape (n,); a point with a NaN in it is left out.

    Returns:
        The ellipse; None where there are fewer than six points, or they lie on a line or in one place.
    """
    known = np.isfinite(x) & np.isfinite(y)
    if np.count_nonzero(known) < FEWEST_POINTS:
        return None
    points = np.stack([x[known], y[known]])
    scale = np.std(points, axis=1, keepdims=True)
    if not (np.isfinite(scale).all() and (scale > 0).all()):
        return None
    mean = np.mean(points, axis=1, keepdims=True)
    scaled = (points - mean) / scale
    variances, axes = np.linalg.eigh(np.cov(scaled))
    if not variances[0] > THINNEST**2 * variances[1]:
        return None
    # With variance one each way all moments are of the same size, however thin the ellipse.
    whiten = (axes / np.sqrt(variances)).T
    conic = _fit_conic(*(whiten @ scaled))
    if conic is None:
        return None
    centre, form = conic
    form = whiten.T @ form @ whiten / (scale * scale.T)
    x0, y0 = mean[:, 0] + scale[:, 0] * np.linalg.solve(whiten, centre)
    return Ellipse(float(x0), float(y0), float(form[0, 0]), 2 * float(form[0, 1]), float(form[1, 1]))


def _fit_conic(u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Return centre (2,) and form (2, 2), w' form w = 1 about the centre; None where no ellipse fits.

    The conic p . (u^2, uv, v^2) + q . (u, v, 1) = 0 has the least sum of squares under 4 p1 p3 - p2^2 = 1,
    which makes it an ellipse. q follows from p by least squares; p is an eigenvector.
    """
    quadratic = np.stack([u * u, u * v, v * v])
    linear = np.stack([u, v, np.ones_like(u)])
    q_from_p = -np.linalg.solve(linear @ linear.T, linear @ quadratic.T)
    scatter = quadratic @ quadratic.T + quadratic @ linear.T @ q_from_p
    _, vectors = np.linalg.eig(np.stack([scatter[2] / 2, -scatter[1], scatter[0] / 2]))
    candidates = vectors.real
    p = candidates[:, np.argmax(4 * candidates[0] * candidates[2] - candidates[1] ** 2)]
    q = q_from_p @ p
    form = np.array([[p[0], p[1] / 2], [p[1] / 2, p[2]]])
    if not np.linalg.det(form) > THINNEST**2 * np.trace(form) ** 2:
        return None
    centre = -np.linalg.solve(form, q[:2]) / 2
    level = centre @ form @ centre - q[2]
    return (centre, form / level) if level * form[0, 0] > 0 else None


def apparent_stiction(op: FloatArray, pv: FloatArray) -> float | None:
    """Return the width along OP of the ellipse through OP and PV (n,); OP units, None without an ellipse."""
    ellipse = fit_ellipse(op, pv)
    return None if ellipse is None else ellipse.chord

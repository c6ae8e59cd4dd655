"""How plainly a record would show each effect if it were there: the information of its predictions.

An effect changes the free run. What of the change the model cannot imitate, by another value of its own, by
gain, level or drift, is seen in the innovations: its squares over their variance are by how much likelier the
record would be with the effect, twice a logarithm, if the effect were there (the noncentrality of the
likelihood ratio; Fisher information where the change is small). Computed for many values of the effect, the
largest counts. No effect is fitted.
Source: L. Ljung, System Identification, 2nd ed., 13.3 (informative experiments) and 16.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.record.signals import noise_level
from agent.physics.foreign import EffectError
from agent.workbench.objective import whitened
from agent.workbench.residual.movable import beyond, movable
from agent.workbench.residual.very_strong import VERY_STRONG
from agent.workbench.search import hypercube, searched
from agent.workbench.shown.changes import PLACES, changes
from agent.workbench.shown.excitation import excitation_of, not_excited
from agent.workbench.shown.score import shares_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.physics.effect import Effect
    from agent.workbench.hooks import Map
    from agent.workbench.predictor import Predictor
    from agent.workbench.search import Round

REFITTED = 3
"""Of them, the largest changes, before an effect is denied."""
ROUNDS: tuple[Round, ...] = ((3, 0.05, 20), (1, 0.02, 40))
IMITATED = 1e-8
"""Part of the squares of a change from which on the model does the same; the rest is rounding."""
TINY = np.finfo(float).tiny


@dataclass(frozen=True, slots=True)
class Shown:
    """What a record can show of one effect."""

    effect: str
    information: float
    """By how much likelier the record would be with it, twice a logarithm, where it is plainest; infinite
    for a disturbance, whose height may be any."""
    why_not: str | None
    """In words why the record cannot show it; None where it can."""


def shown_by(
    predicts: Predictor, best: FloatArray, effects: Sequence[Effect], run: Map = map
) -> tuple[Shown, ...]:
    """Return what a record can show of each of some effects.

    Args:
        predicts: Of the model without them.
        best: The point of the unit cube where its predictions are best, (k,).
        effects: That could be added.
        run: Works on several at a time.
    """
    shares = [(share, predicts, best) for share in shares_of(effects)]
    found = {each.effect: each for own in run(_shown_by, shares) for each in own}
    return tuple(found[each.name] for each in effects if each.name in found)


def _shown_by(share: tuple[Sequence[Effect], Predictor, FloatArray]) -> list[Shown]:
    effects, predicts, best = share
    did = excitation_of(predicts.objective.record.op)
    smaller = _Smaller(predicts, best, movable(predicts, best))
    found = []
    for effect in effects:
        try:
            information, new = smaller.shows(effect)
        except EffectError:
            continue  # the trial itself reports it
        why_not = not_excited(effect.family, did)
        if why_not is None and new <= IMITATED:
            why_not = "gain, dead time, lags and level of the model do all that it would do"
        elif why_not is None and information < VERY_STRONG:
            why_not = f"it would move PV by {_part(information, predicts)} of the noise at most"
        found.append(Shown(effect.name, information, why_not))
    return found


@dataclass(frozen=True, slots=True)
class _Smaller:
    """A model without the effects that are looked at."""

    predicts: Predictor
    best: FloatArray
    known: FloatArray
    """Orthonormal columns of what it can do by a small change of all its numbers, (m, q)."""

    def shows(self, effect: Effect) -> tuple[float, float]:
        """Return the information of an effect, and the largest part of a change that is new.

        What a small change of the model does as well a large one may not: so before an effect is denied, the
        model is fitted to its own free run with the largest changes.
        """
        added = self.changes(effect)
        moved = [self.predicts.whitened(each) for each in added]
        whole = np.array([float(np.sum(each**2)) for each in moved])
        new = np.array([float(np.sum(beyond(each, self.known) ** 2)) for each in moved])
        variance = self.least_variance()
        if effect.stage == "disturbance":  # its height may be any
            part = float(np.max(new / np.maximum(whole, TINY)))
            return math.inf, part
        for at in np.argsort(-whole)[:REFITTED]:
            if new.max() >= VERY_STRONG * variance and np.any(new > IMITATED * whole):
                break
            new[at] = max(new[at], self.left_by_refit(added[at]))
        return float(new.max()) / variance, float(np.max(new / np.maximum(whole, TINY)))

    def changes(self, effect: Effect) -> list[FloatArray]:
        """Return what an effect adds to PV at many of its values, PV units, each (n, k)."""
        found = changes(self.predicts, self.best, effect)
        if effect.stage == "disturbance":
            return [*found]
        gain = self.largest_gain(self.predicts.objective.columns(self.best)[:, 0])
        return [gain * each for each in found]

    def least_variance(self) -> float:
        """Return the variance of the innovations that a complete model may have, PV units squared.

        Where an effect is missing those of the model are too large: the white part of PV is no larger.
        """
        known = self.predicts.objective.record.weight > 0
        white = noise_level(self.predicts.objective.record.pv[known]) ** 2
        return max(min(self.predicts.variance(self.best), white), TINY)

    def largest_gain(self, response: FloatArray) -> float:
        """Return the largest gain that the loop may have: with it the response (n,) is all of PV but noise.

        Where an effect is missing that of the model may be anything: a stop that OP winds up behind hides it.
        A response that is PV itself has none but one.
        """
        target = self.predicts.objective.target
        if target.fixed_gain:
            return 1.0
        moves = response * target.weight
        moves = moves - target.basis @ (target.basis.T @ moves)
        noise = target.count * self.least_variance()
        most = math.sqrt(max(float(target.pv @ target.pv) - noise, 0.0) / max(float(moves @ moves), TINY))
        return max(abs(float(self.predicts.fit(self.best).coefficients[0])), most)

    def left_by_refit(self, change: FloatArray) -> float:
        """Return the squares that the model leaves, fitted to its free run with a change, PV units."""
        predicts = self.predicts
        record = predicts.objective.record
        columns = predicts.objective.columns(self.best)
        own = predicts.fit(self.best).coefficients.copy()
        own[0] = self.largest_gain(columns[:, 0])
        pv = columns @ own + change[:, 0]
        posed = replace(predicts.objective, record=replace(record, pv=pv))
        behind = whitened(posed, predicts.noise)
        behind = replace(behind, target=replace(behind.target, gain_sign=0))
        points = np.vstack((self.best, hypercube(PLACES, len(self.best))))
        return behind.error(searched(behind, points, ROUNDS))


def _part(information: float, predicts: Predictor) -> str:
    """Return the root of the mean square of a change over that of the innovations, in words."""
    return f"{100 * math.sqrt(max(information, 0.0) / len(predicts.pv)):.2g} %"

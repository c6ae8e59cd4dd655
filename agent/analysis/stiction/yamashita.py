"""How often OP moves and the stem does not, counted with symbols.

Source: Y. Yamashita, "An automatic method for detection of valve stiction in process control loops", Control
Engineering Practice 14 (2006) 503; definitions from reference ``methods.md`` 3.5.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby, pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from agent.analysis.results import MethodKind, MethodResult, Oscillation
from agent.analysis.stiction.shapes.stem import Stem, stem_of

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray, LoopWindow

CHANCE = 0.25
"""Both indices must be above it: two of the eight pairs of symbols other than SS are IS and DS."""
AFTER_NO_STICTION: dict[str, frozenset[str]] = {
    "IS": frozenset({"DD", "DI", "SD", "ID", "DS"}),
    "DS": frozenset({"DI", "SI", "ID", "II", "IS"}),
}
"""Pairs that a sticking valve does not show next after OP moved and the stem did not."""


@dataclass(frozen=True, slots=True)
class QualitativeShape:
    """What the detector measured."""

    op: FloatArray
    """OP at about 20 samples a period, OP units, (m,)."""
    position: FloatArray
    """The stem, or PV, at the same times, its own unit, (m,)."""
    symbols: NDArray[np.str_]
    """What OP and then the stem does in each step, I(ncreasing), S(teady) or D(ecreasing), (m - 1,)."""
    rho_1: float
    """Part of the steps, SS left out, in which OP moves and the stem does not."""
    rho_3: float
    """The same without those that go on as no sticking valve does."""


@dataclass(frozen=True, slots=True)
class Yamashita:
    """For loops with a measured valve position, and fast ones without."""

    name: str = "yamashita"
    kind: MethodKind = "travel"

    def detect(self, window: LoopWindow, oscillation: Oscillation) -> MethodResult:
        """Judge by the two limits of Yamashita (2006); the index is rho 3, the smaller of the two parts."""
        stem = stem_of(window, oscillation)
        if isinstance(stem, str):
            return MethodResult("not_applicable", None, stem)
        seen = qualitative_shape(stem)
        if seen is None:
            return MethodResult("undecided", None, "neither OP nor the stem moves by more than its noise")
        found = f"only OP moves in {seen.rho_1:.0%} of the steps, with a stiction pattern in {seen.rho_3:.0%}"
        return MethodResult("stiction" if seen.rho_3 > CHANCE else "no_stiction", seen.rho_3, found, seen)


def qualitative_shape(stem: Stem) -> QualitativeShape | None:
    """Count what OP and stem do together; None where every step is SS."""
    op, position = stem.op[:: stem.width], stem.position[:: stem.width]
    symbols = np.char.add(_symbols(op), _symbols(position))
    runs = [(str(pair), len(list(run))) for pair, run in groupby(symbols) if pair != "SS"]
    moving = sum(count for _, count in runs)
    if moving == 0:
        return None
    stuck = sum(count for pair, count in runs if pair in AFTER_NO_STICTION)
    otherwise = sum(
        count for (pair, count), (after, _) in pairwise(runs) if after in AFTER_NO_STICTION.get(pair, ())
    )
    return QualitativeShape(op, position, symbols, stuck / moving, (stuck - otherwise) / moving)


def _symbols(values: FloatArray) -> NDArray[np.str_]:
    """Return for each step of ``values`` (m,) I or D if it is a deviation from their mean or more, else S."""
    steps = np.diff(values)
    far = steps - np.mean(steps)
    deviation = np.std(steps)
    return np.select([far > deviation, far < -deviation], ["I", "D"], "S")

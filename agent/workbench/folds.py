"""Held-out error: blocks of the record that a fit did not use, predicted in free run from OP.

The model runs through the whole record from OP alone, so the samples beside a held-out block reveal nothing
of it except the noise that both share at its edges. A guard for that is not worth its samples: with none the
error of a true model is that of the noise, wrong effects lower it no more often, and a fold keeps what its
neighbours say of a bump (decision 140; ``missing_effect.md`` section 4, step 5 requires one).
Level and slow drift belong to no effect and are removed with the whole record: extrapolated into a block they
would hide every difference. Only the opening of the record shows where the valve stood before it; every fit
uses the opening and no score counts it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import uniform_filter1d

from agent.workbench.fit import Fit, refit
from agent.workbench.record import FEW_CYCLES
from agent.workbench.shown.leverage import leverage_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from agent.analysis.record.recording import FloatArray
    from agent.identify.noise.autoregression import Innovations
    from agent.workbench.record import Record

FOLDS = 5
FEWEST_BLOCKS = 10
SPARE = 2
"""Blocks in addition to the least number, for the start that does not count and a gap."""
BLOCKS = 25
"""Wanted: with fewer the intervals are wide."""
LEAST_BLOCK = 100
"""Samples, where the record is long enough for ``BLOCKS`` of them."""
LEAST_SHARE = 0.25
"""Of what a fold would hold of the record's information if all held as much, from which on blocks are of
equal length; else they are shorter where OP tests the loop."""
SMOOTH = 50
"""Parts of the record over which the information is averaged: one sample is no block."""


@dataclass(frozen=True, slots=True)
class Folds:
    """Which samples are held out together."""

    block: NDArray[np.int64]
    """Number of each sample's block, -1 where it belongs to none, (n,)."""
    fold: NDArray[np.int64]
    """Of each block, (b,)."""
    opening: int
    """First samples, in no block, that all fits use."""

    @property
    def count(self) -> int:
        """How many blocks there are."""
        return len(self.fold)

    def held_out(self, fold: int) -> NDArray[np.bool_]:
        """Return which samples the fit of a fold does not use but must predict, (n,)."""
        return np.asarray((self.block >= 0) & (self.fold[self.block] == fold), dtype=np.bool_)

    def seen(self, fold: int, weight: FloatArray) -> FloatArray:
        """Return ``weight`` (n,), zero where a fold's fit predicts."""
        return weight * ~self.held_out(fold)


@dataclass(frozen=True, slots=True)
class HeldOut:
    """Held-out predictions and errors of a model."""

    losses: FloatArray
    """Mean squared error of each block, PV units squared, (b,)."""
    values: FloatArray
    """Of the parameters in each fold, own units, (K, k)."""
    pv: FloatArray
    """Each sample as predicted by the fold that did not use it, NaN outside the blocks, PV units, (n,)."""

    @property
    def rmse(self) -> float:
        """Over all blocks, PV units."""
        return float(np.sqrt(self.losses.mean()))


def folds_of(record: Record, base: Fit) -> Folds | str:
    """Return the folds of a record, or as a text why there are too few blocks.

    Blocks of one to three periods, at least 100 samples, shorter where the record is; for a loop that does
    not oscillate they need not hold a period. Blocks with less than half of their samples are left out. Where
    OP tests the loop in a few stretches only, a step or two, blocks are shorter there, so that each fold
    holds some of the information.

    Args:
        record: OP and PV.
        base: The base alone, fitted: where its response moves OP tests the loop.
    """
    n, period = len(record), record.period
    length = min(max(2 * period, LEAST_BLOCK), n / BLOCKS)
    least = period if n > FEW_CYCLES * period else 0.0
    length = int(min(max(length, least), n / (FEWEST_BLOCKS + SPARE)))
    equal = np.minimum(np.arange(n) // length, n // length - 1)  # the last one takes the rest
    share = leverage_of(base, record)
    found = _folds(equal, record)
    if isinstance(found, str):
        return found
    held = [float(share[found.held_out(fold)].sum()) for fold in range(FOLDS)]
    if min(held) >= LEAST_SHARE * sum(held) / FOLDS:
        return found
    by_excitation = _folds(_as_much_in_each(share, n // length), record)
    return found if isinstance(by_excitation, str) else by_excitation


def _as_much_in_each(share: FloatArray, blocks: int) -> NDArray[np.int64]:
    """Return the block of each sample, (n,), each with as much of time and information, half and half.

    ``share``: of the information, (n,), sum 1.
    """
    n = len(share)
    smooth = uniform_filter1d(share, max(1, n // SMOOTH), mode="nearest")
    held = np.cumsum(0.5 / n + 0.5 * smooth / smooth.sum())
    return np.minimum((held * blocks).astype(np.int64), blocks - 1)


def _folds(block: NDArray[np.int64], record: Record) -> Folds | str:
    """Return folds of blocks (n,), those with less than half of their samples left out."""
    lengths = np.bincount(block)
    enough = np.bincount(block, weights=record.weight) >= 0.5 * lengths
    enough[0] = False
    if enough.sum() < FEWEST_BLOCKS:
        return f"only {enough.sum()} stretches of the record have enough samples, {FEWEST_BLOCKS} are needed"
    number = np.where(enough, np.cumsum(enough) - 1, -1)
    fold = np.arange(enough.sum()) % FOLDS
    return Folds(number[block], fold, opening=int(lengths[0]))


def held_out(fitted: Fit, record: Record, folds: Folds, noise: Innovations | None = None) -> HeldOut:
    """Refit a model without each fold in turn, from the values of the whole record, and predict that fold.

    Args:
        fitted: To the whole record.
        record: OP and PV.
        folds: Of the record.
        noise: Noise model of its residual; the refits then minimise the prediction error, as ``fitted`` does.
            None: they minimise the error of the free run. The folds are predicted in free run either way.
    """
    pv = np.full(len(record), np.nan)
    values = []
    for fold in range(FOLDS):
        one = refit(fitted, record, folds.seen(fold, record.weight), noise)
        hidden = folds.held_out(fold)
        pv[hidden] = one.pv[hidden]
        values.append(one.values)
    return HeldOut(block_losses(record, folds, pv), np.array(values), pv)


def block_losses(record: Record, folds: Folds, pv: FloatArray) -> FloatArray:
    """Return the mean squared error of each block, PV units squared, (b,), of a prediction (n,)."""
    counts = (folds.block >= 0) & (record.weight > 0)
    squares = (record.pv[counts] - pv[counts]) ** 2
    of = folds.block[counts]
    return np.bincount(of, squares, folds.count) / np.bincount(of, minlength=folds.count)

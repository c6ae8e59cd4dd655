"""Where a model fails: its residual against physical axes, each with a band and the share it explains.

There are two tests. The band shows where the bin means would lie if residual and axis were unrelated: the
residual is shifted circularly against the axis by every lag of at least a block. In closed loop the two are
always related, because OP responds to the residual; so p is computed from the innovations
(``innovations.py``) against the axis one sample before, which those of a complete model do not follow. A
second test takes the response of the process into account (``state_dependence.py``).
Source: reference ``missing_effect.md`` section 4, step 2; p of the largest panel: Westfall and Young (1993).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from agent.identify.noise.autoregression import innovations
from agent.workbench.residual.resampling import resampled
from agent.workbench.residual.state_dependence import DOUBTED, LEVEL, Dependence

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    FloatArray = NDArray[np.float64]

BINS = 10
BAND = (2.5, 97.5)
"""Percentiles of the shifted bin means between which the band lies."""
DRAWS = 999
TINY = np.finfo(float).tiny


@dataclass(frozen=True, slots=True)
class Failure:
    """One panel: the residual over an axis in k bins."""

    axis: str
    share: float
    """Part of the residual's variance that the bin means explain, 0 to 1."""
    p: float
    """Probability that a complete model shows as much on any of the axes; 1 with too few samples."""
    bin_edges: FloatArray
    """Unit of the axis, (k + 1,)."""
    bin_means: FloatArray
    """Of the residual about its mean, its unit, (k,)."""
    band_low: FloatArray
    """Each bin mean lies below with 2.5 % if residual and axis are unrelated, (k,)."""
    band_high: FloatArray
    """And above with 2.5 %, (k,)."""


@dataclass(frozen=True, slots=True)
class Bins:
    """An axis in k bins with about the same number of samples."""

    edges: FloatArray
    """(k + 1,)."""
    members: NDArray[np.bool_]
    """Which samples are in each, (n, k); a sample without the axis is in none."""


def where_it_fails(
    residual: FloatArray, axes: Mapping[str, FloatArray], block: int, rng: np.random.Generator
) -> tuple[Failure, ...]:
    """Test a residual against each axis; panels beyond chance come first, then by share.

    Args:
        residual: PV less model, PV units, (n,); NaN where PV counts for nothing.
        axes: Each (n,); one with a single value is left out.
        block: Samples of a held-out block, < n / 2: samples that are further apart count as unrelated.
        rng: Of the draws behind p.
    """
    binned = {name: bins_of(axis, residual) for name, axis in axes.items()}
    binned = {name: bins for name, bins in binned.items() if bins.members.shape[1] > 1}
    centred = residual - np.nanmean(residual)
    levels = _significance(residual, [bins.members for bins in binned.values()], block, rng)
    failures = [
        panel_of(name, centred, bins, block, p)
        for (name, bins), p in zip(binned.items(), levels.tolist(), strict=True)
    ]
    return _first_beyond_chance(failures)


def beside(
    failures: Sequence[Failure], dependence: Mapping[str, Dependence], happened: float
) -> tuple[Failure, ...]:
    """Return the panels with the smallest p of the tests: of the bin means, and of ``state_dependence``.

    The second is multiplied by ``DOUBTED``, as is ``happened``, the p of no event at any instant.
    """
    other = {axis: DOUBTED * each.p for axis, each in dependence.items()}
    other["time"] = min(other.get("time", 1.0), DOUBTED * happened)
    return _first_beyond_chance(
        [replace(each, p=min(each.p, other.get(each.axis, 1.0))) for each in failures]
    )


def _first_beyond_chance(failures: Iterable[Failure]) -> tuple[Failure, ...]:
    return tuple(sorted(failures, key=lambda each: (each.p >= LEVEL, -each.share)))


def bins_of(axis: FloatArray, residual: FloatArray) -> Bins:
    """Return the axis in at most ``BINS`` bins between quantiles of the samples that the residual has."""
    known = axis[np.isfinite(axis) & np.isfinite(residual)]
    values = np.unique(known)
    if values.size <= BINS:
        inner = (values[1:] + values[:-1]) / 2
    else:
        inner = np.unique(np.quantile(known, np.arange(1, BINS) / BINS))
        inner = inner[(inner > values[0]) & (inner <= values[-1])]
    number = np.where(np.isfinite(axis), np.searchsorted(inner, axis, side="right"), -1)
    ends = (values[:1], inner, values[-1:])
    return Bins(np.concatenate(ends), number[:, None] == np.arange(len(inner) + 1))


def panel_of(name: str, centred: FloatArray, bins: Bins, block: int, p: float) -> Failure:
    """Return one panel of a residual (n,) of mean zero; its p is given."""
    shifted = _shifted_means(centred, bins.members)
    means = shifted[:, 0]
    low, high = np.percentile(shifted[:, block : len(centred) - block + 1], BAND, axis=1)
    counts = np.count_nonzero(bins.members & np.isfinite(centred)[:, None], axis=0)
    whole = np.nansum(centred[bins.members.any(axis=1)] ** 2)
    share = float(counts @ means**2 / max(whole, TINY))
    return Failure(name, share, p, bins.edges, means, low, high)


def _shifted_means(centred: FloatArray, members: NDArray[np.bool_]) -> FloatArray:
    """Return the bin means, (k, n), of the residual delayed circularly by 0 to n - 1 samples."""
    known = np.isfinite(centred)
    bins = fft.rfft(members.T.astype(np.float64)).conj()
    sums, counts = (
        fft.irfft((fft.rfft(each) * bins).conj(), len(centred))
        for each in (np.where(known, centred, 0.0), known.astype(np.float64))
    )
    return np.asarray(sums / np.maximum(np.rint(counts), 1.0), dtype=np.float64)


def _significance(
    residual: FloatArray, members: list[NDArray[np.bool_]], block: int, rng: np.random.Generator
) -> FloatArray:
    """Return p of each panel, adjusted for all of them, (m,).

    The observed innovations are replaced by blocks of them from random places.
    """
    found = innovations(residual)
    if found is None or not members:
        return np.ones(len(members))
    new = found.values[1:]
    known = np.isfinite(new)
    new = new[known] - new[known].mean()
    columns = np.hstack([each[:-1][known] for each in members]).astype(np.float64)
    counts = np.maximum(columns.sum(axis=0), 1.0)
    first = np.cumsum([0] + [each.shape[1] for each in members[:-1]])

    def explained(values: FloatArray) -> FloatArray:
        return np.add.reduceat((values @ columns) ** 2 / counts, first)

    draws = np.empty((DRAWS, len(members)))
    for draw in draws:
        draw[:] = explained(resampled(new, block, rng))
    middle, spread = draws.mean(axis=0), np.maximum(draws.std(axis=0), TINY)
    seen = (explained(new) - middle) / spread
    largest = ((draws - middle) / spread).max(axis=1)
    return np.asarray((1 + (largest[:, None] >= seen).sum(axis=0)) / (1 + DRAWS), dtype=np.float64)

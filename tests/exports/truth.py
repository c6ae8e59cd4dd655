"""The plant behind the corpus of exports: what every file of it should be read as."""

from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np

START = datetime(2026, 3, 1, 8, 0, 0, tzinfo=UTC).timestamp()
TS = 5.0
N = 240
LOST = {17, 18, 90}
"""Samples without a value of PV, in every file that has gaps."""


@dataclass(frozen=True)
class Loop:
    """One loop: columns of shape (N,), rounded as an export rounds them."""

    name: str
    op: np.ndarray
    pv: np.ndarray
    sp: np.ndarray

    @property
    def pv_with_gaps(self):
        return np.where(np.isin(np.arange(N), list(LOST)), np.nan, self.pv)


def _loop(name, seed, level, decimals):
    rng = np.random.default_rng(seed)
    t = TS * np.arange(N)
    op = level + 8 * np.abs((t / 130 + seed) % 2 - 1) + 0.05 * rng.standard_normal(N)
    pv = 3 * level + 4 * np.sign(np.sin(2 * np.pi * t / 260 + seed)) + 0.1 * rng.standard_normal(N)
    return Loop(name, np.round(op, decimals), np.round(pv, decimals), np.full(N, round(3 * level, 1)))


LOOPS = tuple(
    _loop(name, seed, level, decimals)
    for name, seed, level, decimals in (
        ("FIC101", 1, 41.0, 2),
        ("PIC202", 2, 13.5, 2),
        ("TIC303", 3, 450.0, 2),
    )
)
TIME = START + TS * np.arange(N)

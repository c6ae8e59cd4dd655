"""Shares and quantiles as the tables print them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np


def quantile(values: Sequence[float], q: float) -> float:
    """Return the quantile as one of the values, since some may be infinite; NaN where there are none."""
    return float(np.quantile(values, q, method="higher")) if values else np.nan


def number(value: float, digits: int = 2) -> str:
    """Return a number as a cell of a table; empty where there is none."""
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def two_quantiles(values: Sequence[float]) -> str:
    """Return median and 90th percentile."""
    return f"{quantile(values, 0.5):.2f} / {quantile(values, 0.9):.1f}" if values else ""


def percent(hits: Iterable[bool]) -> str:
    """Return the share that is true; empty where there is nothing."""
    counted = list(hits)
    return f"{100 * sum(counted) / len(counted):.0f}" if counted else ""

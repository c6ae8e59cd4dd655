"""Numbers as text: decimal point or comma, thousands separators, percent signs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from connectors.exports.tables.sheet import FloatArray
from connectors.historian import is_gap

SPACES = str.maketrans("", "", " \u00a0\u202f\u2009'\u2019_")
NUMBER = re.compile(r"[+-]?(?:\d[\d.,'\u2019\u00a0\u202f\u2009 ]*|[.,]\d+)(?:[eE][+-]?\d+)?\s?%?")
WITH_UNIT = re.compile(r"[+-]?[\d.,]+(?:[eE][+-]?\d+)?\s*([^\W\d_]\S*)")
"""``127.01 t/h``, as dashboards export it."""
POINT_ONLY = re.compile(r"[+-]?\d*\.\d*(?:[eE][+-]?\d+)?%?")
COMMA_ONCE = re.compile(r"[+-]?(\d*),(\d+)(?:[eE][+-]?\d+)?%?")
GROUPED_BY_COMMA = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?%?")
GROUPED_BY_POINT = re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+(?:,\d*)?%?")
Mark = Literal[".", ","]


class UnclearNumberError(ValueError):
    """Commas that may be decimal marks or may separate thousands."""


@dataclass(frozen=True, slots=True)
class NumberStyle:
    """How numbers are written in one file."""

    decimal: Mark = "."

    def number(self, cell: str) -> float | None:
        """Return the number of a cell, NaN where it is a gap, None where it is neither."""
        text = cell.strip()
        if self.decimal == "." or not GROUPED_BY_POINT.fullmatch(text):
            try:
                return float(text)
            except ValueError:
                if is_gap(cell):
                    return math.nan
        return self._marked(text)

    def _marked(self, text: str) -> float | None:
        """Return a number with thousands separators, a decimal comma or a percent sign; else None."""
        if not NUMBER.fullmatch(text):
            return None
        bare = text.translate(SPACES)
        forms = (GROUPED_BY_POINT, COMMA_ONCE) if self.decimal == "," else (GROUPED_BY_COMMA,)
        if "," in bare and not any(form.fullmatch(bare) for form in forms):
            return None
        group, mark = (".", ",") if self.decimal == "," else (",", ".")
        try:
            return float(bare.removesuffix("%").replace(group, "").replace(mark, "."))
        except ValueError:
            return None

    def numbers(self, cells: Sequence[str]) -> tuple[FloatArray, list[int]]:
        """Return the numbers of a column, shape (n,), and the rows whose cells are neither number nor gap."""
        if self.decimal == ".":
            try:
                return np.fromiter(map(float, cells), np.float64, len(cells)), []
            except ValueError:
                pass
        bad: list[int] = []
        found = np.fromiter(self._numbers(cells, bad), np.float64, len(cells))
        unit = _unit_behind([cells[row] for row in bad]) if 2 * len(bad) > len(cells) else None
        if unit is not None:
            return self.numbers([cell.strip().removesuffix(unit) for cell in cells])
        return found, bad

    def _numbers(self, cells: Sequence[str], bad: list[int]) -> Iterator[float]:
        """Yield the number of each cell; the rows of those that have none are added to ``bad``."""
        for row, cell in enumerate(cells):
            value = self.number(cell)
            if value is None:
                bad.append(row)
            yield math.nan if value is None else value


def _unit_behind(cells: Sequence[str]) -> str | None:
    """Return the unit that stands behind the number in each cell; None where there is none, or several."""
    found = {each[1] if (each := WITH_UNIT.fullmatch(cell.strip())) else "" for cell in cells}
    return found.pop() or None if len(found) == 1 else None


def is_number(cell: str) -> bool:
    """Whether a cell is a number in any style."""
    return NUMBER.fullmatch(cell.strip()) is not None


def style_of(cells: Iterable[str]) -> NumberStyle:
    """Return the style in which all numbers of a file are written.

    Raises:
        UnclearNumberError: Every comma may be decimal and may separate thousands.
    """
    decimal_point = decimal_comma = open_commas = 0
    example = ""
    for cell in cells:
        if decimal_point and "," not in cell:
            continue  # it could be a point only, and one is known
        text = cell.strip().translate(SPACES)
        comma = COMMA_ONCE.fullmatch(text)
        if comma is not None:
            example = cell
            whole, fraction = comma.groups()
            if len(fraction) == 3 and 1 <= len(whole) <= 3 and whole.lstrip("0") == whole:
                open_commas += 1
            else:
                decimal_comma += 1
        elif GROUPED_BY_POINT.fullmatch(text) and "," in text:
            decimal_comma += 1
        elif ("," in text and GROUPED_BY_COMMA.fullmatch(text)) or (
            POINT_ONLY.fullmatch(text) and "." in text
        ):
            decimal_point += 1
    if decimal_comma and not decimal_point:
        return NumberStyle(",")
    if (open_commas and not decimal_point) or (decimal_comma and decimal_point):
        raise UnclearNumberError(
            f"{example!r} may be a decimal comma or thousands: give --decimal , or --decimal ."
        )
    return NumberStyle(".")

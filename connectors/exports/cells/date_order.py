"""Which of the numbers of a date is the day, the month and the year, where a file leaves it open."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import date
from itertools import pairwise
from typing import Literal

Order = Literal["dmy", "mdy", "ymd"]
"""Order of day, month and year where the year is no number of four digits in front."""
Numbers = tuple[int, int, int]
"""A date as written: three numbers."""
OLDEST = 2010
"""Year from which the first of three short numbers may be the year: 26-03-01, but not 01-03-26."""
NEXT = 2
"""Days that one date may follow another in a record."""
FAR = 20
"""Days between them that show a wrong order: months taken for days."""
HALVES = ("AM", "PM")


def day_of(numbers: Numbers, order: Order) -> date | None:
    """Return the date of three numbers in one order, or None where there is none."""
    first, second, third = numbers
    year, month, day = {
        "dmy": (third, second, first),
        "mdy": (third, first, second),
        "ymd": (first, second, third),
    }[order]
    try:
        return date(year + 2000 if year < 100 else year, month, day)
    except ValueError:
        return None


def orders_of(dates: Iterable[Numbers], *, dotted: bool) -> tuple[Order, ...]:
    """Return the orders in which a column of dates may be written.

    Args:
        dates: As written, in the order of the file; repeated ones may be left out.
        dotted: Whether points stand between the numbers: then the month is never first.
    """
    distinct = list(dict.fromkeys(dates))
    admitted: list[Order] = ["dmy", "ymd"] if dotted else ["dmy", "mdy", "ymd"]
    valid: dict[Order, list[date]] = {}
    for order in admitted:
        days = [day for each in distinct if (day := day_of(each, order)) is not None]
        if len(days) == len(distinct) and not (order == "ymd" and _no_first_year(distinct)):
            valid[order] = days
    steady = [order for order, days in valid.items() if _longest_step(days) <= NEXT]
    others = [order for order in valid if order not in steady]
    if len(steady) == 1 and len(distinct) > 1 and all(_longest_step(valid[each]) >= FAR for each in others):
        return (steady[0],)
    return tuple(valid)


def month_first(cells: Sequence[str]) -> bool:
    """Whether times have AM and PM, as in the United States; with points (a.m.) they are from elsewhere."""
    return any(cell.rstrip().upper().endswith(HALVES) for cell in cells)


def _no_first_year(dates: Sequence[Numbers]) -> bool:
    return any(third > 31 or first > 99 or first + 2000 < OLDEST for first, _, third in dates)


def _longest_step(days: Sequence[date]) -> int:
    return max((abs((b - a).days) for a, b in pairwise(days)), default=0)

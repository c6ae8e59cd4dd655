"""The time column of a table as seconds UTC, whatever it looks like."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

import numpy as np
from numpy.typing import NDArray

from connectors.exports.cells.calendar_times import Moment, moment_of
from connectors.exports.cells.clock_numbers import CLOCKS, FORMATS, UnclearTimeError, clock_of
from connectors.exports.cells.date_order import Order, month_first, orders_of
from connectors.exports.cells.day_clock import days_and_clock, over_midnight
from connectors.exports.cells.moments import Moments
from connectors.exports.cells.number_style import NumberStyle
from connectors.exports.cells.summer_time import skipped_hour
from connectors.exports.cells.tag_roles import unit_of
from connectors.exports.fault import RecordingError, shown
from connectors.exports.series import falls
from connectors.historian import is_gap

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import Column, FloatArray, Sheet

MOST_LOST = 0.1
"""Share of rows without a readable time above which the column is none of times."""
HOUR = 3600.0


@dataclass(frozen=True, slots=True)
class TimeOptions:
    """What a user states about times."""

    zone: str | None = None
    """IANA name such as Europe/Berlin, of times that have none; None: UTC."""
    form: str | None = None
    """One of ``clock_numbers.FORMATS``, or a pattern of strptime; None: recognised."""
    order: Order | None = None
    """Order of day and month; None: recognised."""


@dataclass(frozen=True, slots=True)
class Times:
    """Times of the rows of a table."""

    read: FloatArray
    """s as the file has them, in UTC or in local time, shape (n,); NaN where a row has no readable time."""
    form: str
    """What was recognised: seconds, epoch_ms, excel, calendar ..."""
    zone: str
    """In which the file's times were read; empty for a count from an unknown start."""
    place: ZoneInfo | None = None
    """Zone in which ``read`` is local time; None: UTC, or a count from an unknown start."""
    stated: bool = False
    """Whether file or user states the zone; else times count as UTC."""
    notes: tuple[str, ...] = ()
    """What was taken for granted, with the option that says otherwise, and which rows have no time."""

    def utc(self, rows: NDArray[np.intp]) -> FloatArray:
        """Return the times of some rows of one series, s UTC, in the order of the rows."""
        return self.read[rows] if self.place is None else _in_zone(self.read[rows], self.place)


def times_of(sheet: Sheet, column: Column, options: TimeOptions, style: NumberStyle) -> Times:
    """Return the times of a column.

    Raises:
        RecordingError: They cannot be read, or in two ways; one line that names the option that settles it.
    """
    zone = _zone(sheet, options.zone)
    if options.form is not None and options.form not in CLOCKS and "%" not in options.form:
        raise RecordingError(
            f"{sheet.path}: {options.form!r} is no form of times, expected {', '.join(FORMATS)} "
            "or a pattern such as %d/%m/%Y %H:%M:%S"
        )
    if isinstance(column.cells, np.ndarray):
        if column.moments:
            place = zone if column.local else None
            stated = not column.local or options.zone is not None
            return _complete(
                sheet, column, Times(column.cells, "calendar", options.zone or "UTC", place, stated)
            )
        return _counted(sheet, column, column.cells, options, zone)
    cells = column.cells
    if options.form is not None and "%" in options.form:
        return _by_pattern(sheet, column, cells, options, zone)
    sample = next((cell for cell in cells if cell), "")
    if options.form not in CLOCKS and 2 * sum(":" in cell for cell in cells) > len(cells):
        return _calendar(sheet, column, cells, options, zone)  # no number has a colon
    numbers, bad = style.numbers(cells)
    if options.form in CLOCKS or (
        len(bad) * 2 <= len(cells) and np.isfinite(numbers).any() and moment_of_digits(sample) is None
    ):
        return _counted(sheet, column, numbers, options, zone, bad)
    return _calendar(sheet, column, cells, options, zone)


def moment_of_digits(cell: str) -> Moment | None:
    """Return the moment of fourteen digits such as 20260301080000, or None."""
    return moment_of(cell) if len(cell.split(".", maxsplit=1)[0]) == 14 and cell[:2] in {"19", "20"} else None


def _zone(sheet: Sheet, name: str | None) -> ZoneInfo | None:
    if name is None or name.upper() == "UTC":
        return None
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError) as error:
        raise RecordingError(
            f"{sheet.path}: no time zone {name!r}, expected a name such as Europe/Berlin"
        ) from error


def _counted(
    sheet: Sheet,
    column: Column,
    values: FloatArray,
    options: TimeOptions,
    zone: ZoneInfo | None,
    bad: Sequence[int] = (),
) -> Times:
    finite = values[np.isfinite(values)]
    if not finite.size:
        raise _missing_time(sheet, column, 0)
    _refuse_words(sheet, column, bad)
    try:
        clock = (
            CLOCKS[options.form]
            if options.form in CLOCKS
            else clock_of(finite, unit_of(column.name) or column.unit)
        )
    except UnclearTimeError as error:
        raise RecordingError(f"{sheet.where(0)}: {column.name}: {error}") from error
    local = clock.name in {"excel", "matlab"}  # spreadsheets have local time; epochs are UTC by definition
    place = zone if local else None
    name = (options.zone or "UTC") if local else "UTC" * clock.absolute
    stated = not local or options.zone is not None
    return _complete(sheet, column, Times(clock.seconds(values), clock.name, name, place, stated))


def _refuse_words(sheet: Sheet, column: Column, bad: Sequence[int]) -> None:
    if len(bad) > MOST_LOST * len(sheet.lines) and isinstance(column.cells, Sequence):
        cell = column.cells[bad[0]]
        raise RecordingError(
            f"{sheet.where(bad[0])}: {column.name} is {shown(cell)}, expected seconds as in the first sample"
        )


def _by_pattern(
    sheet: Sheet, column: Column, cells: Sequence[str], options: TimeOptions, zone: ZoneInfo | None
) -> Times:
    pattern = options.form or ""

    def moment(cell: str) -> Moment | None:
        try:
            found = datetime.strptime(cell, pattern)  # noqa: DTZ007 - the zone comes later
        except ValueError:
            return None
        offset = found.utcoffset()
        return Moment(found.replace(tzinfo=None), None if offset is None else offset.total_seconds() / HOUR)

    return _of_moments(sheet, column, cells, Moments.of(cells, moment), options, zone)


def _calendar(
    sheet: Sheet, column: Column, cells: Sequence[str], options: TimeOptions, zone: ZoneInfo | None
) -> Times:
    if sum(days_and_clock(cell) is not None for cell in cells) * 2 > len(cells):
        return _of_day(sheet, column, cells)
    moments = Moments.of(cells, lambda cell: moment_of(cell, options.order))
    notes: tuple[str, ...] = ()
    if moments.dates and options.order is None:
        example = shown(cells[moments.first])
        orders = orders_of(moments.dates, dotted=moments.dotted)
        if len(orders) > 1 and "ymd" not in orders and month_first(cells[:100]):
            taken = "the month is taken to be first; --date-order dmy if not"
            notes = (f"{column.name} is {example}: {taken}",)
            orders = ("mdy",)
        if len(orders) > 1:
            raise RecordingError(
                f"{sheet.where(moments.first)}: {column.name} is {example}: which number is day, month and "
                f"year? give --date-order {' or '.join(orders)}"
            )
        order = orders[0] if orders else None
        moments = Moments.of(cells, lambda cell: moment_of(cell, order))
    found = _of_moments(sheet, column, cells, moments, options, zone)
    return replace(found, notes=(*notes, *found.notes))


def _of_day(sheet: Sheet, column: Column, cells: Sequence[str]) -> Times:
    """Return times of day without a date, counted on over midnight."""
    days = map(days_and_clock, cells)
    read = np.fromiter((np.nan if each is None else each for each in days), np.float64, len(cells))
    lost = _lost(read)
    if len(lost) > MOST_LOST * len(cells):
        raise _no_time(sheet, column, cells, lost[0])
    return _complete(sheet, column, Times(over_midnight(read), "time of day", ""))


def _of_moments(
    sheet: Sheet,
    column: Column,
    cells: Sequence[str],
    moments: Moments,
    options: TimeOptions,
    zone: ZoneInfo | None,
) -> Times:
    read, aware = moments.utc, moments.aware
    lost = _lost(read)
    if len(lost) > MOST_LOST * len(cells):
        raise _no_time(sheet, column, cells, lost[0])
    name = "as written" if aware else options.zone or "UTC"
    stated = aware or options.zone is not None
    notes: tuple[str, ...] = ()
    after = None if stated else skipped_hour(read)
    if after is not None:
        hole = f"the hour before {after:%Y-%m-%d %H:%M} is absent, as where summer time begins"
        notes = (f"{column.name}: {hole}; if times are local, name the zone by --zone",)
    return _complete(sheet, column, Times(read, "calendar", name, None if aware else zone, stated, notes))


def _in_zone(local: FloatArray, zone: ZoneInfo | None) -> FloatArray:
    """Return UTC of local times, s; the hour that comes twice is taken in the order of the rows."""
    falling = falls(local)
    rows = local[::-1] if falling else local
    seconds = np.full(len(rows), np.nan)
    previous = -np.inf
    for k, value in enumerate(rows.tolist()):
        if value != value:  # noqa: PLR0124 - NaN
            continue
        naive = datetime.fromtimestamp(value, UTC).replace(tzinfo=zone)
        found = naive.timestamp()
        if found < previous:
            found = max(found, naive.replace(fold=1).timestamp())
        seconds[k] = previous = found
    return seconds[::-1] if falling else seconds


def _complete(sheet: Sheet, column: Column, times: Times) -> Times:
    lost = _lost(times.read)
    if len(lost) > MOST_LOST * len(times.read):
        raise _missing_time(sheet, column, lost[0])
    if not lost:
        return times
    first = sheet.text(column)[lost[0]]
    what = f"is {shown(first)}, no time that can be read" if first else "is missing"
    more = f" ({len(lost) - 1} more)" if len(lost) > 1 else ""
    line = f"{sheet.place} {sheet.lines[lost[0]]}: {column.name} {what}; the row is a gap{more}"
    return replace(times, notes=(*times.notes, line))


def _lost(read: FloatArray) -> list[int]:
    return [int(row) for row in np.flatnonzero(~np.isfinite(read))]


def _missing_time(sheet: Sheet, column: Column, row: int) -> RecordingError:
    return RecordingError(f"{sheet.where(row)}: {column.name} is missing, expected a time for each sample")


def _no_time(sheet: Sheet, column: Column, cells: Sequence[str], row: int) -> RecordingError:
    cell = cells[row]
    if is_gap(cell) or cell.casefold() == "nan":
        return _missing_time(sheet, column, row)
    return RecordingError(
        f"{sheet.where(row)}: {column.name} is {shown(cell)}, expected seconds or a date and time "
        "such as 2026-03-01 08:00:00; --time-format gives a pattern"
    )

"""Loops of a table whose columns are roles: plain, wide, or with a time column for each tag."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from connectors.exports.cells.number_style import NumberStyle, UnclearNumberError, style_of
from connectors.exports.cells.quality_words import usable
from connectors.exports.cells.times import Times, times_of
from connectors.exports.fault import RecordingError, shown
from connectors.exports.layout import (
    ColumnLayout,
    Placed,
    short_names,
    taken_for_output,
    usable_roles,
)
from connectors.exports.merged import merged
from connectors.exports.recorded import Export, ReadOptions, RecordedLoop
from connectors.exports.series import Series, rising, words_as_numbers
from connectors.exports.span import stated
from connectors.exports.stored_loops import StoredLoops

if TYPE_CHECKING:
    from collections.abc import Iterator

    from connectors.exports.tables.sheet import FloatArray, Sheet

MOST_WRONG = 0.5
"""Share of cells without a number above which a column is not what its name says."""
LOOKED_AT = 2000
"""Cells of a column from which the style of numbers is learnt."""


def loops_of_columns(sheet: Sheet, layout: ColumnLayout, options: ReadOptions) -> Export:
    """Return the loops of a table with a column a role.

    Raises:
        RecordingError: No loop has both PV and OP, times or numbers cannot be read.
    """
    names = short_names(list(layout.loops))
    style = number_style(sheet, layout, options)
    times: dict[int | None, Times | None] = {}
    loops = StoredLoops[RecordedLoop]()
    problems = [
        f"{sheet.place} {line}: has another number of cells, it is a gap" for line in sheet.bad_lines[:20]
    ]
    problems += layout.unused
    for loop, roles in layout.loops.items():
        found = usable_roles(roles)
        lacking = [role.upper() for role in ("pv", "op") if role not in found]
        if lacking:
            problems.append(f"{names[loop]}: has no {' and no '.join(lacking)}, it was left out")
            continue
        if "op" not in roles:
            problems.append(taken_for_output(names[loop], sheet.columns[roles["mv"].values].name))
        for placed in found.values():
            if placed.time not in times:
                times[placed.time] = _times(sheet, placed.time, layout, options, style)
        read = _loop(sheet, layout, names[loop], found, times, options, style, problems)
        loops.append(stated(read, options))
    if not loops:
        raise no_loops(sheet, problems)
    used = next((each for each in times.values() if each is not None), None)
    problems += dict.fromkeys(note for each in times.values() if each is not None for note in each.notes)
    zone, form = ("", "samples") if used is None else (used.zone, used.form)
    return Export(sheet.path, layout.format, sheet.kind, zone, form, style.decimal, loops, tuple(problems))


def _times(
    sheet: Sheet, place: int | None, layout: ColumnLayout, options: ReadOptions, style: NumberStyle
) -> Times | None:
    """Return the times of a column; where each tag has its own, the column may end before the table does."""
    if place is None:
        return None
    column = sheet.columns[place]
    cells = column.cells
    if layout.format != "interleaved" or isinstance(cells, np.ndarray):
        return times_of(sheet, column, options.times, style)
    end = max((k for k, cell in enumerate(cells) if cell), default=-1) + 1
    cut = replace(sheet, lines=sheet.lines[:end])
    found = times_of(cut, replace(column, held=cells[:end]), options.times, style)
    return replace(found, read=np.append(found.read, np.full(len(cells) - end, np.nan)))


def number_style(sheet: Sheet, layout: ColumnLayout, options: ReadOptions) -> NumberStyle:
    """Return the style of the numbers of a table; raises RecordingError where it is open."""
    if options.decimal is not None:
        return NumberStyle(options.decimal)
    places = {
        each.values for roles in layout.loops.values() for role, each in roles.items() if role != "mode"
    }
    if layout.value is not None:
        places.add(layout.value)
    try:
        return style_of(cell for place in places for cell in _sample(sheet, place))
    except UnclearNumberError as error:
        raise RecordingError(f"{sheet.path}: {error}") from error


def _sample(sheet: Sheet, place: int) -> Iterator[str]:
    cells = sheet.columns[place].cells
    if not isinstance(cells, np.ndarray):
        yield from cells[:LOOKED_AT]


def no_loops(sheet: Sheet, problems: list[str]) -> RecordingError:
    """Return the fault of a file without a loop that has OP and PV."""
    there = ", ".join(ascii(column.name)[1:-1] for column in sheet.columns if column.name)[:200]
    why = f" ({problems[-1]})" if problems else ""
    return RecordingError(
        f"{sheet.path}, {sheet.place} {sheet.header}: expected columns OP and PV of a loop, "
        f"such as FIC101.OP and FIC101.PV{why}; name them by --op and --pv, or their form by --pattern; "
        f"the file has: {there}"
    )


def _loop(
    sheet: Sheet,
    layout: ColumnLayout,
    name: str,
    roles: Mapping[str, Placed],
    times: Mapping[int | None, Times | None],
    options: ReadOptions,
    style: NumberStyle,
    problems: list[str],
) -> RecordedLoop:
    series: dict[str, Series] = {}
    bad = 0
    for role, placed in roles.items():
        time, rows = _rows(sheet, times[placed.time], options)
        values, words, rejected = _values(sheet, placed, role, rows, style, layout, problems)
        bad += rejected
        series[role] = Series(time, values, words, rows)
    tags = {_label(role): sheet.columns[placed.values].name for role, placed in roles.items()}
    return merged(sheet, name, series, tags, bad, times[roles["pv"].time])


def _label(role: str) -> str:
    return role if role == "mode" else role.upper()


def _rows(sheet: Sheet, times: Times | None, options: ReadOptions) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return times and rows of one role, oldest first, without rows that have no time."""
    if times is None:
        rows = np.arange(len(sheet.lines))
        return (options.columns.ts or 1.0) * rows.astype(np.float64), rows
    known = np.flatnonzero(np.isfinite(times.read))
    return rising(times.utc(known), known)


def _values(
    sheet: Sheet,
    placed: Placed,
    role: str,
    rows: NDArray[np.intp],
    style: NumberStyle,
    layout: ColumnLayout,
    problems: list[str],
) -> tuple[FloatArray, tuple[str, ...], int]:
    """Return values, the words of a mode, and how many values were rejected."""
    column = sheet.columns[placed.values]
    if role == "mode":
        values, words = words_as_numbers(sheet.text(column, rows))
        return values, words, 0
    cells = column.cells
    if isinstance(cells, np.ndarray):
        numbers, wrong = np.array(cells, np.float64), list[int]()
    else:
        numbers, wrong = style.numbers(cells)
    if wrong:
        cell = cells[wrong[0]]
        fault = f"{column.name} is {shown(str(cell))}, expected a number or an empty cell"
        if layout.format == "plain" or len(wrong) > MOST_WRONG * len(cells):
            raise RecordingError(f"{sheet.where(wrong[0])}: {fault}")
        more = f" ({len(wrong) - 1} more)" if len(wrong) > 1 else ""
        problems.append(f"{sheet.place} {sheet.lines[wrong[0]]}: {fault}; it is a gap{more}")
    numbers[~np.isfinite(numbers)] = np.nan
    rejected = len(wrong)
    if placed.quality is not None:
        good = usable(sheet.text(sheet.columns[placed.quality]))
        rejected += int(np.count_nonzero(np.isfinite(numbers) & ~good))
        numbers[~good] = np.nan
    return numbers[rows], (), rejected

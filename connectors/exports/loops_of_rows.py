"""Loops of a long table: each row is a value of a tag at a time."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from connectors.exports.cells.quality_words import usable
from connectors.exports.cells.tagging import suited
from connectors.exports.cells.times import times_of
from connectors.exports.fault import RecordingError, shown
from connectors.exports.layout import (
    ColumnLayout,
    left_out,
    short_names,
    taken_for_output,
    usable_roles,
)
from connectors.exports.long_table import tags_of
from connectors.exports.loops_of_columns import MOST_WRONG, no_loops, number_style
from connectors.exports.merged import merged
from connectors.exports.plain_table import loop_name
from connectors.exports.recorded import Export, ReadOptions, RecordedLoop
from connectors.exports.series import Series, rising, words_as_numbers
from connectors.exports.span import stated
from connectors.exports.stored_loops import StoredLoops

if TYPE_CHECKING:
    from connectors.exports.cells.number_style import NumberStyle
    from connectors.exports.cells.tagging import Tagger
    from connectors.exports.tables.sheet import Column, FloatArray, Sheet


def loops_of_rows(sheet: Sheet, layout: ColumnLayout, options: ReadOptions, tagger: Tagger) -> Export:
    """Return the loops of a long table.

    Raises:
        RecordingError: No loop has both PV and OP, times or numbers cannot be read.
    """
    if not layout.tag or layout.value is None or layout.time is None:
        raise ValueError("a long table has columns of tags, times and values")
    style = number_style(sheet, layout, options)
    times = times_of(sheet, sheet.columns[layout.time], options.times, style)
    numbers, wrong = _numbers(sheet, layout.value, style)
    good = np.isfinite(times.read)
    if layout.quality is not None:
        allowed = usable(sheet.text(sheet.columns[layout.quality]))
        numbers[~allowed] = np.nan
    else:
        allowed = np.ones(len(numbers), np.bool_)
    rows = _rows_of_tags(tags_of(sheet, layout.tag))
    tags, problems = _tags(rows, suited(tagger, rows), loop_name(sheet.path))
    problems += times.notes
    names = short_names(list(tags))
    loops = StoredLoops[RecordedLoop]()
    value = sheet.columns[layout.value]
    for loop, roles in tags.items():
        found = usable_roles(roles)
        lacking = [role.upper() for role in ("pv", "op") if role not in found]
        if lacking:
            problems.append(f"{names[loop]}: has no {' and no '.join(lacking)}, it was left out")
            continue
        if "op" not in roles:
            problems.append(taken_for_output(names[loop], roles["mv"]))
        series: dict[str, Series] = {}
        bad = 0
        for role, tag in found.items():
            mine = rows[tag][good[rows[tag]]]
            time, mine = rising(times.utc(mine), mine)
            if role == "mode":
                series[role] = Series(time, *words_as_numbers(sheet.text(value, mine)), mine)
                continue
            series[role] = Series(time, numbers[mine], rows=mine)
            lost = np.sort(mine[wrong[mine]])
            if lost.size:
                problems.append(_no_number(sheet, tag, value, lost, len(mine)))
            bad += len(lost) + int(np.count_nonzero(~allowed[mine]))
        labels = {role if role == "mode" else role.upper(): tag for role, tag in found.items()}
        loops.append(stated(merged(sheet, names[loop], series, labels, bad, times), options))
    if not loops:
        raise no_loops(sheet, problems)
    return Export(
        sheet.path, "long", sheet.kind, times.zone, times.form, style.decimal, loops, tuple(problems)
    )


def _no_number(sheet: Sheet, tag: str, value: Column, rows: NDArray[np.intp], of: int) -> str:
    """Return a line about values that are no numbers; raises RecordingError where most of a tag are none."""
    fault = f"{tag} is {shown(sheet.text(value, rows[:1])[0])}, expected a number or an empty cell"
    if len(rows) > MOST_WRONG * of:
        raise RecordingError(f"{sheet.where(rows[0])}: {fault}")
    more = f" ({len(rows) - 1} more)" if len(rows) > 1 else ""
    return f"{sheet.place} {sheet.lines[rows[0]]}: {fault}; it is a gap{more}"


def _numbers(sheet: Sheet, place: int, style: NumberStyle) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the values, shape (n,), NaN where there is none, and where a cell is neither number nor gap."""
    cells = sheet.columns[place].cells
    wrong = np.zeros(len(cells), np.bool_)
    if isinstance(cells, np.ndarray):
        numbers = np.array(cells, np.float64)
    else:
        numbers, rows = style.numbers(cells)
        wrong[rows] = True
    numbers[~np.isfinite(numbers)] = np.nan
    return numbers, wrong


def _rows_of_tags(cells: Sequence[str]) -> dict[str, NDArray[np.intp]]:
    """Return tag -> its rows, in the order of the file."""
    places: dict[str, int] = {}
    found = (places.setdefault(tag, len(places)) for tag in cells)
    numbers = np.fromiter(found, np.int32, len(cells))
    order = np.argsort(numbers, kind="stable")
    ends = np.cumsum(np.bincount(numbers, minlength=len(places)))
    parts = np.split(order, ends[:-1])
    return {tag: part for tag, part in zip(places, parts, strict=True) if tag}


def _tags(
    rows: dict[str, NDArray[np.intp]], tagger: Tagger, unnamed: str
) -> tuple[dict[str, dict[str, str]], list[str]]:
    """Return loop -> role -> tag, and a line for tags of no loop; a role alone is of the loop ``unnamed``."""
    tags: dict[str, dict[str, str]] = defaultdict(dict)
    others: list[str] = []
    unused: list[str] = []
    for tag in rows:
        found = tagger(tag)
        if found is None or found.of_quality:
            others.append(tag)
            continue
        own = tags[found.loop or unnamed]
        if found.role in own:
            unused.append(left_out(tag, own[found.role], found))
        else:
            own[found.role] = tag
    problems = [f"tags of no loop were left out: {', '.join(others[:10])}"] if others else []
    return dict(tags), problems + unused

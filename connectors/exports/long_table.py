"""A table with a row a value: which columns name the tag, and which holds the value.

By their names where these say so. Else the column whose cells are tags of loops, or two columns that make one
together: InfluxDB has the loop in ``_measurement`` and the role in ``_field``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from connectors.exports.cells.calendar_times import moment_of
from connectors.exports.cells.tag_roles import ROLE, TAG_WORDS, VALUE_WORDS, plain, tag_role
from connectors.exports.cells.tagging import complete_loops, suited
from connectors.exports.layout import ColumnLayout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from connectors.exports.cells.tagging import Tagger
    from connectors.exports.tables.sheet import Sheet

SEEN = 2000
"""Rows, spread over the table, of which the cells are looked at."""
LOOP_WORDS = ("loop", "device", "asset", "equipment", "instrument", "measurement")
"""Names of columns that hold loops, the surest first: with one loop its column is as constant as that of the
host that collects."""


def long_layout(sheet: Sheet, times: Sequence[int], tagger: Tagger) -> ColumnLayout | None:
    """Return the layout of a table with a row a value, or None where it is none."""
    names = [plain(column.name) for column in sheet.columns]
    value = next((k for k, name in enumerate(names) if name in VALUE_WORDS), None)
    if value is None or not times:
        return None
    quality = next((k for k, name in enumerate(names) if ROLE.get(name) == "quality"), None)
    named = tuple(k for k, name in enumerate(names) if name in TAG_WORDS)[:1]
    cells = _texts(sheet, {*times, value, quality})
    tag = named
    if not cells.keys() >= set(named) or not _loops(cells, named, tagger):
        tag = _by_cells(cells, names, tagger) or named
    return ColumnLayout("long", tag=tag, value=value, quality=quality, time=times[0]) if tag else None


def tags_of(sheet: Sheet, tag: Sequence[int]) -> Sequence[str]:
    """Return the tag of each row, (n,); those of two columns with a slash between."""
    columns = [sheet.text(sheet.columns[k]) for k in tag]
    return columns[0] if len(columns) == 1 else ["/".join(parts) for parts in zip(*columns, strict=True)]


def _texts(sheet: Sheet, others: set[int | None]) -> dict[int, list[str]]:
    """Return column -> cells of some rows, of columns that hold neither numbers nor times."""
    count = len(sheet.lines)
    rows = np.unique(np.linspace(0, count - 1, min(count, SEEN)).astype(np.intp))
    found: dict[int, list[str]] = {}
    for k, column in enumerate(sheet.columns):
        if k in others or isinstance(column.cells, np.ndarray):
            continue
        cells = list(sheet.text(column, rows))
        if any(cell and moment_of(cell) is None for cell in set(cells)):
            found[k] = cells
    return found


def _by_cells(cells: dict[int, list[str]], names: Sequence[str], tagger: Tagger) -> tuple[int, ...] | None:
    """Return the column, else the two, that make most loops; else that of the roles of one loop, or ()."""
    alone: list[tuple[int, ...]] = [(k,) for k in cells]
    roles = [k for k in cells if _are_roles(cells[k])]
    pairs = [(loop, role) for role in roles for loop in cells if loop != role]
    for tried in (alone, pairs):
        loops = {each: _loops(cells, each, tagger) for each in tried}
        best = max(tried, key=lambda each: (loops[each], -_rank(names[each[0]])), default=())
        if best and loops[best]:
            return best
    return tuple(roles[:1])


def _loops(cells: dict[int, list[str]], tag: Sequence[int], tagger: Tagger) -> int:
    """Return how many loops have all that they need by the tags of some columns."""
    tags = {"/".join(parts) for parts in zip(*(cells[k] for k in tag), strict=True) if parts and all(parts)}
    return complete_loops(suited(tagger, tags), tags)


def _are_roles(cells: Sequence[str]) -> bool:
    """Whether cells are words for roles alone, PV among them."""
    found = [tag_role(cell) for cell in set(cells) if cell]
    return any(each is not None and not each.loop and each.role == "pv" for each in found)


def _rank(name: str) -> int:
    return LOOP_WORDS.index(name) if name in LOOP_WORDS else len(LOOP_WORDS)

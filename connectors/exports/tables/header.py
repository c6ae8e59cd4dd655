"""Where the names of the columns are: below notes, above units, in one line or in two."""

from __future__ import annotations

import re
from array import array
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from typing import TYPE_CHECKING

from connectors.exports.cells.calendar_times import moment_of
from connectors.exports.cells.number_style import is_number
from connectors.exports.cells.tag_roles import ROLE, VALUE_WORDS, is_time, plain, tag_role
from connectors.exports.fault import RecordingError
from connectors.exports.tables.sheet import Column, Sheet
from connectors.exports.tables.stored_cells import StoredTable

if TYPE_CHECKING:
    from pathlib import Path

Row = tuple[int, list[str]]

COMMENTS = ("#", "//", "%%", ";;")
NO_HEADER = 0
"""Line of the header of a table without names: its columns are called 1, 2 and so on."""
LOOKED_AT = 200
"""Rows in which the header is looked for."""
WIDTH_FROM = 20
"""Samples of which the longest has as many cells as there are columns."""
MOST_BAD = 0.1
"""Share of rows with a wrong number of cells above which the file is no such table."""
UNITS = frozenset(
    [
        "%",
        "°c",
        "°f",
        "k",
        "degc",
        "degf",
        "bar",
        "barg",
        "mbar",
        "kpa",
        "mpa",
        "pa",
        "psi",
        "psig",
        "t/h",
        "kg/h",
        "kg/s",
        "m3/h",
        "m³/h",
        "nm3/h",
        "l/min",
        "l/h",
        "gpm",
        "scfm",
        "m",
        "mm",
        "cm",
        "rpm",
        "a",
        "ma",
        "v",
        "kw",
        "mw",
        "s",
        "sec",
        "ms",
        "min",
        "h",
        "ph",
        "ppm",
        "eu",
        "-",
        "none",
        "na",
        "units",
        "unit",
        "pct",
        "percent",
        "degree",
        "degrees",
        "dimensionless",
    ]
)
UNIT_FORM = re.compile(r"[\[(][^\])]*[\])]|[a-zA-Z°µ%³²]{1,5}(?:/[a-zA-Z³²0-9]{1,4})?|")


def sheet_of(path: Path, rows: Iterator[Row], place: str, kind: str) -> Sheet:
    """Return the columns of a table.

    A row with too few or too many cells is left out and its line is noted; it becomes a gap.

    Args:
        path: For messages.
        rows: Line and cells of each row that is not empty.
        place: What the lines count.
        kind: Format of the file.

    Raises:
        RecordingError: There is no sample, or most rows have another number of cells.
    """
    bare = (_without_comment(row) for row in rows)
    head = list(islice(bare, LOOKED_AT + WIDTH_FROM))
    if not head:
        raise RecordingError(f"{path}: is empty, expected a line of column names and one line a sample")
    first = _first_sample(head)
    above = [row for row in head[:first] if row[1]]
    width = max((len(cells) for _, cells in head[first : first + WIDTH_FROM]), default=0)
    if width and not any(_known(cells) or len(cells) >= width for _, cells in above):
        header, names, units = NO_HEADER, [str(k + 1) for k in range(width)], list[str]()
    else:
        header, names, units = _names(above, width)
    while names and not names[-1]:
        names.pop()
    samples = chain(head[first:], bare) if first < len(head) else iter(())
    table, lines, bad = _fitting(path, samples, names, place)
    if not lines and not bad:
        no_table = f"{path}: expected a line of column names as time,OP,PV and one {place} a sample"
        raise RecordingError(f"{path}: has column names but no samples" if _known(names) else no_table)
    columns = tuple(
        Column(name, cells, units[k] if k < len(units) else "")
        for k, (name, cells) in enumerate(zip(names, table.columns(), strict=True))
    )
    return Sheet(path, columns, lines, place, header, kind, tuple(bad))


def _without_comment(row: Row) -> Row:
    """Return a row without the mark of a comment, or an empty one where it is nothing but a comment."""
    line, cells = row
    mark = next((each for each in COMMENTS if cells[0].startswith(each)), None)
    if mark is None:
        return row
    bare = [cells[0].removeprefix(mark).strip(), *cells[1:]]
    return line, bare if _known(bare) >= 2 else []


def _known(cells: Sequence[str]) -> int:
    """Return how many cells name a time or a role, alone or within a tag."""
    return sum(1 for cell in cells if cell and (is_time(cell) or tag_role(cell) or plain(cell) in ROLE))


def _is_sample(cells: Sequence[str]) -> bool:
    """Whether a row holds values: numbers, times and gaps are most of it, and one is a number or a time."""
    filled = [cell for cell in cells if cell]
    values = [cell for cell in filled if is_number(cell) or moment_of(cell) is not None]
    return bool(values) and (2 * len(values) >= len(filled) or len(values) >= 2)


def _first_sample(rows: Sequence[Row]) -> int:
    """Return the index of the first row from which on rows are samples; the number of rows where none is."""
    looked_at = rows[:LOOKED_AT]
    widths = Counter(len(cells) for _, cells in looked_at if _is_sample(cells))
    if not widths:
        return len(rows)
    usual = widths.most_common(1)[0][0]
    for k, (_, cells) in enumerate(looked_at):
        following = [each for _, each in looked_at[k + 1 : k + 4]]
        steady = sum(_is_sample(each) for each in following) * 2 >= len(following)
        if cells and _is_sample(cells) and steady and (len(cells) == usual or _known(cells) == 0):
            return k if len(cells) >= 2 or usual == 1 else k + 1
    return len(rows)


def _names(above: Sequence[Row], width: int) -> tuple[int, list[str], list[str]]:
    """Return line, names and units of the header among the rows above the samples."""
    full = [(line, cells) for line, cells in above if sum(map(bool, cells)) >= 2 or len(above) == 1] or list(
        above
    )
    known = [_known(cells) for _, cells in full]
    most = max(known)
    best = max(k for k, count in enumerate(known) if count == most) if most else len(full) - 1
    if not most and best > 0 and _are_units(full[best][1]):
        best -= 1
    line, names = full[best][0], list(full[best][1])
    below = full[best + 1][1] if best + 1 < len(full) else []
    units = below if _are_units(below) else []
    roles = [ROLE[plain(name)] for name in names if plain(name) in ROLE]
    if best > 0 and len(roles) > len(set(roles)) and len(full[best - 1][1]) >= width - 1:
        names = _of_two_lines(full[best - 1][1], names)
    elif best > 0 and sum(plain(name) in VALUE_WORDS for name in names) > 1:
        names = _above_values(full[best - 1][1], names)
    elif width == len(names) + 1 and not any(names[1::2]) and all(tag_role(name) for name in names[::2]):
        names = [cell for tag in names[::2] for cell in ("time", tag)]  # DataLink: a tag above time and value
    return line, names, list(units)


def _are_units(cells: Sequence[str]) -> bool:
    filled = [cell for cell in cells if cell]
    return bool(filled) and all(
        cell.strip("[]()").casefold() in UNITS or UNIT_FORM.fullmatch(cell) or is_time(cell)
        for cell in filled
    )


def _of_two_lines(tags: Sequence[str], roles: Sequence[str]) -> list[str]:
    """Return ``tag.role`` for tags that stand once above several roles."""
    names, tag = [], ""
    for k, role in enumerate(roles):
        tag = (tags[k] if k < len(tags) else "") or tag
        names.append(f"{tag}.{role}" if tag and plain(role) in ROLE and not is_time(tag) else role)
    return names


def _above_values(tags: Sequence[str], names: Sequence[str]) -> list[str]:
    """Return the tags, each once above time and value, in place of the names of the values."""
    found, tag = [], ""
    for k, name in enumerate(names):
        tag = (tags[k] if k < len(tags) else "") or tag
        found.append(tag if tag and plain(name) in VALUE_WORDS else name)
    return found


def _fitting(
    path: Path, rows: Iterator[Row], names: Sequence[str], place: str
) -> tuple[StoredTable, array[int], array[int]]:
    """Return the rows that have a cell for each name, their lines, and the lines of the others."""
    good = StoredTable(len(names))
    lines, bad = array("q"), array("q")
    fault = ""
    for line, cells in rows:
        surplus = any(cells[len(names) :])
        if cells[: len(names)] == list(names):
            continue  # the header once more, where files were joined
        if len(cells) < len(names) or surplus:
            bad.append(line)
            text = " (is there a decimal comma?)" if place == "line" else ""
            comma = text if surplus else f": {', '.join(names)}"
            fault = fault or f"{path}, {place} {line}: {len(cells)} cells, expected {len(names)}{comma}"
        else:
            lines.append(line)
            good.append(cells)
    few = len(bad) <= MOST_BAD * (len(lines) + len(bad))
    if fault and (not lines or not few) and not _footer(bad, lines):
        raise RecordingError(fault)
    return good, lines, bad


def _footer(bad: Sequence[int], good: Sequence[int]) -> bool:
    """Whether all lines that do not fit stand behind the samples, as notes of a report do."""
    return bool(good) and len(bad) <= 5 and bad[0] > good[-1]

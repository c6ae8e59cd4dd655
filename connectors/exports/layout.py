"""How a table holds loops: one loop (plain), a column a tag (wide), a row a value (long)."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, TypeVar

import numpy as np

from connectors.exports.cells.calendar_times import moment_of
from connectors.exports.cells.tag_roles import ROLE, TagRole, is_time, plain

if TYPE_CHECKING:
    from connectors.exports.cells.tagging import Tagger
    from connectors.exports.tables.sheet import Column, Sheet

Format = Literal["plain", "wide", "interleaved", "long"]
Of = TypeVar("Of")
"""What a role has: columns, or a tag."""
LOOKED_AT = 50
"""Cells from which a column of times is known without its name."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Columns of one role: where its times, values and qualities are, by number."""

    values: int
    time: int | None
    """None: rows are counted by ``--ts``."""
    quality: int | None = None


@dataclass(frozen=True, slots=True)
class ColumnLayout:
    """Which columns are what."""

    format: Format
    loops: Mapping[str, Mapping[str, Placed]] = field(default_factory=dict)
    """Loop -> role -> columns; for a long table empty, for its loops are in its rows."""
    tag: tuple[int, ...] = ()
    """Column of tags of a long table, or the columns of loop and role that make one."""
    value: int | None = None
    quality: int | None = None
    time: int | None = None
    unused: tuple[str, ...] = ()
    """A line for each column of a role that its loop has already."""


def time_columns(sheet: Sheet) -> list[int]:
    """Return the columns of times, by type, by name, else by what they hold."""
    typed = [k for k, column in enumerate(sheet.columns) if column.moments]
    if typed:
        return typed
    named = [k for k, column in enumerate(sheet.columns) if is_time(column.name)]
    if named:
        return named
    return [k for k, column in enumerate(sheet.columns) if _holds_times(column)]


def _holds_times(column: Column) -> bool:
    if isinstance(column.cells, np.ndarray):
        return False
    cells = [cell for cell in column.cells[:LOOKED_AT] if cell]
    return bool(cells) and all(moment_of(cell) is not None and not cell.isdigit() for cell in cells)


def wide_layout(sheet: Sheet, times: Sequence[int], tagger: Tagger) -> ColumnLayout:
    """Return the layout of a table with a column a tag; a time column serves the columns behind it."""
    values: dict[str, dict[str, Placed]] = defaultdict(dict)
    qualities: dict[tuple[str, str], int] = {}
    last: tuple[str, TagRole, int] | None = None
    unused: list[str] = []
    interleaved = len(times) > 1
    for k, column in enumerate(sheet.columns):
        if k in times or not column.name:
            continue
        if last is not None and ROLE.get(plain(column.name)) == "quality":  # a quality behind its value
            qualities[last[0], last[1].role] = k
            continue
        found = tagger(column.name)
        if found is None or not found.loop:
            continue
        if found.of_quality:
            qualities[found.loop, found.role] = k
            continue
        time = max((each for each in times if each < k), default=times[0] if times else None)
        last = (found.loop, found, k)
        if found.role in values[found.loop]:
            taken = sheet.columns[values[found.loop][found.role].values].name
            unused.append(left_out(column.name, taken, found))
            continue
        values[found.loop][found.role] = Placed(k, time)
    loops = {
        loop: {
            role: Placed(each.values, each.time, qualities.get((loop, role))) for role, each in roles.items()
        }
        for loop, roles in values.items()
    }
    return ColumnLayout("interleaved" if interleaved else "wide", loops, unused=tuple(unused))


def left_out(name: str, taken: str, found: TagRole) -> str:
    """Return a line for a column or tag whose role its loop has already."""
    role = found.role if found.role == "mode" else found.role.upper()
    return f"{name}: was left out, {taken} was taken for {role} of {found.loop}; --mapping takes another"


def taken_for_output(loop: str, name: str) -> str:
    """Return a line for the column or tag of MV of a loop without OP."""
    return f"{loop}: {name} was taken for the controller's output"


def usable_roles(roles: Mapping[str, Of]) -> dict[str, Of]:
    """Return the roles of a loop; where there is no OP, MV is the controller's output (Yokogawa)."""
    found = dict(roles)
    if "op" not in found and "mv" in found:
        found["op"] = found.pop("mv")
    return found


def short_names(loops: Sequence[str]) -> dict[str, str]:
    """Return loop -> short name: the last part of its path, or the whole path where two would be the same."""
    short = {loop: loop.split("/")[-1] for loop in loops}
    counts: dict[str, int] = defaultdict(int)
    for name in short.values():
        counts[name] += 1
    return {loop: name if counts[name] == 1 else loop.replace("/", "_") for loop, name in short.items()}

"""A table of one loop: columns OP and PV, by their names or by the names that the user gives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from connectors.exports.cells.tag_roles import plain, tag_role
from connectors.exports.cells.tagging import suited, tagger_of
from connectors.exports.fault import RecordingError
from connectors.exports.layout import ColumnLayout, Placed, usable_roles
from connectors.exports.long_table import long_layout
from connectors.exports.recorded import STANDARD, ReadOptions
from connectors.exports.tables.header import NO_HEADER

if TYPE_CHECKING:
    from connectors.exports.tables.sheet import Sheet

ROLES = ("op", "pv", "sp", "mv", "mode")
REQUIRED = ("op", "pv")


def plain_layout(sheet: Sheet, times: Sequence[int], options: ReadOptions) -> ColumnLayout | None:
    """Return the layout of a table of one loop, or None where it holds tags.

    Raises:
        RecordingError: A column that the user names, or that a table of one loop needs, is missing.
    """
    given = {role: getattr(options.columns, role) for role in ROLES}
    standard = {role: getattr(STANDARD, role) for role in ROLES}
    named = any(given[role] != standard[role] for role in REQUIRED)
    found = {role: _place(sheet, given[role], role, by_word=given[role] == standard[role]) for role in ROLES}
    there = {role: place for role, place in found.items() if place is not None}
    if options.loops or (not named and not _is_plain(there) and _holds_tags(sheet, times, options)):
        return None
    placed = (
        usable_roles({role: Placed(place, None) for role, place in there.items()})
        if not named
        else {role: Placed(place, None) for role, place in there.items()}
    )
    for role in ROLES:
        if role not in placed and (role in REQUIRED or given[role] != standard[role]):
            raise _missing(sheet, given[role], f"--{role}")
    time = _time(sheet, times, options)
    qualities = _qualities(sheet, placed)
    return ColumnLayout(
        "plain",
        {
            loop_name(sheet.path): {
                role: Placed(each.values, time, qualities.get(role)) for role, each in placed.items()
            }
        },
    )


def loop_name(path: Path) -> str:
    """Return the name of the loop of a file: that of the file without the endings of its format."""
    name = path.name
    for ending in (".gz", ".zip"):
        name = name.removesuffix(ending)
    return Path(name).stem


def _is_plain(there: dict[str, int]) -> bool:
    return "pv" in there and ("op" in there or "mv" in there)


def _holds_tags(sheet: Sheet, times: Sequence[int], options: ReadOptions) -> bool:
    """Whether the names or the rows of a table are tags of loops."""
    given = tagger_of(sheet.path, options)
    names = [column.name for column in sheet.columns]
    tags = [found for found in map(suited(given, names), names) if found is not None and found.loop]
    return any(found.role in {"pv", "op"} for found in tags) or long_layout(sheet, times, given) is not None


def _place(sheet: Sheet, name: str, role: str, *, by_word: bool) -> int | None:
    """Return the column of a role: by its name, then without regard to case, then by another word for it."""
    tests: list[Callable[[str], bool]] = [name.__eq__, lambda found: plain(found) == plain(name)]
    if by_word:
        tests.append(lambda found: _is_role(found, role))
    for test in tests:
        places = [k for k, column in enumerate(sheet.columns) if column.name and test(column.name)]
        if len(places) > 1:
            twice = sheet.columns[places[1]].name
            raise RecordingError(
                f"{sheet.path}, {sheet.place} {sheet.header}: column {twice!r} is there twice"
            )
        if places:
            return places[0]
    return None


def _is_role(name: str, role: str) -> bool:
    known = tag_role(name)
    return known is not None and not known.loop and not known.of_quality and known.role == role


def _time(sheet: Sheet, times: Sequence[int], options: ReadOptions) -> int | None:
    if options.columns.ts is not None:
        return None
    name = options.columns.time
    place = next((k for k, column in enumerate(sheet.columns) if column.name == name), None)
    if place is None and name == STANDARD.time and times:
        place = times[0]
    if place is None:
        raise _missing(sheet, name, "--time, or give the sampling time by --ts")
    return place


def _qualities(sheet: Sheet, placed: dict[str, Placed]) -> dict[str, int]:
    """Return role -> column of its quality: ``PV quality``, or ``Quality`` behind the column."""
    found = {}
    by_place = {each.values: role for role, each in placed.items()}
    for k, column in enumerate(sheet.columns):
        known = tag_role(column.name)
        if known is not None and known.of_quality and known.role in placed:
            found[known.role] = k
        elif plain(column.name) in {"quality", "status", "statuscode"} and k - 1 in by_place:
            found[by_place[k - 1]] = k
    return found


def _missing(sheet: Sheet, name: str, option: str) -> RecordingError:
    if sheet.header == NO_HEADER:
        return RecordingError(
            f"{sheet.path}: has no line of column names, its columns are 1 to {len(sheet.columns)}: name "
            "them, such as --op 1 --pv 2, and a time column by --time or the sampling time by --ts"
        )
    there = ", ".join(ascii(column.name)[1:-1] for column in sheet.columns if column.name)
    return RecordingError(
        f"{sheet.path}, {sheet.place} {sheet.header}: expected a column {name!r} (or name it by {option}), "
        f"the file has: {there[:200]}"
    )

"""Many loops from one list: a CSV file with a line for each loop, and their common settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from agent.settings.models import LoopSettings
from connectors.base import ConfigError
from connectors.kinds import KINDS
from connectors.options import Options
from connectors.table import read_table

COMMENT = "#"
"""First character of the name of a column that is ignored."""
RANGES = {"op_range": ("op_low", "op_high"), "pv_range": ("pv_low", "pv_high")}
"""Setting -> the columns of its two ends."""
ROLES = frozenset(role for kind in KINDS for role in kind.roles)
"""Columns that hold an address."""
_PATHS = {
    **{column: f"{name}.{end}" for name, pair in RANGES.items() for end, column in enumerate(pair)},
    **{role: f"tags.{role}" for role in ROLES},
}
"""Column -> path in a loop's entry; any other column is named as its path."""

Short = Callable[[str], Mapping[str, str]]
"""Turns an address written as one text into an entry of ``tags``."""


class LoopList(Options):
    """Entry among the loops that stands for all lines of a CSV file."""

    source: Annotated[Path, Field(alias="from", examples=["plant_loops.csv"])]
    """The CSV file; relative to this file. `docs/howto/many_loops.md` lists its columns."""
    defaults: Mapping[str, Any] = {}
    """Settings of a loop where its line leaves them empty. `{loop}` in a text becomes the loop's name."""


@dataclass(frozen=True, slots=True)
class LoopEntry:
    """One loop as written by the user, and where a fault in it is reported."""

    place: str
    """Place of the entry: ``loops.0``, or file and line."""
    raw: Mapping[str, Any]
    columns: Mapping[str, str] = field(default_factory=dict)
    """Path in ``raw`` -> column of the list that the value came from."""
    shared: str | None = None
    """Path of the list's defaults; None for a loop that is not a line of a list."""
    defaults: Mapping[str, Any] = field(default_factory=dict)

    def located(self, fault: str) -> str:
        """Return ``PLACE.PATH: what is wrong`` with the column, or the default, that causes the fault."""
        if self.shared is None or not fault.startswith(f"{self.place}."):
            return fault
        path, _, message = fault.removeprefix(f"{self.place}.").partition(": ")
        keys = path.split(".")
        for end in range(len(keys), 0, -1):
            column = self.columns.get(".".join(keys[:end]))
            if column is not None:
                return ": ".join([f"{self.place}, column {column}", *keys[end:], message])
        if _there(self.defaults, keys):
            return f"{self.shared}.{path}: {message}"
        return f"{self.place}: {path}: {message}"


def listed_loops(
    entry: LoopList, path: str, folder: Path, shorts: Mapping[str, Short | None], faults: list[str]
) -> tuple[LoopEntry, ...]:
    """Return an entry for each line of a list.

    Args:
        entry: Entry that names the list.
        path: Path of that entry in the configuration file.
        folder: Folder of the configuration file.
        shorts: Connection -> how its kind reads an address written as one text.
        faults: Faults of the file as a whole are appended here.
    """
    try:
        table = read_table(folder / entry.source)
    except ConfigError as error:
        faults += error.faults
        return ()
    if not table.lines:
        faults.append(f"{table.path}: no loop in it, expected a line for each loop below the column names")
    columns = {}
    for column, cells in table.columns.items():
        if _PATHS.get(column, column).split(".")[0] in LoopSettings.model_fields:
            columns[column] = cells
        elif not column.startswith(COMMENT):
            where = f"{table.path}, {table.place} {table.header}, column {column}"
            faults.append(f"{where}: unknown; begin its name with {COMMENT} to have it ignored")
    return tuple(
        _line(
            entry.defaults,
            {column: str(cells[row]).strip() for column, cells in columns.items()},
            table.where(row),
            f"{path}.defaults",
            shorts,
        )
        for row in range(len(table.lines))
    )


def _line(
    defaults: Mapping[str, Any],
    cells: Mapping[str, str],
    place: str,
    shared: str,
    shorts: Mapping[str, Short | None],
) -> LoopEntry:
    said = {column: cell for column, cell in cells.items() if cell}
    loop: dict[str, Any] = _named(defaults, said.get("name", ""))
    short = shorts.get(said.get("connection", str(loop.get("connection"))))
    columns = {_PATHS.get(column, column): column for column in said}
    for name, pair in RANGES.items():
        if said.keys() & set(pair):
            ends = loop.get(name)
            loop[name] = list(ends) if isinstance(ends, list) and len(ends) == len(pair) else [None, None]
            columns = {name: " and ".join(pair)} | {_PATHS[end]: end for end in pair} | columns
    for path, column in columns.items():
        if column in said:
            _put(loop, path.split("."), _value(column, said[column], short))
    return LoopEntry(place, loop, columns, shared, defaults)


def _value(column: str, cell: str, short: Short | None) -> object:
    if column == "automatic":
        return [_number_if_any(word) for word in cell.split()]
    return cell if column not in ROLES or short is None else short(cell)


def _put(node: Any, keys: list[str], value: object) -> None:  # noqa: ANN401 - whatever YAML can hold
    """Set the value at a path; a mapping is merged with the one already there."""
    key: Any = int(keys[0]) if isinstance(node, list) else keys[0]
    former = node[key] if isinstance(node, list) else node.get(key)
    if len(keys) > 1:
        if not isinstance(former, dict) and not _there(former, keys[1:2]):
            node[key] = {}
        _put(node[key], keys[1:], value)
    elif isinstance(former, dict) and isinstance(value, Mapping):
        node[key] = {**former, **value}
    else:
        node[key] = value


def _named(value: Any, name: str) -> Any:  # noqa: ANN401 - whatever YAML can hold
    """Return a copy in which the loop's name replaces ``{loop}`` in every text."""
    if isinstance(value, str):
        return value.replace("{loop}", name)
    if isinstance(value, Mapping):
        return {key: _named(inner, name) for key, inner in value.items()}
    return [_named(inner, name) for inner in value] if isinstance(value, list) else value


def _there(value: object, keys: list[str]) -> bool:
    """Whether there is a value at a path."""
    for key in keys:
        if isinstance(value, Mapping) and key in value:
            value = value[key]
        elif isinstance(value, list) and key.isdecimal() and int(key) < len(value):
            value = value[int(key)]
        else:
            return False
    return True


def _number_if_any(text: str) -> str | float:
    try:
        return float(text)
    except ValueError:
        return text

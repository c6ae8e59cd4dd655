"""Tables of one archive as one export."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from connectors.exports.recorded import RecordedLoop
from connectors.exports.stored_loops import StoredLoops

if TYPE_CHECKING:
    from pathlib import Path

    from connectors.exports.recorded import Export


def together(path: Path, exports: Sequence[Export], faults: Sequence[str]) -> Export:
    """Return the loops of several tables as those of one file.

    A loop that several tables have is named by its table as well: ``day1_FIC101``. What the tables differ in
    (layout, zone ...) is stated with all that there is.

    Args:
        path: The archive.
        exports: What each table has; at least one.
        faults: What was wrong with the other tables, a line each.
    """
    names = Counter(name for export in exports for name in export.loops.names)
    loops = StoredLoops[RecordedLoop]()
    for export in exports:
        for loop in export.loops:
            name = loop.name if names[loop.name] == 1 else _by_table(path, export.path, loop.name)
            loops.append(replace(loop, name=name, path=path))
    problems = [
        f"{export.path.relative_to(path).as_posix()}: {each}"
        for export in exports
        for each in export.problems
    ]
    return replace(
        exports[0],
        path=path,
        format=_all(export.format for export in exports),
        zone=exports[0].zone if len({export.zone for export in exports}) == 1 else "as written",
        time_form=_all(export.time_form for export in exports),
        decimal=_all(export.decimal for export in exports),
        loops=loops,
        problems=(*problems, *(f"{each}; the table was left out" for each in faults)),
    )


def _by_table(path: Path, table: Path, loop: str) -> str:
    within = table.relative_to(path).with_suffix("")
    parts = within.parts if within.name != loop else within.parts[:-1]
    return "_".join((*parts, loop))


def _all(words: Iterable[str]) -> str:
    return " and ".join(dict.fromkeys(words))

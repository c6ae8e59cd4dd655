"""An archive: paths, folders, patterns and addresses as a list of sources."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from glob import glob, has_magic
from pathlib import Path

from connectors.exports.fault import RecordingError
from connectors.sources.kinds import scheme_of

SUFFIXES = {".csv", ".mat", ".parquet", ".pq", ".xlsx", ".gz", ".zip"}
"""Of the files in a folder that are recordings; other files are read where they are named."""


@dataclass(frozen=True, slots=True)
class ArchivePart:
    """One source of an archive."""

    name: str
    """Absolute path, or address: other machines find it by this."""
    recording: str
    """What results call it: the path within the archive; the whole path where two would be the same."""


def parts_of(arguments: Iterable[str], without: Path | None = None) -> tuple[ArchivePart, ...]:
    """Return the sources that the arguments name, each once, those of a folder by name.

    Args:
        arguments: Files, folders (with all folders in them), patterns such as ``archive/*/*.csv``, addresses.
        without: A folder whose files are results of ours.

    Raises:
        RecordingError: An argument names no recording.
    """
    found: dict[str, ArchivePart] = {}
    for argument in arguments:
        parts = list(_parts(argument, None if without is None else without.resolve()))
        if not parts:
            suffixes = ", ".join(sorted(SUFFIXES))
            raise RecordingError(f"{argument}: no recording is there; files that count end with {suffixes}")
        found |= {part.name: part for part in parts if part.name not in found}
    names = Counter(part.recording for part in found.values())
    return tuple(
        part if names[part.recording] == 1 else replace(part, recording=part.name) for part in found.values()
    )


def archive_name(arguments: Iterable[str]) -> tuple[str, ...]:
    """Return what an archive is, the same from every working directory."""
    return tuple(each if scheme_of(each) else str(Path(each).absolute()) for each in arguments)


def _parts(argument: str, without: Path | None) -> Iterator[ArchivePart]:
    if scheme_of(argument):
        yield ArchivePart(argument, argument)
        return
    path = Path(argument)
    if path.is_dir():
        for each in sorted(path.rglob("*")):
            within = each.relative_to(path)
            if not _is_recording(each) or any(part.startswith(".") for part in within.parts):
                continue
            if without is None or each.resolve().parent != without:
                yield ArchivePart(str(each.absolute()), within.as_posix())
    elif has_magic(argument) and not path.exists():
        for match in sorted(glob(argument, recursive=True)):  # noqa: PTH207 - patterns may be absolute
            if Path(match).is_file():
                yield ArchivePart(str(Path(match).absolute()), Path(match).as_posix())
    else:
        yield ArchivePart(str(path.absolute()), path.name)


def _is_recording(path: Path) -> bool:
    return path.suffix.lower() in SUFFIXES and path.is_file()

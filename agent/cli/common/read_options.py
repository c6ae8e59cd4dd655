"""Options that say how a recording is to be read, where its own content leaves it open."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from connectors.recording import Columns, ReadOptions

PANEL = "How files are read (recognised unless given)"


MEANINGS = {"automatic": True, "manual": False}


class DateOrder(StrEnum):
    """Order of day, month and year in dates such as 03/04/2026 or 26-03-01."""

    DMY = "dmy"
    MDY = "mdy"
    YMD = "ymd"


class Decimal(StrEnum):
    """Decimal mark."""

    POINT = "."
    COMMA = ","


Zone = Annotated[
    str | None,
    typer.Option(
        "--zone", metavar="NAME", help="Zone of times without one, as Europe/Berlin.  [default: UTC]",
        rich_help_panel=PANEL,
    ),
]  # fmt: skip
TimeFormat = Annotated[
    str | None,
    typer.Option(
        "--time-format", metavar="FORM", rich_help_panel=PANEL,
        help="seconds (ms, us, min, h, days), epoch_s (_ms, _us, _ns), excel, matlab, filetime, ticks, "
        "labview, or a pattern as %d/%m/%Y %H:%M:%S.",
    ),
]  # fmt: skip
Order = Annotated[
    DateOrder | None,
    typer.Option(
        "--date-order",
        help="Whether 03/04/26 is 3 April (dmy), 4 March (mdy) or in 2003 (ymd).",
        rich_help_panel=PANEL,
    ),
]
DecimalMark = Annotated[
    Decimal | None, typer.Option("--decimal", help="Decimal mark of the numbers.", rich_help_panel=PANEL)
]
Pattern = Annotated[
    str | None,
    typer.Option(
        "--pattern", metavar="FORM", help="Form of tags, as {loop}.{role} or Unit1/{loop}_{role}.",
        rich_help_panel=PANEL,
    ),
]  # fmt: skip
Modes = Annotated[
    str | None,
    typer.Option(
        "--modes", metavar="WORD=MEANING,...", rich_help_panel=PANEL,
        help="Further words of the mode, as PROG7=automatic,LOCK=manual.",
    ),
]  # fmt: skip
MappingFile = Annotated[
    Path | None,
    typer.Option(
        "--mapping", metavar="MAPPING.yaml", help="All of this from a file that slipjump import wrote.",
        rich_help_panel=PANEL,
    ),
]  # fmt: skip


def read_options(
    columns: Columns,
    zone: str | None,
    time_format: str | None,
    order: DateOrder | None,
    decimal: Decimal | None,
    pattern: str | None,
    mapping: Path | None,
    modes: str | None = None,
) -> ReadOptions:
    """Return what the user states about a file.

    Raises:
        RecordingError: The mapping cannot be read.
        BadParameter: ``modes`` is no list of WORD=automatic or WORD=manual.
    """
    from connectors.exports.cells.times import TimeOptions
    from connectors.exports.mapping import with_mapping
    from connectors.recording import ReadOptions

    mark = None if decimal is None else ("," if decimal is Decimal.COMMA else ".")
    day = None if order is None else order.value
    times = TimeOptions(zone, time_format, day)  # type: ignore[arg-type]
    options = ReadOptions(columns, times, mark, pattern, modes=_modes(modes))  # type: ignore[arg-type]
    return options if mapping is None else with_mapping(options, mapping)


def _modes(text: str | None) -> dict[str, bool]:
    from agent.analysis.record.mode import word_of

    found = {}
    for part in (text or "").split(",") if text else ():
        word, _, meaning = part.rpartition("=")
        if not word_of(word) or meaning.strip() not in MEANINGS:
            expected = "expected WORD=automatic or WORD=manual, with commas between"
            raise typer.BadParameter(f"{part!r}: {expected}", param_hint="'--modes'")
        found[word_of(word)] = MEANINGS[meaning.strip()]
    return found

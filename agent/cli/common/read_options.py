"""Options that say how a recording is to be read, where its own content leaves it open."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

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


Start = Annotated[
    str | None,
    typer.Option(
        "--start", metavar="TIME", rich_help_panel=PANEL,
        help="Read from here, as 2026-03-01T06:00 (in --zone, else UTC). Addresses need it.",
    ),
]  # fmt: skip
End = Annotated[
    str | None, typer.Option("--end", metavar="TIME", help="Read up to here.", rich_help_panel=PANEL)
]


def read_options(
    columns: Columns,
    zone: str | None,
    time_format: str | None,
    order: DateOrder | None,
    decimal: Decimal | None,
    pattern: str | None,
    mapping: Path | None,
    modes: str | None = None,
    start: str | None = None,
    end: str | None = None,
) -> ReadOptions:
    """Return what the user states about a file.

    Raises:
        RecordingError: The mapping cannot be read.
        BadParameter: ``modes`` is no list of WORD=automatic or WORD=manual, or start and end are no span.
    """
    from connectors.exports.cells.times import TimeOptions
    from connectors.exports.mapping import with_mapping
    from connectors.recording import ReadOptions

    mark = None if decimal is None else ("," if decimal is Decimal.COMMA else ".")
    day = None if order is None else order.value
    times = TimeOptions(zone, time_format, day)  # type: ignore[arg-type]
    span = _span(start, end, zone)
    options = ReadOptions(columns, times, mark, pattern, modes=_modes(modes), span=span)  # type: ignore[arg-type]
    return options if mapping is None else with_mapping(options, mapping)


def _span(start: str | None, end: str | None, zone: str | None) -> tuple[float, float] | None:
    """Return a span of time in s UTC; None: all."""
    if start is None and end is None:
        return None
    low = float("-inf") if start is None else _moment(start, zone, "--start")
    high = float("inf") if end is None else _moment(end, zone, "--end")
    if low >= high:
        raise typer.BadParameter(f"{end} is not later than {start}", param_hint="'--end'")
    return low, high


def _moment(text: str, zone: str | None, option: str) -> float:
    try:
        time = datetime.fromisoformat(text)
        place = ZoneInfo(zone or "UTC")
    except (ValueError, OSError, ZoneInfoNotFoundError) as error:
        fault = f"{text!r} is not a time like 2026-03-01T06:00"
        raise typer.BadParameter(fault, param_hint=f"'{option}'") from error
    return (time if time.tzinfo else time.replace(tzinfo=place)).timestamp()


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

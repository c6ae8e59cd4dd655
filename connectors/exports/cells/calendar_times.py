"""Dates and times as text, in the orders and languages that exports use."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

from connectors.exports.cells.date_order import Numbers, Order, day_of

MONTHS = {
    name: number
    for number, names in enumerate(
        (
            "jan january januar janv janvier ene enero gen gennaio",
            "feb february februar fev févr février febrero febbraio",
            "mar march mär mrz märz mars marzo maart mrt",
            "apr april avr avril abr abril aprile",
            "may mai mayo maggio mei",
            "jun june juni juin junio giugno giu",
            "jul july juli juil juillet julio luglio lug",
            "aug august août aout ago agosto augustus",
            "sep sept september septembre septiembre settembre set",
            "oct october okt oktober octobre octubre ottobre ott",
            "nov november novembre noviembre",
            "dec december dez dezember déc décembre dic diciembre dicembre",
        ),
        start=1,
    )
    for name in names.split()
}
OFFSETS = {
    "Z": 0.0,
    "UTC": 0.0,
    "GMT": 0.0,
    "CET": 1.0,
    "CEST": 2.0,
    "EST": -5.0,
    "EDT": -4.0,
    "PST": -8.0,
    "PDT": -7.0,
}
"""Hours to UTC of the names of zones that mean one offset only; CST and IST mean several."""
WORD = r"[^\W\d_]{3,10}\.?"
DATE = (
    rf"(?:[^\W\d_]{{2,9}}\.?,?\s+)?(?P<a>\d{{1,4}}|{WORD})(?P<mark>[-/. ])\s?"
    rf"(?P<b>\d{{1,2}}|{WORD}),?[-/. ]\s?(?P<c>\d{{1,4}})"
)
TIME = (
    r"(?P<h>\d{1,2}):(?P<m>\d{2})(?::(?P<s>\d{2})(?:[.,:](?P<f>\d{1,9}))?)?"
    r"(?:\s*(?P<half>[AaPp])\.?\s?[Mm]\.?)?"
)
ZONE = r"(?:\s*(?P<zone>[+-]\d{2}:?\d{2}|[A-Z]{1,4}))?"
FORMS = (
    re.compile(rf"{DATE}(?:[T,]|,?\s+){TIME}{ZONE}"),
    re.compile(rf"{TIME}\s+{DATE}{ZONE}"),
    re.compile(rf"{DATE}(?P<h>)(?P<m>)(?P<s>)(?P<f>)(?P<half>)(?P<zone>)"),
)
EPOCH = datetime(1970, 1, 1)  # noqa: DTZ001 - UTC, as ``Moment.local`` is without a zone
COMPACT = re.compile(r"(\d{4})(\d\d)(\d\d)[ T_]?(\d\d)(\d\d)(\d\d)(?:\.(\d{1,6}))?")


@dataclass(frozen=True, slots=True)
class Moment:
    """A date and time as a cell has it."""

    local: datetime
    """Without a zone."""
    offset: float | None
    """Hours that ``local`` is ahead of UTC; None where the cell has no zone."""
    numbers: Numbers | None = None
    """The numbers of the date where their order is open, else None."""
    dotted: bool = False
    """Whether points stand between ``numbers``."""

    @property
    def utc(self) -> float:
        """Seconds UTC; a time without a zone counts as UTC."""
        return (self.local - EPOCH - timedelta(hours=self.offset or 0.0)).total_seconds()


def moment_of(cell: str, order: Order | None = None) -> Moment | None:
    """Return the moment that a cell names, or None where it names none.

    Args:
        cell: Text.
        order: Of day, month and year where the text leaves it open; None takes the first that is a date.
    """
    text = cell.strip().strip("'\"")
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return _other_forms(text, order)
    if moment.tzinfo is None:
        return Moment(moment, None)
    offset = moment.utcoffset() or timedelta()
    return Moment(moment.replace(tzinfo=None), offset.total_seconds() / 3600)


def _other_forms(text: str, order: Order | None) -> Moment | None:
    compact = COMPACT.fullmatch(text)
    if compact is not None:
        *parts, fraction = compact.groups()
        return _moment(tuple(map(int, parts)), fraction, None, None)
    for form in FORMS:
        found = form.fullmatch(text)
        if found is not None:
            return _read(found, order)
    return None


def _read(found: re.Match[str], order: Order | None) -> Moment | None:
    date = _date(found["a"], found["b"], found["c"], order, dotted=found["mark"] == ".")
    offset = _offset(found["zone"])
    if date is None or (found["zone"] and offset is None):
        return None
    hour, minute, second = (int(found[name] or 0) for name in "hms")
    if found["half"]:
        if not 1 <= hour <= 12:
            return None
        hour = hour % 12 + (12 if found["half"] in "pP" else 0)
    moment = _moment((*date[0], hour, minute, second), found["f"], offset, date[1])
    return moment if moment is None or date[1] is None else replace(moment, dotted=found["mark"] == ".")


def _date(
    a: str, b: str, c: str, order: Order | None, *, dotted: bool
) -> tuple[tuple[int, int, int], Numbers | None] | None:
    """Return (year, month, day), and the numbers as written where their order is open."""
    word_a, word_b = (MONTHS.get(each.rstrip(".").casefold()) for each in (a, b))
    if word_b is not None and a.isdigit():
        return ((int(a), word_b, int(c)) if len(a) == 4 else (_year(c), word_b, int(a))), None
    if word_a is not None and b.isdigit():
        return (_year(c), word_a, int(b)), None
    if not (a.isdigit() and b.isdigit()):
        return None
    if len(a) == 4:
        return (int(a), int(b), int(c)), None
    written = int(a), int(b), int(c)
    orders: tuple[Order, ...] = ("dmy", "ymd") if dotted else ("dmy", "mdy", "ymd")
    for each in orders if order is None else (order,):
        day = day_of(written, each)
        if day is not None:
            return (day.year, day.month, day.day), written
    return None


def _year(text: str) -> int:
    return int(text) + (2000 if len(text) <= 2 else 0)


def _offset(zone: str | None) -> float | None:
    if not zone:
        return None
    if zone[0] in "+-":
        hours = int(zone[1:3]) + int(zone[-2:]) / 60
        return -hours if zone[0] == "-" else hours
    return OFFSETS.get(zone)


def _moment(
    parts: Sequence[int], fraction: str | None, offset: float | None, numbers: Numbers | None
) -> Moment | None:
    year, month, day, hour, minute, second = parts
    microsecond = round(float(f"0.{fraction}") * 1e6) if fraction else 0
    try:
        base = datetime(year, month, day, hour, minute, second)  # noqa: DTZ001 - the zone comes later
        return Moment(base + timedelta(microseconds=microsecond), offset, numbers)
    except (ValueError, OverflowError):
        return None

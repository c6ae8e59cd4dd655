"""Log messages of the daemon on stderr: lines for people, or JSON for machines.

A message has the fields ``event``, ``connection`` and ``loop`` where its author set them by ``extra``. No
other field of a record is printed, so nothing is published by accident.
"""

from __future__ import annotations

import json
import logging
import os
import sys
from collections.abc import Mapping
from datetime import UTC, datetime
from enum import StrEnum
from typing import TextIO

FIELDS = ("event", "connection", "loop")
LIBRARIES = {
    "asyncua": logging.CRITICAL,
    "pymodbus": logging.CRITICAL,
    "aiomqtt": logging.CRITICAL,
    "mqtt": logging.CRITICAL,
    "uvicorn": logging.ERROR,
}
"""Lowest severity logged of libraries, whatever the level: the supervisor logs lost connections, once;
asyncua writes passwords at DEBUG; a client that does not use HTTP is not worth a line each."""


class LogFormat(StrEnum):
    """How log lines look."""

    TEXT = "text"
    JSON = "json"


class LogLevel(StrEnum):
    """Lowest severity to log."""

    DEBUG = "debug"
    INFO = "info"
    WARNING = "warning"
    ERROR = "error"


class JsonLines(logging.Formatter):
    """One JSON object a line."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the line; a field that the message has not is left out."""
        line: dict[str, str] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
        }
        line |= {name: str(getattr(record, name)) for name in FIELDS if hasattr(record, name)}
        line["message"] = record.getMessage()
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        return json.dumps(line, ensure_ascii=False)


class ForJournal(logging.Formatter):
    """Another format with systemd's mark of the level before each line (sd-daemon(3))."""

    def __init__(self, lines: logging.Formatter) -> None:
        super().__init__()
        self._lines = lines

    def format(self, record: logging.LogRecord) -> str:
        """Return the lines; the journal knows the time itself."""
        mark = f"<{_priority(record.levelno)}>"
        return "\n".join(mark + line for line in self._lines.format(record).splitlines())


def set_up(
    form: LogFormat, level: LogLevel, stream: TextIO = sys.stderr, environment: Mapping[str, str] = os.environ
) -> None:
    """Log messages of ``level`` and above from now on."""
    journal = _is_journal(stream, environment)
    formatter: logging.Formatter
    if form is LogFormat.JSON:
        formatter = JsonLines()
    else:
        formatter = logging.Formatter("%(message)s" if journal else "%(asctime)s %(levelname)s %(message)s")
    handler = logging.StreamHandler(stream)
    handler.setFormatter(ForJournal(formatter) if journal else formatter)
    logging.basicConfig(handlers=[handler], level=level.upper(), force=True)
    logging.captureWarnings(capture=True)
    for library, least in LIBRARIES.items():
        logging.getLogger(library).setLevel(least)


def _priority(level: int) -> int:
    """Level of syslog: 7 debug, 6 info, 4 warning, 3 error, 2 critical."""
    marks = ((logging.CRITICAL, 2), (logging.ERROR, 3), (logging.WARNING, 4), (logging.INFO, 6))
    return next((mark for least, mark in marks if level >= least), 7)


def _is_journal(stream: TextIO, environment: Mapping[str, str]) -> bool:
    """Whether ``stream`` goes to systemd's journal: JOURNAL_STREAM names its device and inode."""
    try:
        there = os.fstat(stream.fileno())
    except OSError:  # also where it is no file at all
        return False
    return environment.get("JOURNAL_STREAM") == f"{there.st_dev}:{there.st_ino}"

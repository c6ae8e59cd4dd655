"""What the daemon says on stderr: lines for people, or JSON for machines.

A message names what it is about in fields of its own, where its author gave them by ``extra``: ``event``,
``connection``, ``loop``. Nothing else of a record is told, so nothing gets out that nobody meant to tell.
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
"""The least that libraries may tell, whatever the level: what they lose the supervisor tells, once; asyncua
writes passwords at DEBUG; strangers who speak no HTTP are not worth a line each."""


class LogFormat(StrEnum):
    """How log lines look."""

    TEXT = "text"
    JSON = "json"


class LogLevel(StrEnum):
    """The least that is told."""

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
    """Say from now on what happens, from ``level`` up."""
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

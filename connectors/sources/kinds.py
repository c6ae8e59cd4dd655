"""Every kind of source: the scheme of its address, and the class that reads it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from connectors.exports.fault import RecordingError
from connectors.sources.address import without_password
from connectors.sources.export_file import ExportFile

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions
    from connectors.sources.source import LoopSource

Opener = Callable[[str, "ReadOptions"], "LoopSource"]


def _pi(name: str, options: ReadOptions) -> LoopSource:
    from connectors.sources.pi_web_api import PiWebApi

    return PiWebApi(name, options)


def _influxdb(name: str, options: ReadOptions) -> LoopSource:
    from connectors.sources.influxdb import InfluxDb

    return InfluxDb(name, options)


def _opcua(name: str, options: ReadOptions) -> LoopSource:
    from connectors.sources.opcua_history import OpcUaHistory

    return OpcUaHistory(name, options)


def _sql(name: str, options: ReadOptions) -> LoopSource:
    from connectors.sources.sql_table import SqlTable

    return SqlTable(name, options)


SOURCES: Mapping[str, Opener] = {
    "": ExportFile,
    "pi+https": _pi,
    "pi+http": _pi,
    "opc.tcp": _opcua,
    "postgresql": _sql,
    "influxdb+https": _influxdb,
    "influxdb+http": _influxdb,
}
"""Scheme of the address -> what opens it; a path has none."""
SCHEME = re.compile(r"([a-z][a-z0-9+.-]+)://", re.IGNORECASE)
COLLAPSED = re.compile(r"([a-z][a-z0-9+.-]+):/(?!/)(.+)", re.IGNORECASE)
"""Two letters at least: ``C:/`` is a drive."""


def scheme_of(name: str) -> str:
    """Return the scheme of an address in lower case; empty for a path."""
    found = SCHEME.match(name)
    return found[1].lower() if found else ""


def address_in(path: Path) -> str | None:
    """Return the address that was given where a path is expected; None where it is a path.

    A path has no empty parts, so one slash behind the scheme stands for two.
    """
    found = COLLAPSED.match(str(path))
    return None if found is None else f"{found[1]}://{found[2]}"


def opened(name: str, options: ReadOptions) -> LoopSource:
    """Open a source by its path or address.

    Raises:
        ConfigError: No source has such an address, or it is not whole; the text holds no password.
    """
    scheme = scheme_of(name)
    if scheme not in SOURCES:
        known = ", ".join(f"{each}://" for each in SOURCES if each)
        raise RecordingError(f"{without_password(name)}: expected a file, or an address with {known}")
    return SOURCES[scheme](name, options)

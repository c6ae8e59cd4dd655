"""Every kind of source: the scheme of its address, and the class that reads it."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from connectors.sources.export_file import ExportFile

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions
    from connectors.sources.source import LoopSource

Opener = Callable[[str, "ReadOptions"], "LoopSource"]
SOURCES: Mapping[str, Opener] = {
    "": ExportFile,
}
"""Scheme of the address -> what opens it; a path has none."""
SCHEME = re.compile(r"([a-z][a-z0-9+.-]+)://", re.IGNORECASE)


def scheme_of(name: str) -> str:
    """Return the scheme of an address in lower case; empty for a path."""
    found = SCHEME.match(name)
    return found[1].lower() if found else ""


def opened(name: str, options: ReadOptions) -> LoopSource:
    """Open a source by its path or address."""
    return SOURCES[scheme_of(name)](name, options)

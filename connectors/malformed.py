"""Messages of a server's clients that cannot be read: counted, and logged when new."""

from __future__ import annotations

import logging

_LOG = logging.getLogger(__name__)
_MOST = 100
"""Lines in the log: clients can come from as many addresses as they like."""


class Malformed:
    """Counts over all sessions of a server."""

    def __init__(self, where: str) -> None:
        self.count = 0
        """Messages that could not be read."""
        self._where = where
        self._logged: set[tuple[str, str]] = set()

    def note(self, client: str, what: str) -> None:
        """Count a message; logged where ``client`` sends one of this kind for the first time."""
        self.count += 1
        if (client, what) not in self._logged and len(self._logged) < _MOST:
            self._logged.add((client, what))
            _LOG.warning("%s: %s %s", self._where, client, what)

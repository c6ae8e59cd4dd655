"""The source that was read last stays open: loops of one file come one after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

from connectors.sources.kinds import opened

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions
    from connectors.sources.source import LoopSource


class LastSource:
    """One source, open until another one is needed; a file is so read once, however many loops it has."""

    def __init__(self) -> None:
        """Begin with none."""
        self._key: tuple[str, ReadOptions, str] | None = None
        self._source: LoopSource | None = None

    def get(self, name: str, options: ReadOptions, version: str = "") -> LoopSource:
        """Return a source, open.

        Args:
            name: Its path or address.
            options: How it is read.
            version: Of its content, where that may have changed since: another one is read anew.

        Raises:
            ConfigError: No source has such an address, or it is not whole.
        """
        key = name, options, version
        if self._source is None or self._key != key:
            self.close()
            self._source, self._key = opened(name, options), key
        return self._source

    def close(self) -> None:
        """Let go of it; a second time does nothing."""
        if self._source is not None:
            self._source.close()
        self._source = self._key = None

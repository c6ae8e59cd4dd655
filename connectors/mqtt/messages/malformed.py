"""What a message cannot be read as, and what it can be."""

from __future__ import annotations

JsonTree = dict[str, "JsonTree"] | list["JsonTree"] | str | int | float | bool | None


class MalformedPayloadError(ValueError):
    """The payload is not what the configuration says."""


class MissingFieldError(MalformedPayloadError):
    """The payload has nothing at a path."""

"""A number with its noun, as sentences have it."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """Return ``1 valve`` or ``2 valves``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"

"""What a message says: a bare value, or fields of a JSON object. Nothing that a peer sends breaks it."""

from __future__ import annotations

import json
import math
from datetime import UTC, datetime

JsonTree = dict[str, "JsonTree"] | list["JsonTree"] | str | int | float | bool | None


LARGEST = 1_000_000
"""Bytes; no message with the values of some loops is larger, and reading one would hold up all the others."""


class MalformedPayloadError(ValueError):
    """The payload is not what the configuration says."""


def parse(payload: bytes) -> JsonTree:
    """Return the JSON value in a payload; raises MalformedError."""
    _not_too_large(payload)
    try:
        tree: JsonTree = json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise MalformedPayloadError("no JSON") from error
    return tree


def bare(payload: bytes) -> float | str:
    """Return the value that is the whole payload: a number, else the text itself; raises MalformedError."""
    _not_too_large(payload)
    try:
        text = payload.decode().strip()
    except UnicodeDecodeError as error:
        raise MalformedPayloadError("no text") from error
    return _number_if_any(text)


def field(tree: JsonTree, path: str) -> JsonTree:
    """Return what stands at a dotted path, e.g. ``loop.pv`` or ``values.0``; raises MalformedError."""
    if isinstance(tree, dict) and path in tree and "." not in path:
        return tree[path]
    for key in path.split("."):
        if isinstance(tree, dict) and key in tree:
            tree = tree[key]
        elif isinstance(tree, list) and key.isdecimal() and int(key) < len(tree):
            tree = tree[int(key)]
        else:
            raise MalformedPayloadError(f"no field {path}")
    return tree


def value(tree: JsonTree) -> float | str:
    """Return the number in a JSON value, else its text; null is NaN. Raises MalformedError."""
    if tree is None:
        return math.nan
    if isinstance(tree, str):
        return _number_if_any(tree)
    if isinstance(tree, int | float):
        return _float(tree)
    raise MalformedPayloadError("neither number nor text")


def number(tree: JsonTree) -> float:
    """Return a JSON number; raises MalformedError for all else, also for what ``value`` makes one of."""
    if isinstance(tree, bool) or not isinstance(tree, int | float):
        raise MalformedPayloadError("no number")
    return _float(tree)


def seconds(tree: JsonTree) -> float:
    """Return s since 1970 from a time given so or as ISO 8601, UTC without a zone; raises MalformedError."""
    if isinstance(tree, str):
        try:
            stamp = datetime.fromisoformat(tree)
            return stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp()
        except (ValueError, OverflowError) as error:
            raise MalformedPayloadError("no ISO 8601 time") from error
    if isinstance(tree, bool) or not isinstance(tree, int | float):
        raise MalformedPayloadError("no time")
    return _float(tree)


def _not_too_large(payload: bytes) -> None:
    if len(payload) > LARGEST:
        raise MalformedPayloadError(f"{len(payload)} bytes")


def _number_if_any(text: str) -> float | str:
    try:
        number = float(text)
    except ValueError:
        return text
    return _float(number)


def _float(number: float) -> float:
    try:
        finite = math.isfinite(number)
    except OverflowError as error:
        raise MalformedPayloadError("too large") from error
    if not finite:
        raise MalformedPayloadError("no finite number")  # JSON has none, but Python reads them
    return float(number)

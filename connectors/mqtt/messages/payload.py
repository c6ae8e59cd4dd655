"""What a message says: a bare value, or fields of a JSON object. Nothing that a peer sends breaks it."""

from __future__ import annotations

import json
import math
import re
from datetime import UTC, datetime

from connectors.mqtt.messages.line_protocol import objects_of_lines
from connectors.mqtt.messages.malformed import JsonTree, MalformedPayloadError, MissingFieldError

LARGEST = 1_000_000
"""Bytes; no message with the values of some loops is larger, and reading one would hold up all the others."""
UNITS = (1.0, 1e-3, 1e-6, 1e-9)
"""Units in which gateways count the time since 1970, s."""
LAST_TIME = 1e11
"""s since 1970. A number beyond it counts a smaller unit: as ms it is a time after 1973."""
_EPOCH = re.compile(r"\d{9,19}(\.\d+)?")
"""A time since 1970 as text; with eight digits it may be a date."""


def parse(payload: bytes) -> JsonTree:
    """Return the JSON value in a payload, or the objects of its line protocol; raises MalformedError."""
    _not_too_large(payload)
    try:
        tree: JsonTree = json.loads(payload)
    except (ValueError, RecursionError):
        return _of_lines(payload)
    return tree


def _of_lines(payload: bytes) -> JsonTree:
    try:
        return objects_of_lines(payload.decode())
    except (UnicodeDecodeError, MalformedPayloadError) as error:
        raise MalformedPayloadError("neither JSON nor line protocol") from error


def bare(payload: bytes) -> float | str:
    """Return the value that is the whole payload: a number, else the text itself; raises MalformedError."""
    _not_too_large(payload)
    try:
        text = payload.decode().strip()
    except UnicodeDecodeError as error:
        raise MalformedPayloadError("no text") from error
    return _number_if_any(text)


def field(tree: JsonTree, path: str) -> JsonTree:
    """Return what stands at a dotted path, e.g. ``loop.pv`` or ``values.0``; raises MalformedError.

    A key may have dots itself: ``FIC101.PV.Value`` finds ``{"FIC101.PV": {"Value": 4.2}}``.
    """
    if isinstance(tree, dict) and path in tree:
        return tree[path]
    keys = path.split(".")
    while keys:
        if isinstance(tree, dict):
            taken = next((n for n in range(1, 1 + len(keys)) if ".".join(keys[:n]) in tree), None)
            if taken is None:
                raise MissingFieldError(f"no field {path}")
            tree, keys = tree[".".join(keys[:taken])], keys[taken:]
        elif isinstance(tree, list) and keys[0].isdecimal() and int(keys[0]) < len(tree):
            tree, keys = tree[int(keys[0])], keys[1:]
        else:
            raise MissingFieldError(f"no field {path}")
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


def text_of(tree: JsonTree) -> str | None:
    """Return a scalar as JSON writes it, text without its quotes, 3.0 as 3; None for all else."""
    if isinstance(tree, bool):
        return str(tree).lower()
    if isinstance(tree, float) and tree.is_integer():
        return str(int(tree))
    return str(tree) if isinstance(tree, str | int | float) else None


def seconds(tree: JsonTree) -> float:
    """Return s since 1970; raises MalformedError.

    From a number of s, ms, us or ns since 1970, whichever gives a time that can be, or from ISO 8601, UTC
    without a zone.
    """
    if isinstance(tree, str):
        if _EPOCH.fullmatch(tree):
            return seconds(float(tree))
        try:
            stamp = datetime.fromisoformat(tree)
            return stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp()
        except (ValueError, OverflowError) as error:
            raise MalformedPayloadError("no ISO 8601 time") from error
    if isinstance(tree, bool) or not isinstance(tree, int | float):
        raise MalformedPayloadError("no time")
    counted = _float(tree)
    for unit in UNITS:
        if abs(counted * unit) < LAST_TIME:
            return counted * unit
    raise MalformedPayloadError("no time: too large")


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

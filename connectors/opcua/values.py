"""OPC UA data values as samples, and fields of an alarm as OPC UA values."""

from __future__ import annotations

import math
import time
from datetime import UTC, datetime

from asyncua import ua

from connectors.base import JsonValue, LoopRole, Quality, Sample
from connectors.opcua.notification import NodeValue

_INTEGERS = {
    ua.VariantType.SByte: (-(2**7), 2**7 - 1),
    ua.VariantType.Byte: (0, 2**8 - 1),
    ua.VariantType.Int16: (-(2**15), 2**15 - 1),
    ua.VariantType.UInt16: (0, 2**16 - 1),
    ua.VariantType.Int32: (-(2**31), 2**31 - 1),
    ua.VariantType.UInt32: (0, 2**32 - 1),
    ua.VariantType.Int64: (-(2**63), 2**63 - 1),
    ua.VariantType.UInt64: (0, 2**64 - 1),
}


def quality(status: ua.StatusCode) -> Quality:
    """Return the worth of a value from the two highest bits of its status (OPC UA Part 4, 7.39)."""
    if status.is_good():
        return Quality.GOOD
    return Quality.UNCERTAIN if status.is_uncertain() else Quality.BAD


def change_of(data: ua.DataValue) -> NodeValue:
    """Return what asyncua decoded as the other decoder gives it."""
    stamp = data.SourceTimestamp or data.ServerTimestamp
    time = stamp.replace(tzinfo=stamp.tzinfo or UTC).timestamp() if stamp else math.nan
    value = data.Value.Value if data.Value is not None else None
    return NodeValue(value, 0 if data.StatusCode is None else data.StatusCode.value, time)


def is_waiting(change: NodeValue) -> bool:
    """Return whether the server has had no value yet."""
    return bool(change.status == ua.StatusCodes.BadWaitingForInitialData)


def sample(tag: LoopRole, change: NodeValue) -> Sample:
    """Return the sample that a server sent for ``tag``.

    Its time is the source's; a server that has none gives its own, and one without a clock gets the time of
    arrival. Bad values are kept as they came, missing ones and those that are no scalar are NaN.
    """
    value, at = change.value, time.time() if math.isnan(change.time) else change.time
    status = ua.StatusCode(change.status)
    if not isinstance(value, int | float | str):
        return Sample.missing(tag, at, status.value, _no_value(value, status))
    return Sample.measured(
        tag, at, value if isinstance(value, str) else float(value), quality(status), status.value
    )


def _no_value(value: object, status: ua.StatusCode) -> str:
    if not status.is_good():
        return in_words(status)
    return "no value" if value is None else f"a {type(value).__name__} where a number belongs"


def in_words(status: ua.StatusCode) -> str:
    """Return the name of a status and what OPC UA says it means."""
    return f"{status.name}: {status.doc}"


def no_write(rights: ua.DataValue) -> str | None:
    """Return why a node cannot be written, from its UserAccessLevel; None where it can."""
    status = rights.StatusCode or ua.StatusCode()
    if not status.is_good():
        return in_words(status)
    level = rights.Value.Value if rights.Value is not None else None
    writable = isinstance(level, int) and level & (1 << ua.AccessLevel.CurrentWrite)
    return None if writable else "this user may not write it"


def variant(value: JsonValue, kind: ua.VariantType) -> ua.Variant | None:
    """Return a field of an alarm as a node of this type takes it; None where the type has no word for it."""
    if kind is ua.VariantType.String:
        return ua.Variant("" if value is None else str(value), kind)
    if isinstance(value, str):
        return None
    number = _number(math.nan if value is None else float(value), kind)
    return None if number is None else ua.Variant(number, kind)


def _number(value: float, kind: ua.VariantType) -> float | datetime | None:
    if kind in (ua.VariantType.Float, ua.VariantType.Double):
        return value
    if not math.isfinite(value):
        return None
    if kind is ua.VariantType.Boolean:
        return bool(value)
    if kind is ua.VariantType.DateTime:
        return datetime.fromtimestamp(value, UTC)
    if kind not in _INTEGERS:
        return None
    low, high = _INTEGERS[kind]
    return min(max(round(value), low), high)

"""A condition as the fields of its event, which are the variables of its instance as well.

Source: OPC 10000-9 1.05, tables of BaseEventType to OffNormalAlarmType; optional parts that slipjump has
nothing to say about (confirming, latching, sound, groups) are left out.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from datetime import UTC, datetime

from asyncua import ua

from connectors.base import JsonValue
from connectors.opcua_server.alarm.condition import Condition
from connectors.opcua_server.space.names import Names

Kind = ua.VariantType
NAME = "Stiction"
"""Of the condition: what kind of alarm it is, the same for each loop."""
_NEVER = datetime(1601, 1, 1, tzinfo=UTC)
"""How OPC UA writes a time that there is not, Part 6, 5.2.2.5."""
_BANDS = {"S": "s", "J": "j", "FS": "f_s", "FD": "f_d"}


def event_fields(
    names: Names, condition: Condition, published: Mapping[str, JsonValue], longest_shelving: float
) -> dict[str, ua.Variant]:
    """Return browse path -> value of all fields of a condition.

    Args:
        names: Node ids of the server.
        condition: As it is now.
        published: Fields of the newest publication of this loop; empty before the first.
        longest_shelving: s.
    """
    loop, now = condition.loop, datetime.now(UTC)
    at = now if condition.at is None else datetime.fromtimestamp(condition.at, UTC)
    known = condition.state is not None
    remaining = 0.0 if condition.until is None else max(condition.until - time.time(), 0.0)
    shelving = ua.ObjectIds.ShelvedStateMachineType_Unshelved
    if condition.shelved:
        shelving = ua.ObjectIds.ShelvedStateMachineType_TimedShelved
    quality = ua.StatusCodes.Good if known else ua.StatusCodes.BadWaitingForInitialData
    return {
        "EventId": ua.Variant(condition.event_id, Kind.ByteString),
        "EventType": ua.Variant(names.alarm_type, Kind.NodeId),
        "SourceNode": ua.Variant(names.loop(loop), Kind.NodeId),
        "SourceName": ua.Variant(loop, Kind.String),
        "Time": ua.Variant(at, Kind.DateTime),
        "ReceiveTime": ua.Variant(now, Kind.DateTime),
        "Message": _text(f"{loop}: {condition.message}" if known else ""),
        "Severity": ua.Variant(condition.severity, Kind.UInt16),
        "ConditionClassId": ua.Variant(ua.NodeId(ua.ObjectIds.MaintenanceConditionClassType), Kind.NodeId),
        "ConditionClassName": _text("MaintenanceConditionClassType"),
        "ConditionName": ua.Variant(NAME, Kind.String),
        "BranchId": ua.Variant(ua.NodeId(), Kind.NodeId),
        "Retain": ua.Variant(condition.retain, Kind.Boolean),
        **_two_states("EnabledState", ("Disabled", "Enabled"), holds=True),
        "Quality": ua.Variant(ua.StatusCode(quality), Kind.StatusCode),
        "Quality/SourceTimestamp": ua.Variant(at, Kind.DateTime),
        "LastSeverity": ua.Variant(condition.last_severity, Kind.UInt16),
        "LastSeverity/SourceTimestamp": ua.Variant(at, Kind.DateTime),
        "Comment": _text(condition.comment),
        "Comment/SourceTimestamp": _time(condition.comment_at),
        "ClientUserId": ua.Variant(condition.user, Kind.String),
        **_two_states("AckedState", ("Unacknowledged", "Acknowledged"), holds=condition.acked),
        "AckedState/TransitionTime": _time(condition.acked_since),
        **_two_states("ActiveState", ("Inactive", "Active"), holds=condition.active),
        "ActiveState/TransitionTime": _time(condition.active_since),
        "InputNode": ua.Variant(names.variable(loop, "Verdict"), Kind.NodeId),
        "NormalState": ua.Variant(ua.NodeId(), Kind.NodeId),
        **_two_states("SuppressedState", ("Unsuppressed", "Suppressed"), holds=False),
        **_two_states("OutOfServiceState", ("In Service", "Out of Service"), holds=condition.out_of_service),
        "ShelvingState/CurrentState": _text("Timed Shelved" if condition.shelved else "Unshelved"),
        "ShelvingState/CurrentState/Id": ua.Variant(ua.NodeId(shelving), Kind.NodeId),
        "ShelvingState/UnshelveTime": ua.Variant(1000 * remaining, Kind.Double),
        "SuppressedOrShelved": ua.Variant(condition.shelved or condition.out_of_service, Kind.Boolean),
        "MaxTimeShelved": ua.Variant(1000 * longest_shelving, Kind.Double),
        **{name: _band(published.get(key)) for name, key in _BANDS.items()},
        "Verdict": ua.Variant(str(published.get("verdict") or ""), Kind.String),
        "NE107": ua.Variant(str(published.get("ne107") or ""), Kind.String),
        "ActivationId": ua.Variant(condition.activation or "", Kind.String),
    }


OWN_FIELDS = {
    **dict.fromkeys(_BANDS, Kind.Double),
    **dict.fromkeys(("Verdict", "NE107", "ActivationId"), Kind.String),
}
"""What our type of alarm adds to OffNormalAlarmType."""


def _two_states(name: str, words: tuple[str, str], *, holds: bool) -> dict[str, ua.Variant]:
    return {name: _text(words[holds]), f"{name}/Id": ua.Variant(holds, Kind.Boolean)}


def _text(text: str) -> ua.Variant:
    return ua.Variant(ua.LocalizedText(text, "en"), Kind.LocalizedText)


def _time(at: float | None) -> ua.Variant:
    return ua.Variant(_NEVER if at is None else datetime.fromtimestamp(at, UTC), Kind.DateTime)


def _band(value: JsonValue) -> ua.Variant:
    return ua.Variant(float(value) if isinstance(value, int | float) else math.nan, Kind.Double)

"""What is published of a loop, as metrics; and the orders of a host that writes some of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic import ValidationError

from connectors.base import JsonValue, Order
from connectors.mqtt.orders import OrderMessage
from connectors.sparkplug.payload import DataType, MalformedMetricsError, Metric

REBIRTH = "Node Control/Rebirth"
"""Metric with which a host requests all births anew (Sparkplug 3.0.0, 6.4.19)."""
BD_SEQ = "bdSeq"
"""Metric that shows which death belongs to which birth."""

_FIELDS: Mapping[str, tuple[str, DataType]] = {
    "Alarm/Active": ("active", DataType.BOOLEAN),
    "Alarm/State": ("state", DataType.STRING),
    "Alarm/Id": ("id", DataType.STRING),
    "Alarm/Priority": ("priority", DataType.STRING),
    "Alarm/By": ("by", DataType.STRING),
    "Alarm/Until": ("until", DataType.DATE_TIME),
    "Diagnosis/Verdict": ("verdict", DataType.STRING),
    "Diagnosis/Probability": ("probability", DataType.DOUBLE),
    "Diagnosis/Advisory": ("advisory", DataType.STRING),
    "Diagnosis/No Response": ("no_response", DataType.STRING),
    "Stiction/S": ("s", DataType.DOUBLE),
    "Stiction/S Low": ("s_low", DataType.DOUBLE),
    "Stiction/S High": ("s_high", DataType.DOUBLE),
    "Stiction/S Identifiable": ("s_identifiable", DataType.BOOLEAN),
    "Stiction/J": ("j", DataType.DOUBLE),
    "Stiction/J Low": ("j_low", DataType.DOUBLE),
    "Stiction/J High": ("j_high", DataType.DOUBLE),
    "Stiction/J Identifiable": ("j_identifiable", DataType.BOOLEAN),
    "Stiction/f_S": ("f_s", DataType.DOUBLE),
    "Stiction/f_D": ("f_d", DataType.DOUBLE),
    "Health/NE 107": ("ne107", DataType.STRING),
    "Health/Code": ("health", DataType.INT32),
    "Message/Time": ("time", DataType.DATE_TIME),
    "Message/Id": ("message_id", DataType.STRING),
    "Message/Sequence": ("sequence", DataType.INT64),
    "Message/Schema": ("schema", DataType.INT32),
}
"""Name of a metric -> field of the payload and its type; docs/payload.md explains each field."""

OUT_OF_SERVICE = "Alarm/Out of Service"
"""The one metric that a host both reads and writes."""
METRICS: Mapping[str, DataType] = {
    **{name: kind for name, (_, kind) in _FIELDS.items()},
    OUT_OF_SERVICE: DataType.BOOLEAN,
}
"""What is published of a loop."""
ABOUT_THE_MESSAGE = frozenset(name for name in METRICS if name.startswith("Message/"))
"""Metrics that are news each time, though nothing may have changed."""
COMMANDS: Mapping[str, tuple[DataType, JsonValue]] = {
    "Alarm/Acknowledge": (DataType.BOOLEAN, False),
    "Alarm/Shelve Minutes": (DataType.DOUBLE, 0.0),
    "Alarm/Unshelve": (DataType.BOOLEAN, False),
    "Alarm/Operator": (DataType.STRING, ""),
}
"""Metrics that a host may only write, where orders are taken: type, and value while it writes nothing."""
NOBODY = "Sparkplug host"
"""Who decided, where the command does not name an operator."""


@dataclass(frozen=True, slots=True)
class Reported:
    """Value of a metric that the host knows, and its time."""

    value: JsonValue
    time: float
    """s UTC"""


def values_of(fields: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """Return the fields of a publication by names of metrics."""
    values = {name: fields.get(field) for name, (field, _) in _FIELDS.items()}
    state = fields.get("state")
    return {**values, OUT_OF_SERVICE: None if state is None else state == "out_of_service"}


def commands_at_rest(time: float) -> list[Metric]:
    """Return the metrics that a host may only write, as they stand while it writes none."""
    return [Metric(name, rest, kind, time) for name, (kind, rest) in COMMANDS.items()]


def orders(subject: str, metrics: tuple[Metric, ...], arrival: float) -> list[Order]:
    """Return the orders of a command that came at ``arrival``, s UTC; raises MalformedError.

    ``Alarm/Operator`` names the operator and ``Alarm/Id`` the activation, both for the whole command.
    """
    written = {metric.name: metric.value for metric in metrics}
    unknown = written.keys() - COMMANDS.keys() - {"Alarm/Id", OUT_OF_SERVICE}
    if unknown:
        raise MalformedMetricsError(f"nobody can write {', '.join(sorted(unknown))}")
    common = {"by": written.get("Alarm/Operator") or NOBODY, "alarm": written.get("Alarm/Id") or None}
    requested: list[dict[str, object]] = []
    if written.get("Alarm/Acknowledge"):
        requested.append({"action": "acknowledge"})
    if minutes := written.get("Alarm/Shelve Minutes"):
        requested.append({"action": "shelve", "minutes": minutes})
    if written.get("Alarm/Unshelve"):
        requested.append({"action": "unshelve"})
    if (out := written.get(OUT_OF_SERVICE)) is not None:
        requested.append({"action": "out_of_service" if out else "in_service"})
    try:
        messages = [OrderMessage.model_validate({**common, **each}) for each in requested]
    except ValidationError as error:
        raise MalformedMetricsError(error.errors(include_url=False)[0]["msg"]) from error
    return [message.order(subject, arrival) for message in messages]

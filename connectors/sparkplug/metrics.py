"""What is told of a loop, as metrics; and what a host asks by writing some of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from pydantic import ValidationError

from connectors.base import JsonValue, Order
from connectors.mqtt.orders import OrderMessage
from connectors.sparkplug.payload import DataType, MalformedError, Metric

REBIRTH = "Node Control/Rebirth"
"""Metric with which a host asks for all births anew (Sparkplug 3.0.0, 6.4.19)."""
BD_SEQ = "bdSeq"
"""Metric that tells which death belongs to which birth."""

METRICS: Mapping[str, tuple[str, DataType]] = {
    "Alarm/Active": ("active", DataType.BOOLEAN),
    "Alarm/State": ("state", DataType.STRING),
    "Alarm/Id": ("id", DataType.STRING),
    "Alarm/Priority": ("priority", DataType.STRING),
    "Alarm/By": ("by", DataType.STRING),
    "Alarm/Until": ("until", DataType.DATE_TIME),
    "Diagnosis/Verdict": ("verdict", DataType.STRING),
    "Diagnosis/Time": ("time", DataType.DATE_TIME),
    "Stiction/S": ("s", DataType.DOUBLE),
    "Stiction/J": ("j", DataType.DOUBLE),
    "Stiction/f_S": ("f_s", DataType.DOUBLE),
    "Stiction/f_D": ("f_d", DataType.DOUBLE),
    "Health/NE 107": ("ne107", DataType.STRING),
    "Health/Code": ("health", DataType.INT32),
    "Message/Id": ("message_id", DataType.STRING),
    "Message/Sequence": ("sequence", DataType.INT64),
    "Message/Schema": ("schema", DataType.INT32),
}
"""Name of a metric -> field of the payload and its type; docs/payload.md explains each field."""

COMMANDS: Mapping[str, DataType] = {
    "Alarm/Acknowledge": DataType.BOOLEAN,
    "Alarm/Shelve Minutes": DataType.DOUBLE,
    "Alarm/Unshelve": DataType.BOOLEAN,
    "Alarm/Out of Service": DataType.BOOLEAN,
    "Alarm/Operator": DataType.STRING,
}
"""Metrics that a host may write where orders are taken."""
NOBODY = "Sparkplug host"
"""Who decided, where the command does not name an operator."""


@dataclass(frozen=True, slots=True)
class Told:
    """A value and when it was told."""

    value: JsonValue
    time: float
    """s UTC"""


def values_of(fields: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """Return the fields of a publication by names of metrics."""
    return {name: fields.get(field) for name, (field, _) in METRICS.items()}


def commands_at_rest(values: Mapping[str, Told], time: float) -> Iterator[Metric]:
    """Yield the metrics that a host may write, as they stand while it writes none."""
    out = "Alarm/State" in values and values["Alarm/State"].value == "out_of_service"
    for name, kind in COMMANDS.items():
        rest: dict[str, JsonValue] = {
            "Alarm/Shelve Minutes": 0.0,
            "Alarm/Out of Service": out,
            "Alarm/Operator": "",
        }
        yield Metric(name, rest.get(name, False), kind, time)


def orders(subject: str, metrics: tuple[Metric, ...], arrival: float) -> list[Order]:
    """Return what a command asks that came at ``arrival``, s UTC; raises MalformedError.

    ``Alarm/Operator`` says who asks and ``Alarm/Id`` which activation is meant, both for all of the command.
    """
    written = {metric.name: metric.value for metric in metrics}
    unknown = written.keys() - COMMANDS.keys() - {"Alarm/Id"}
    if unknown:
        raise MalformedError(f"nobody can write {', '.join(sorted(unknown))}")
    common = {"by": written.get("Alarm/Operator") or NOBODY, "alarm": written.get("Alarm/Id") or None}
    asked: list[dict[str, object]] = []
    if written.get("Alarm/Acknowledge"):
        asked.append({"action": "acknowledge"})
    if minutes := written.get("Alarm/Shelve Minutes"):
        asked.append({"action": "shelve", "minutes": minutes})
    if written.get("Alarm/Unshelve"):
        asked.append({"action": "unshelve"})
    if (out := written.get("Alarm/Out of Service")) is not None:
        asked.append({"action": "out_of_service" if out else "in_service"})
    try:
        messages = [OrderMessage.model_validate({**common, **each}) for each in asked]
    except ValidationError as error:
        raise MalformedError(error.errors(include_url=False)[0]["msg"]) from error
    return [message.order(subject, arrival) for message in messages]

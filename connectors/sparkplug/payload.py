"""The payload of Sparkplug B: what is used of its protocol buffers, and metrics as values.

Source: Sparkplug 3.0.0, section 6.4; numbers of fields and types as in its ``sparkplug_b.proto``. The
messages are described here for Google's ``protobuf``, so that nothing generated has to fit its version.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import DecodeError
from google.protobuf.message_factory import GetMessageClass

from connectors.base import JsonValue

CONTENT = "application/x-protobuf"


class MalformedMetricsError(ValueError):
    """The payload is not what Sparkplug says."""


class DataType(IntEnum):
    """Types of metrics that are used here."""

    INT32 = 3
    INT64 = 4
    DOUBLE = 10
    BOOLEAN = 11
    STRING = 12
    DATE_TIME = 13
    """Given as s since 1970, sent as ms."""


@dataclass(frozen=True, slots=True)
class Metric:
    """One value with its name."""

    name: str
    value: JsonValue
    """None: not known."""
    type: DataType | None = None
    """None in a command whose sender leaves it out."""
    time: float | None = None
    """Of the value, s UTC."""
    historical: bool = False
    """Whether it is late, and a newer value may have been published before."""


@dataclass(frozen=True, slots=True)
class Payload:
    """What a message says."""

    metrics: tuple[Metric, ...]
    time: float | None = None
    """When it was sent, s UTC."""
    seq: int | None = None
    """Its place among the node's messages, 0 to 255; None in deaths and commands."""


_KINDS = FieldDescriptorProto
_PAYLOAD = (
    (1, "timestamp", _KINDS.TYPE_UINT64),
    (2, "metrics", _KINDS.TYPE_MESSAGE),
    (3, "seq", _KINDS.TYPE_UINT64),
)
_VALUES = (
    (10, "int_value", _KINDS.TYPE_UINT32),
    (11, "long_value", _KINDS.TYPE_UINT64),
    (12, "float_value", _KINDS.TYPE_FLOAT),
    (13, "double_value", _KINDS.TYPE_DOUBLE),
    (14, "boolean_value", _KINDS.TYPE_BOOL),
    (15, "string_value", _KINDS.TYPE_STRING),
)
_METRIC = (
    (1, "name", _KINDS.TYPE_STRING),
    (2, "alias", _KINDS.TYPE_UINT64),
    (3, "timestamp", _KINDS.TYPE_UINT64),
    (4, "datatype", _KINDS.TYPE_UINT32),
    (5, "is_historical", _KINDS.TYPE_BOOL),
    (7, "is_null", _KINDS.TYPE_BOOL),
)
_HELD_BY = {
    DataType.INT32: "int_value",
    DataType.INT64: "long_value",
    DataType.DOUBLE: "double_value",
    DataType.BOOLEAN: "boolean_value",
    DataType.STRING: "string_value",
    DataType.DATE_TIME: "long_value",
}
_BITS = {"int_value": 32, "long_value": 64}


def _described() -> Any:  # noqa: ANN401 - protobuf makes the class
    package = "org.eclipse.tahu.protobuf"
    file = FileDescriptorProto(name="sparkplug_b.proto", package=package, syntax="proto2")
    payload = file.message_type.add(name="Payload")
    metric = payload.nested_type.add(name="Metric")
    metric.oneof_decl.add(name="value")
    optional, repeated = _KINDS.LABEL_OPTIONAL, _KINDS.LABEL_REPEATED
    for number, name, kind in _PAYLOAD:
        field = payload.field.add(name=name, number=number, type=kind, label=optional)
        if kind == _KINDS.TYPE_MESSAGE:
            field.label, field.type_name = repeated, f".{package}.Payload.Metric"
    for number, name, kind in _METRIC:
        metric.field.add(name=name, number=number, type=kind, label=optional)
    for number, name, kind in _VALUES:
        metric.field.add(name=name, number=number, type=kind, label=optional, oneof_index=0)
    pool = DescriptorPool()  # of our own: another library may know the whole of sparkplug_b.proto
    pool.Add(file)
    return GetMessageClass(pool.FindMessageTypeByName(f"{package}.Payload"))


_Message = _described()


def encode(metrics: Sequence[Metric], time: float | None, seq: int | None = None) -> bytes:
    """Return the payload with these metrics; NaN and infinity are encoded as null."""
    message = _Message()
    if time is not None:
        message.timestamp = _milliseconds(time)
    if seq is not None:
        message.seq = seq
    for metric in metrics:
        _put(message.metrics.add(), metric)
    return bytes(message.SerializeToString())


def decode(raw: bytes) -> Payload:
    """Return what a payload says; raises MalformedError."""
    message = _Message()
    try:
        message.ParseFromString(raw)
    except DecodeError as error:
        raise MalformedMetricsError("no Sparkplug payload") from error
    return Payload(
        tuple(_metric(each) for each in message.metrics),
        message.timestamp / 1000 if message.HasField("timestamp") else None,
        message.seq if message.HasField("seq") else None,
    )


def _put(field: Any, metric: Metric) -> None:  # noqa: ANN401 - a message of protobuf
    field.name = metric.name
    if metric.type is None:
        raise ValueError(f"{metric.name} has no type")
    field.datatype = metric.type
    if metric.time is not None:
        field.timestamp = _milliseconds(metric.time)
    if metric.historical:
        field.is_historical = True
    value = metric.value
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        field.is_null = True
        return
    held = _HELD_BY[metric.type]
    if metric.type is DataType.DATE_TIME:
        value = _milliseconds(float(value))
    if held in _BITS:
        value = int(value) % (1 << _BITS[held])  # negative numbers go as their two's complement
    setattr(field, held, value)


def _metric(field: Any) -> Metric:  # noqa: ANN401 - a message of protobuf
    if not field.name:
        raise MalformedMetricsError("a metric has no name")
    held = field.WhichOneof("value")
    value = None if field.is_null or held is None else getattr(field, held)
    if isinstance(field.name, bytes) or (held == "string_value" and isinstance(value, bytes)):
        raise MalformedMetricsError("a text is not UTF-8")  # protobuf gives its bytes
    kind = _type(field.datatype)
    if kind is DataType.DATE_TIME and isinstance(value, int):
        value = value / 1000
    elif kind in {DataType.INT32, DataType.INT64} and isinstance(value, int) and held in _BITS:
        bits = _BITS[held]
        value = value - (1 << bits) if value >> (bits - 1) else value
    time = field.timestamp / 1000 if field.HasField("timestamp") else None
    return Metric(field.name, value, kind, time, field.is_historical)


def _type(number: int) -> DataType | None:
    return DataType(number) if number in list(DataType) else None


def _milliseconds(time: float) -> int:
    return round(1000 * time)

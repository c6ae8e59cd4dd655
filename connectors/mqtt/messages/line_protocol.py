"""InfluxDB's line protocol as the JSON that Telegraf writes of it, so that one kind of entry serves both.

Source: InfluxDB v2, "Line protocol": ``measurement,tag=a,tag=b field=1,field="text" time``.
"""

from __future__ import annotations

import re

from connectors.mqtt.messages.malformed import JsonTree, MalformedPayloadError

LONGEST = 20_000
"""Characters of a line: a device has some hundred fields, and what is none should not hold others up."""
_HEAD = re.compile(r"(?:\\.|[^\\ ])+")
"""Measurement and tags: a blank in them is escaped."""
_FIELDS = re.compile(r'(?:"(?:\\.|[^"\\])*"|\\.|[^\\ "])+')
"""A blank may also stand in a text between quotes."""
_PARTS = re.compile(r"(?:\\.|[^\\,])+")
_FIELD_PARTS = re.compile(r'(?:"(?:\\.|[^"\\])*"|\\.|[^\\,"])+')
_KEY = re.compile(r"((?:\\.|[^\\=])+)=(.+)", re.DOTALL)
_ESCAPED = re.compile(r'\\([,= "\\])')
_FLAGS = {
    each: each[0] in "tT" for each in ("t", "T", "true", "True", "TRUE", "f", "F", "false", "False", "FALSE")
}


def objects_of_lines(text: str) -> list[JsonTree]:
    """Return ``{"name", "tags", "fields", "timestamp"}`` of each line; raises MalformedError.

    The time is a number since 1970 in the unit of the sender; a line may have none.
    """
    lines = [each for each in text.splitlines() if each.strip() and not each.startswith("#")]
    if not lines or max(map(len, lines)) > LONGEST:
        raise MalformedPayloadError("no line protocol")
    return [_object(each.strip()) for each in lines]


def _object(line: str) -> JsonTree:
    head = _HEAD.match(line)
    fields = _FIELDS.match(line, head.end() + 1) if head is not None else None
    if head is None or fields is None or head[0].startswith(","):
        raise MalformedPayloadError("no line protocol")
    name, *tags = _PARTS.findall(head[0])
    found: dict[str, JsonTree] = {
        "name": _plain(name),
        "tags": dict(_pair(each) for each in tags),
        "fields": {key: _value(value) for key, value in map(_pair, _FIELD_PARTS.findall(fields[0]))},
    }
    time = line[fields.end() :].strip()
    if time:
        found["timestamp"] = _number(time)
    return found


def _pair(text: str) -> tuple[str, str]:
    cut = _KEY.fullmatch(text)
    if cut is None:
        raise MalformedPayloadError("no line protocol")
    return _plain(cut[1]), cut[2] if cut[2].startswith('"') else _plain(cut[2])


def _value(text: str) -> JsonTree:
    if text.startswith('"'):
        return _plain(text[1:-1])
    if text in _FLAGS:
        return _FLAGS[text]
    return _number(text[:-1] if text[-1] in "iu" else text)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise MalformedPayloadError("no line protocol") from error


def _plain(text: str) -> str:
    return _ESCAPED.sub(r"\1", text)

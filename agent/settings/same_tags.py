"""Loops whose OP is read from where their PV is read: a slip of the pen that looks like a perfect valve."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from agent.settings.models import LoopSettings, Settings

ENCODING = {
    "type", "order", "scale", "offset", "time_field", "size", "quality_field", "good", "absent",
}  # fmt: skip
"""Keys of a tag that say how a value is read, not where."""


def same_tags(settings: Settings) -> dict[str, str]:
    """Return loop -> which two of its roles are read from one place, in words."""
    found = {}
    for loop in settings.loops:
        words = _same(loop)
        if words is not None:
            found[loop.name] = words
    return found


def _same(loop: LoopSettings) -> str | None:
    pv, op = loop.tags.get("pv"), loop.tags.get("op")
    if pv is None or op is None:
        return None
    first, second = (each.model_dump() | {"size": getattr(each, "size", 1)} for each in (pv, op))
    if place_of(first) == place_of(second):
        return f"PV and OP are the same tag ({_words(first)})"
    if "address" in first and "address" in second and _overlap(first, second):
        return f"PV and OP share a register ({_words(first)} and {_words(second)})"
    return None


def place_of(tag: Mapping[str, Any]) -> dict[str, Any]:
    """Return where a tag is read, in one spelling: node ids without ``ns=0;`` and spaces, topics alike."""
    place = {key: value for key, value in tag.items() if key not in ENCODING and value is not None}
    for key, value in place.items():
        if isinstance(value, str):
            place[key] = "".join(value.split()).removeprefix("ns=0;").strip("/")
    return place


def _overlap(first: Mapping[str, Any], second: Mapping[str, Any]) -> bool:
    if first.get("table") != second.get("table"):
        return False
    low, high = sorted((first, second), key=lambda each: int(each["address"]))
    return bool(low["address"] + low["size"] > high["address"])


def _words(tag: Mapping[str, Any]) -> str:
    keys = ("table", "address", "node", "topic", "entry", "field")
    shown = {key: tag[key] for key in keys if tag.get(key) is not None} | (tag.get("where") or {})
    return " ".join(str(value) for value in (shown or place_of(tag)).values())

"""Validates a part of the user's configuration and reports in plain words what is wrong with it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from pydantic import TypeAdapter, ValidationError

T = TypeVar("T")


def checked(model: type[T], raw: object, path: str, faults: list[str]) -> T | None:
    """Return the model, or None after adding its faults, each with its place below ``path``."""
    try:
        return TypeAdapter(model).validate_python(raw)
    except ValidationError as error:
        for fault in error.errors(include_url=False):
            place = ".".join([*filter(None, [path]), *(str(part) for part in fault["loc"])])
            message = _message(fault["type"], fault["msg"])
            if fault["type"] == "string_pattern_mismatch":
                message = _spelling(model, fault["loc"], fault["input"])
            faults.append(": ".join([*filter(None, [place]), message]))
        return None


def _spelling(model: object, keys: Sequence[int | str], value: object) -> str:
    """Return what is wrong with a text in the words of its setting, never by a regular expression."""
    field = None
    for key in keys:
        fields = getattr(model, "model_fields", {})
        if key not in fields:
            field = None
            break
        field = fields[key]
        model = field.annotation
    words = [f"{str(value)!r} cannot be used here"]
    if field is not None and field.description:
        words.append(f"expected: {' '.join(field.description.split()).rstrip('.')}")
    if field is not None and field.examples:
        words.append(f"for example {field.examples[0]}")
    return ", ".join(words)


def _message(kind: str, message: str) -> str:
    match kind:
        case "extra_forbidden":
            return "unknown key"
        case "missing":
            return "is missing"
        case "value_error":
            return message.removeprefix("Value error, ")
        case _:
            return message[0].lower() + message[1:]

"""Validates a part of the user's configuration and reports in plain words what is wrong with it."""

from __future__ import annotations

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
            faults.append(": ".join([*filter(None, [place]), _message(fault["type"], fault["msg"])]))
        return None


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

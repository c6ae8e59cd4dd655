"""YAML files checked against a pydantic model, every fault told at once with its path."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import yaml
from pydantic import BaseModel, ValidationError

from connectors.base import ConfigError

if TYPE_CHECKING:
    from pathlib import Path

ModelT = TypeVar("ModelT", bound=BaseModel)


def read_yaml(path: Path, model: type[ModelT]) -> ModelT:
    """Read ``path`` as a ``model``.

    Raises:
        ConfigError: unreadable, no YAML, or not as the model wants it; all faults, one a line.
    """
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not UTF-8 text"
        raise ConfigError([f"{path}: {reason}"]) from error
    except yaml.YAMLError as error:
        mark = error.problem_mark if isinstance(error, yaml.MarkedYAMLError) else None
        where = f"{path}:{mark.line + 1}" if mark else f"{path}"
        raise ConfigError([f"{where}: not YAML: {getattr(error, 'problem', error)}"]) from error
    try:
        return model.model_validate({} if document is None else document)
    except ValidationError as error:
        raise ConfigError([f"{path}: {fault}" for fault in faults(error)]) from error


def faults(error: ValidationError) -> list[str]:
    """One line a fault, ``where.it.is: what is wrong``."""
    return [_line(".".join(map(str, fault["loc"])), fault["msg"]) for fault in error.errors()]


def _line(where: str, message: str) -> str:
    what = message.removeprefix("Value error, ")
    return f"{where}: {what}" if where else what

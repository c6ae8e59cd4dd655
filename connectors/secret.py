"""Passwords: never in the configuration file, never in a log."""

from __future__ import annotations

import os
from pathlib import Path

from pydantic import model_validator

from connectors.base import AccessDeniedError
from connectors.options import Options


def located(path: str) -> Path:
    """Return a path with its environment variables filled in, e.g. systemd's ``$CREDENTIALS_DIRECTORY``."""
    return Path(os.path.expandvars(path))


def content(option: str, path: str) -> bytes:
    """Return what the file holds that ``option`` names; raises AccessDeniedError with option and path."""
    try:
        return located(path).read_bytes()
    except OSError as error:
        raise AccessDeniedError(f"{option}: {path} cannot be read: {error.strerror}") from error


class Secret(Options):
    """Where a password is: in an environment variable or in a file. It is read anew for each connection."""

    env: str | None = None
    """Environment variable that holds it."""
    file: str | None = None
    """File that holds it, e.g. `$CREDENTIALS_DIRECTORY/NAME` of systemd; the line end does not count."""

    @model_validator(mode="before")
    @classmethod
    def _not_in_the_open(cls, value: object) -> object:
        if not isinstance(value, dict | Secret):
            # the value itself must not be printed: this message goes to screens and logs
            raise ValueError("a secret does not belong in this file: write {env: NAME} or {file: PATH}")  # noqa: TRY004
        return value

    @model_validator(mode="after")
    def _one_place(self) -> Secret:
        if (self.env is None) == (self.file is None):
            raise ValueError("expected one of {env: NAME} and {file: PATH}")
        return self

    def read(self, option: str) -> str:
        """Return the password of ``option``; raises AccessDeniedError where there is none."""
        if self.file is not None:
            try:
                return content(option, self.file).decode().rstrip("\r\n")
            except UnicodeDecodeError:
                raise AccessDeniedError(f"{option}: {self.file} holds no text") from None
        value = os.environ.get(str(self.env))
        if value is None:
            raise AccessDeniedError(f"{option}: the environment variable {self.env} is not set")
        return value

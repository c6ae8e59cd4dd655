"""The address of a historian or database: parted and checked; credentials stand elsewhere."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import parse_qsl, unquote, urlsplit

from connectors.base import AccessDeniedError, ConfigError
from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from connectors.secret import Secret

USER, PASSWORD, TOKEN = "SLIPJUMP_USER", "SLIPJUMP_PASSWORD", "SLIPJUMP_TOKEN"
"""Environment variables; with ``_FILE`` behind them they name a file."""


@dataclass(frozen=True, slots=True)
class Address:
    """An address without secrets."""

    name: str
    """As the user wrote it."""
    transport: str
    """``http`` or ``https`` of ``pi+https://``; the whole scheme where there is no ``+``."""
    host: str
    """With its port."""
    path: str
    """Begins with a slash, or is empty."""
    parameters: dict[str, str]
    user: str | None = None

    def base(self) -> str:
        """Return the address without parameters, as the transport takes it."""
        return f"{self.transport}://{self.host}{self.path}".rstrip("/")


def parted(name: str, known: Collection[str], required: Collection[str] = ()) -> Address:
    """Return an address in parts.

    Args:
        name: As the user wrote it.
        known: Parameters behind the question mark that it may have.
        required: Those that it must have.

    Raises:
        RecordingError: It cannot be understood, or holds a password; the text does not repeat it.
    """
    try:
        parts = urlsplit(name)
        host, password = parts.hostname, parts.password
        _ = parts.port
    except ValueError as error:
        raise RecordingError(f"{without_password(name)}: is no address: {error}") from error
    shown = without_password(name)
    if password is not None:
        where = f"the environment variable {PASSWORD}, or a file that {PASSWORD}_FILE names"
        raise RecordingError(f"{shown}: a password does not belong in an address: put it in {where}")
    if not host:
        raise RecordingError(f"{shown}: expected a host, as in {parts.scheme}://host/...")
    parameters = dict(parse_qsl(parts.query, keep_blank_values=True))
    wrong = [f"unknown parameter {each!r}" for each in parameters if each not in known]
    wrong += [f"parameter {each!r} is missing" for each in required if not parameters.get(each)]
    if wrong:
        raise RecordingError(f"{shown}: {', '.join(wrong)}; it takes {', '.join(sorted(known))}")
    user = None if parts.username is None else unquote(parts.username)
    return Address(
        name, parts.scheme.rpartition("+")[2], parts.netloc.rpartition("@")[2], parts.path, parameters, user
    )


def without_password(name: str) -> str:
    """Return an address that may be shown."""
    scheme, mark, rest = name.partition("://")
    before, at, after = rest.rpartition("@")
    user, colon, _ = before.partition(":")
    return f"{scheme}{mark}{user}{':***' * bool(colon)}{at}{after}"


def credential(variable: str) -> str | None:
    """Return what an environment variable, or the file that it names with ``_FILE``, holds; None: neither.

    Raises:
        ConfigError: The file cannot be read.
    """
    path = os.environ.get(f"{variable}_FILE")
    if path is None:
        return os.environ.get(variable)
    try:
        return _secret(file=path).read(f"{variable}_FILE")
    except AccessDeniedError as error:
        raise ConfigError([str(error)]) from error


def login_of(address: Address) -> tuple[str, str] | None:
    """Return user and password; None where neither is given.

    Raises:
        ConfigError: One of them is missing.
    """
    user, password = address.user or credential(USER), credential(PASSWORD)
    if user is None and password is None:
        return None
    if user is None or password is None:
        lacking = USER if user is None else PASSWORD
        raise ConfigError([f"{address.name}: expected {lacking} in the environment"])
    return user, password


def password_place() -> Secret:
    """Return where the password is."""
    path = os.environ.get(f"{PASSWORD}_FILE")
    return _secret(env=PASSWORD) if path is None else _secret(file=path)


def _secret(**where: str) -> Secret:
    from connectors.secret import Secret  # pydantic takes 0.2 s to import, and a file needs no password

    return Secret(**where)

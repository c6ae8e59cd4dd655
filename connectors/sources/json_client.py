"""JSON over HTTP for sources: bounded answers, few repetitions, credentials only where nobody can listen."""

from __future__ import annotations

import json
import ssl
import time
from collections.abc import Mapping
from ipaddress import ip_address
from typing import Any

import httpx

from connectors.base import ConfigError
from connectors.sources.address import PASSWORD, TOKEN, USER, Address, credential, login_of

ATTEMPTS = 4
"""Of a request whose answer says that it may go well later."""
PAUSE = 0.5
"""Before the second attempt, s; doubled for each further one."""
AGAIN = {429, 500, 502, 503, 504}
"""Answers after which a request is repeated."""
TIMEOUT = 60.0
"""For the next bytes of an answer, s."""
MOST_BYTES = 64 << 20
"""Of one answer."""
DENIED = {401, 403}


class JsonClient:
    """A connection to one server. Follows no redirection and takes no proxy from the environment."""

    def __init__(self, address: Address) -> None:
        """Make it; nothing is connected yet.

        Raises:
            ConfigError: Credentials would go over the network in the open, or are not whole.
        """
        self._name = address.name
        token, login = credential(TOKEN), login_of(address)
        if (token or login) and address.transport != "https" and not _is_loopback(address.host):
            raise ConfigError([f"{address.name}: credentials are sent over https only"])
        self._client = httpx.Client(
            base_url=f"{address.base()}/",
            auth=None if token or login is None else httpx.BasicAuth(*login),
            headers={"Authorization": f"Bearer {token}"} if token else {},
            verify=ssl.create_default_context(),
            timeout=TIMEOUT,
            trust_env=False,
            follow_redirects=False,
        )

    def get(self, path: str, parameters: Mapping[str, str | int]) -> Any:  # noqa: ANN401 - JSON
        """Return the JSON at a path below the address; raises ConfigError."""
        return self._answer("GET", path, params=dict(parameters))

    def post(self, path: str, content: object) -> Any:  # noqa: ANN401 - JSON
        """Send JSON and return JSON; raises ConfigError."""
        return self._answer("POST", path, json=content)

    def close(self) -> None:
        """Close the connection."""
        self._client.close()

    def _answer(self, method: str, path: str, **content: Any) -> Any:  # noqa: ANN401 - JSON
        fault = ""
        for attempt in range(ATTEMPTS):
            if attempt:
                time.sleep(PAUSE * 2 ** (attempt - 1))
            try:
                with self._client.stream(method, path, **content) as answer:
                    text = self._text(answer)
            except httpx.TransportError as error:
                fault = f"{type(error).__name__}: {error}".rstrip(": ")
                continue
            if answer.status_code in AGAIN:
                fault = _said(answer.status_code, text)
                continue
            if answer.status_code in DENIED:
                hint = f"{USER} and {PASSWORD}, or {TOKEN}, in the environment"
                raise ConfigError([f"{self._name}: access denied ({answer.status_code}): set {hint}"])
            if not answer.is_success:
                raise ConfigError([f"{self._name}: {path}: {_said(answer.status_code, text)}"])
            try:
                return json.loads(text)
            except ValueError as error:
                raise ConfigError([f"{self._name}: {path}: expected JSON, found {text[:60]!r}"]) from error
        raise ConfigError([f"{self._name}: {path}: {fault}, {ATTEMPTS} times"])

    def _text(self, answer: httpx.Response) -> bytes:
        content = bytearray()
        for piece in answer.iter_bytes():
            content += piece
            if len(content) > MOST_BYTES:
                raise ConfigError([f"{self._name}: an answer has more than {MOST_BYTES >> 20} MiB"])
        return bytes(content)


def _said(status: int, text: bytes) -> str:
    """Return what a server said about a request that went wrong, in one line."""
    words = " ".join(text[:200].decode("utf-8", "replace").split())
    return f"HTTP {status} {words}".rstrip()


def _is_loopback(host: str) -> bool:
    name = host.rsplit(":", 1)[0].strip("[]") if host.count(":") == 1 or host.startswith("[") else host
    try:
        return name == "localhost" or ip_address(name).is_loopback
    except ValueError:
        return False

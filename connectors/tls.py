"""TLS as MQTT and Modbus use it: whom to trust, who we are, and in plain words why it failed."""

from __future__ import annotations

import asyncio
import contextlib
import ssl

from pydantic import model_validator

from connectors.base import AccessDeniedError
from connectors.options import Options
from connectors.secret import Secret, content, located

_OURS = ("CERTIFICATE", "UNKNOWN_CA", "DECRYPT_ERROR", "ACCESS_DENIED")
"""Words in the reason of an alert with which a server turns a client's certificate down (RFC 8446, 6.2)."""

_CLOSED = (
    "it ends the encrypted connection at once, which mostly means that it does not accept this client's "
    "certificate; check tls.certificate and tls.key"
)


class Tls(Options):
    """An encrypted connection. The server's certificate must be valid for the `host` of the connection."""

    ca: str | None = None
    """File (PEM) with the authorities that may have signed the server's certificate. None: the system's."""
    certificate: str | None = None
    """File (PEM) with this client's certificate, for servers that require one."""
    key: str | None = None
    """File (PEM) with its private key. None: it is in the certificate's file."""
    key_password: Secret | None = None
    """Of the private key, where it is encrypted."""

    @model_validator(mode="after")
    def _key_needs_certificate(self) -> Tls:
        if self.certificate is None and (self.key is not None or self.key_password is not None):
            raise ValueError("a key needs its certificate")
        return self

    def context(self) -> ssl.SSLContext:
        """Read the files and return how to connect; raises AccessDeniedError for those that are no good."""
        ca = None if self.ca is None else content("tls.ca", self.ca)
        try:
            context = ssl.create_default_context(cadata=None if ca is None else ca.decode())
        except (ssl.SSLError, UnicodeDecodeError) as error:
            raise AccessDeniedError(f"tls.ca: {self.ca} holds no certificates in PEM") from error
        if self.certificate is not None:
            self._identify(context, self.certificate)
        return context

    def _identify(self, context: ssl.SSLContext, certificate: str) -> None:
        files = {"tls.certificate": certificate} | ({} if self.key is None else {"tls.key": self.key})
        for option, path in files.items():
            content(option, path)  # names the one that is missing, which ssl does not
        password = "" if self.key_password is None else self.key_password.read("tls.key_password")
        key = None if self.key is None else located(self.key)
        try:
            # without a password of some kind OpenSSL would prompt for one on the terminal
            context.load_cert_chain(located(certificate), key, password)
        except ssl.SSLError as error:
            raise AccessDeniedError(
                f"tls: {' and '.join(files.values())} are no certificate and key that belong together, "
                "or tls.key_password is wrong"
            ) from error


def refusal(error: BaseException | None, host: str) -> str | None:
    """Return what a failed handshake with ``host`` means and what to do; None if TLS is not to blame."""
    if isinstance(error, ssl.SSLCertVerificationError):
        return (
            f"its certificate is not accepted: {error.verify_message}; "
            f"check tls.ca, and that the certificate is for {host}"
        )
    if not isinstance(error, ssl.SSLError):
        return None
    reason = error.reason or str(error)
    if "ALERT" in reason and any(word in reason for word in _OURS):
        return f"it does not accept this client's certificate ({reason}); check tls.certificate and tls.key"
    return f"TLS fails ({reason}); is this the port that speaks TLS?"


async def explain(host: str, port: int, tls: ssl.SSLContext, timeout: float) -> str | None:  # noqa: ASYNC109
    """Connect to hear why a library could not, as libraries keep that to themselves.

    With TLS 1.3 a server turns a client's certificate down only after the handshake, so wait for its word.
    """
    writer = None
    try:
        async with asyncio.timeout(timeout):
            reader, writer = await asyncio.open_connection(host, port, ssl=tls)
            if not await reader.read(1):
                return _CLOSED
    except (ConnectionResetError, BrokenPipeError):
        return None if writer is None else _CLOSED
    except OSError as error:
        return refusal(error, host)
    finally:
        if writer is not None:
            writer.transport.abort()  # a polite end of TLS waits for the peer, which may be gone
            with contextlib.suppress(OSError):
                await writer.wait_closed()
    return None

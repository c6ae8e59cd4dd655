"""The part of the configuration file for a Modbus server of our own."""

from __future__ import annotations

import ssl
from typing import Annotated, Self

from pydantic import Field, IPvAnyNetwork, model_validator

from connectors.base import AccessDeniedError
from connectors.modbus.codec import Order as ByteOrder
from connectors.options import Options, Port, Seconds, Target, is_loopback
from connectors.secret import Secret, content, located


class ServerTls(Options):
    """Modbus/TCP Security: encrypted, and only clients with a certificate that the authority has signed."""

    certificate: str
    """File (PEM) with this server's certificate."""
    key: str
    """File (PEM) with its private key."""
    key_password: Secret | None = None
    """Of the private key, where it is encrypted."""
    ca: str
    """File (PEM) with the authorities that may have signed a client's certificate."""

    def context(self) -> ssl.SSLContext:
        """Read the files; raises AccessDeniedError for those that are no good."""
        ca = content("tls.ca", self.ca)
        for option, path in {"tls.certificate": self.certificate, "tls.key": self.key}.items():
            content(option, path)  # names the one that is missing, which ssl does not
        password = "" if self.key_password is None else self.key_password.read("tls.key_password")
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.minimum_version = ssl.TLSVersion.TLSv1_2
        context.verify_mode = ssl.CERT_REQUIRED
        try:
            context.load_verify_locations(cadata=ca.decode())
        except (ssl.SSLError, UnicodeDecodeError) as error:
            raise AccessDeniedError(f"tls.ca: {self.ca} holds no certificates in PEM") from error
        try:
            # without a password of some kind OpenSSL would prompt for one on the terminal
            context.load_cert_chain(located(self.certificate), located(self.key), password)
        except ssl.SSLError as error:
            raise AccessDeniedError(
                f"tls: {self.certificate} and {self.key} are no certificate and key that belong together, "
                "or tls.key_password is wrong"
            ) from error
        return context


class ModbusServerOptions(Options):
    """A Modbus TCP server of our own, which control systems and panels read."""

    host: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Address that it listens on. Others than loopback need `tls`, `allow`, or `unprotected`."""
    port: Port = 502
    """Those below 1024 need a right that systemd can give."""
    unit: Annotated[int, Field(ge=0, le=255)] | None = None
    """Unit identifier that it answers to. None: any."""
    order: ByteOrder = "ABCD"
    """Order of the bytes of numbers of 32 bit, A the most significant."""
    orders: bool = False
    """Whether clients may acknowledge, shelve and so on by writing. Without `tls` nobody has a name."""
    tls: ServerTls | None = None
    """How the connection is encrypted. None: it is not."""
    allow: tuple[IPvAnyNetwork, ...] = ()
    """Addresses or networks that may connect, e.g. 192.168.10.0/24. Empty: all that reach it."""
    unprotected: bool = False
    """Listen to other machines without `tls` and `allow` all the same."""
    clients: Annotated[int, Field(ge=1, le=1000)] = 50
    """Most connections at a time."""
    idle: Seconds = 300.0
    """Silence after which a client is dropped, s."""

    def as_guest(self) -> Self:
        """Return them with a port that is free, as an agent may listen on the other."""
        return self.model_copy(update={"port": 0})

    @model_validator(mode="after")
    def _safe(self) -> ModbusServerOptions:
        if not (self.tls or self.allow or self.unprotected or is_loopback(self.host)):
            raise ValueError(
                f"{self.host} is open to other machines: expected tls, allow, or unprotected: true"
            )
        return self


class ModbusServerTarget(Target):
    """A loop that is shown on the server; its place is that among all loops that are shown there."""

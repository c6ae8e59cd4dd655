"""The part of the configuration file for an OPC UA server of our own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from connectors.options import Options, Port, Seconds, Target, is_loopback
from connectors.secret import Secret


class ServerSecurity(Options):
    """Messages signed and encrypted (Basic256Sha256), and only clients whose certificate is known."""

    certificate: str
    """File (PEM or DER) with this server's certificate. Its application URI is sent."""
    key: str
    """File (PEM or DER) with its private key."""
    key_password: Secret | None = None
    """Of the private key, where it is encrypted."""
    clients: tuple[str, ...] = ()
    """Files (PEM or DER) with the certificates of clients that may connect."""
    ca: str | None = None
    """File (PEM) with the authorities that may have signed a client's certificate."""
    sign_only: bool = False
    """Offer signed messages that are not encrypted as well."""

    @model_validator(mode="after")
    def _a_way_to_know_clients(self) -> ServerSecurity:
        if not self.clients and self.ca is None:
            raise ValueError("expected clients or ca: who may connect?")
        return self


class ServerUser(Options):
    """Somebody who logs in by name."""

    password: Secret
    may: Literal["read", "order"] = "order"
    """Order: also acknowledge, shelve and take out of service."""


class OpcUaServerOptions(Options):
    """An OPC UA server of our own, which control systems and operators connect to."""

    host: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Address that it listens on. Only loopback addresses need no security."""
    port: Port = 4840
    security: ServerSecurity | None = None
    """How messages are protected. None: not at all."""
    unprotected: bool = False
    """Listen to other machines without security all the same."""
    anonymous: Literal["refused", "read", "order"] = "read"
    """What clients may do that do not log in; order: also acknowledge, shelve and take out of service."""
    users: Mapping[Annotated[str, Field(min_length=1)], ServerUser] = {}
    """Name -> who may log in."""
    clients: Annotated[int, Field(ge=1, le=1000)] = 50
    """Most connections at a time."""
    longest_shelving: Seconds = 604_800.0
    """Longest time for which a client may shelve an alarm, s."""

    def as_guest(self) -> Self:
        """Return them with a port that is free, as an agent may listen on the other."""
        return self.model_copy(update={"port": 0})

    @model_validator(mode="after")
    def _safe(self) -> OpcUaServerOptions:
        if self.security is None and not (self.unprotected or is_loopback(self.host)):
            raise ValueError(
                f"{self.host} is open to other machines: expected security, or unprotected: true"
            )
        if self.security is not None and self.unprotected:
            raise ValueError("unprotected contradicts security")
        if self.users and self.security is None:
            raise ValueError("users need security: without, everybody can read their passwords")
        if self.anonymous == "refused" and not self.users:
            raise ValueError("nobody may connect: expected users, or anonymous: read")
        return self


class OpcUaServerTarget(Target):
    """A loop that is shown on the server."""

    unit: Annotated[str, Field(min_length=1, max_length=40)] | None = None
    """Unit of OP, shown as that of S, J, FS and FD, e.g. ``%``. None: not shown."""

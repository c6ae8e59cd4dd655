"""The OPC UA part of the configuration file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, model_validator

from connectors.options import Options, Seconds, Target
from connectors.secret import Secret

NodeId = Annotated[str, Field(pattern=r"^(ns=\d+;)?[isgb]=.+$", examples=["ns=2;s=FIC101.PV"])]


class Security(Options):
    """Messages signed and encrypted (SignAndEncrypt), between two who know each other's certificate.

    The server must know the client's certificate; the server's is known by `server_certificate` or `ca`.
    """

    policy: Literal["Basic256Sha256", "Aes128Sha256RsaOaep", "Aes256Sha256RsaPss"] = "Basic256Sha256"
    certificate: str
    """File (PEM or DER) with this client's certificate. Its application URI is sent."""
    key: str
    """File (PEM or DER) with its private key."""
    key_password: Secret | None = None
    """Of the private key, where it is encrypted."""
    server_certificate: str | None = None
    """File (PEM or DER) with the one certificate that the server may show."""
    ca: str | None = None
    """File (PEM) with the authorities that may have signed the server's, which must name the url's host."""

    @model_validator(mode="after")
    def _one_way_to_know_the_server(self) -> Security:
        if (self.server_certificate is None) == (self.ca is None):
            raise ValueError("expected one of server_certificate and ca: who may the server be?")
        return self


class Login(Options):
    """Who uses the server: a user with a password, or one with a certificate."""

    user: Annotated[str, Field(min_length=1)] | None = None
    password: Secret | None = None
    """Of the user."""
    certificate: str | None = None
    """File (PEM or DER) with the user's certificate."""
    key: str | None = None
    """File (PEM or DER) with its private key."""
    key_password: Secret | None = None
    """Of the private key, where it is encrypted."""

    @model_validator(mode="after")
    def _one_way(self) -> Login:
        way = {name for name in type(self).model_fields if getattr(self, name) is not None}
        if way not in ({"user", "password"}, {"certificate", "key"}, {"certificate", "key", "key_password"}):
            raise ValueError("expected user and password, or certificate and key")
        return self


class OpcUaOptions(Options):
    """One OPC UA server."""

    url: Annotated[
        str,
        Field(
            pattern=r"^opc\.tcp://(\[[0-9a-fA-F:]+\]|[^/:@\s]+)(:\d{1,5})?(/\S*)?$",
            examples=["opc.tcp://127.0.0.1:4840"],
        ),
    ]
    security: Security | None = None
    """How messages are protected. None: not at all."""
    login: Login | None = None
    """Who uses the server. None: anonymous."""
    publishing_interval: Seconds = 0.5
    """Time between two notifications of the server, s."""
    sampling_interval: Annotated[float, Field(ge=0, allow_inf_nan=False)] = 0.0
    """How often the server looks at a node, s; 0: as often as it can."""
    queue: Annotated[int, Field(ge=1, le=10_000)] = 100
    """Values the server keeps for a node between two notifications."""
    keep_alive: Annotated[int, Field(ge=1, le=1000)] = 10
    """Publishing intervals without a change after which the server must say that it is alive."""
    timeout: Seconds = 4.0
    """Longest wait for an answer, s; after that the server counts as gone."""
    retry: Seconds = 2.0
    """How often a node that was not found is tried again, and one that is silent is read, s."""

    @model_validator(mode="after")
    def _no_password_in_the_open(self) -> OpcUaOptions:
        if self.login is not None and self.security is None:
            raise ValueError("login needs security: without, nobody knows who gets the password")
        return self


class OpcUaTag(Options):
    """A node, to be read or written."""

    node: NodeId


def short_tag(text: str) -> dict[str, str]:
    """Return a node id as an entry of ``tags``."""
    return {"node": text}


class OpcUaTarget(Target):
    """Where a loop's alarm is written; events are not, as a node keeps only the newest."""

    active: OpcUaTag | None = None
    """Node that is true while the alarm is active."""
    fields: Mapping[str, OpcUaTag] = {}
    """Field of the alarm -> node, which gets it in its own type.

    Not known is NaN, or empty text; a node of another type keeps what it had.
    """

"""Settings of the daemon's HTTP server and history. Field docstrings go into ``config/schema.json``."""

from __future__ import annotations

import ipaddress
from typing import Annotated

from pydantic import Field, field_validator, model_validator

from connectors.options import Options, Port
from connectors.secret import Secret


class HttpSettings(Options):
    """HTTP server of the page and of /health, /live and /metrics."""

    host: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Address on which it listens. A `token` is required if other machines can reach it."""
    port: Port = 9187
    token: Secret | None = None
    """Token that a client must send: `Authorization: Bearer TOKEN`; /live needs none."""
    configure: bool = False
    """Whether the page may change this file: loops and connections, whose options name files and secrets."""

    @model_validator(mode="after")
    def _token_beyond_loopback(self) -> HttpSettings:
        if self.token is None and not self.is_loopback:
            raise ValueError(f"expected a token, since other machines can reach host {self.host}")
        return self

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach it."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


class SampleSettings(Options):
    """Raw samples, as they came: a row a loop and minute, in the database for ever."""

    max_mb: Annotated[float, Field(ge=1, allow_inf_nan=False)] = 1000.0
    """Size of the file in which they wait, MB; beyond it the oldest are dropped, and the gap is marked."""


class HistoryDatabase(Options):
    """PostgreSQL or TimescaleDB: gets every entry of the history, and keeps it for ever."""

    url: Annotated[
        str,
        Field(
            pattern=r"^postgresql://([^:/@\s]+@)?[^:/@\s]+(:\d{1,5})?/[^/?#\s]+$",
            examples=["postgresql://slipjump@db.plant.example/history"],
        ),
    ]
    """With user and database, without a password."""
    password: Secret | None = None
    """None: none is needed, or libpq finds it (PGPASSWORD, PGPASSFILE)."""
    samples: SampleSettings | None = None
    """Whether raw samples are kept as well; None: they are not."""
    tls: bool = True
    """Whether the server must speak TLS; False: it need not, on this machine or a network of its own."""

    @field_validator("url", mode="before")
    @classmethod
    def _without_password(cls, value: object) -> object:
        if ":" in str(value).partition("://")[2].rpartition("@")[0]:
            # the value itself must not be printed: this message goes to screens and logs
            raise ValueError("a password does not belong in an address: write password: {env: NAME}")
        return value


class HistorySettings(Options):
    """How many diagnoses and alarms are kept; the oldest are deleted first."""

    days: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 90.0
    max_mb: Annotated[float, Field(ge=1, allow_inf_nan=False)] = 500.0
    """Size of the file, MB."""
    windows: bool = True
    """Whether the values of a window are kept where the valve sticks or is suspected, or has an alarm."""
    database: HistoryDatabase | None = None
    """Where entries are kept beyond this file, which then is the store for outages. None: nowhere."""

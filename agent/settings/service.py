"""What the daemon tells of itself and remembers. Docstrings of fields go into ``config/schema.json``."""

from __future__ import annotations

import ipaddress
from typing import Annotated

from pydantic import Field, model_validator

from connectors.options import Options, Port
from connectors.secret import Secret


class HttpSettings(Options):
    """A small HTTP server for monitoring: /health, /live and /metrics."""

    host: Annotated[str, Field(min_length=1)] = "127.0.0.1"
    """Address it listens on. Beyond this machine a `token` is needed."""
    port: Port = 9187
    token: Secret | None = None
    """What a client must show: `Authorization: Bearer TOKEN`; /live is told without."""

    @model_validator(mode="after")
    def _token_beyond_loopback(self) -> HttpSettings:
        if self.token is None and not self.is_loopback:
            raise ValueError(f"host {self.host} can be reached from other machines, so it needs a token")
        return self

    @property
    def is_loopback(self) -> bool:
        """Whether only this machine can reach it."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


class HistorySettings(Options):
    """How much of diagnoses and alarms is remembered; the oldest goes first."""

    days: Annotated[float, Field(gt=0, allow_inf_nan=False)] = 90.0
    max_mb: Annotated[float, Field(ge=1, allow_inf_nan=False)] = 500.0
    """Size of the file, MB."""

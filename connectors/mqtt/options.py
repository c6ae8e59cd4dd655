"""The MQTT part of the configuration file."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from connectors.options import Options, Port, Seconds, Target
from connectors.secret import Secret
from connectors.tls import Tls

Topic = Annotated[str, Field(min_length=1, max_length=65_000, pattern=r"^[^+#\x00]+$")]
"""One topic, no wildcards."""
Path = Annotated[str, Field(min_length=1)]
"""Keys of nested JSON objects, or positions in a list, with dots between."""


class MqttOptions(Options):
    """One MQTT broker."""

    host: str = "127.0.0.1"
    port: Port = 1883
    version: Literal["3.1.1", "5"] = "3.1.1"
    """Version of the protocol."""
    tls: Tls | None = None
    """How the connection is encrypted; brokers mostly have port 8883 for that. None: it is not."""
    user: Annotated[str, Field(min_length=1)] | None = None
    """Name to log in with. None: anonymous, or by the certificate of `tls`."""
    password: Secret | None = None
    """Of the user."""
    keepalive: Annotated[int, Field(ge=1, le=65535)] = 10
    """Silence after which the broker is asked whether it is there, s; after as long again it is gone."""
    timeout: Seconds = 5.0
    """Longest wait for an answer, s."""
    queue: Annotated[int, Field(ge=1)] = 10_000
    """Messages that may wait to be read; more are dropped, with a warning."""

    @model_validator(mode="after")
    def _password_needs_user(self) -> MqttOptions:
        if self.password is not None and self.user is None:
            raise ValueError("a password needs its user")
        return self


class MqttTag(Options):
    """Where a value is found: the whole payload of a topic, or a field of its JSON object."""

    topic: Topic
    field: Path | None = None
    """Where the value is in a JSON payload. None: the payload is the value."""
    time_field: Path | None = None
    """Where the source time is, in s since 1970 or ISO 8601 (without zone: UTC). None: time of arrival."""

    @model_validator(mode="after")
    def _time_needs_json(self) -> MqttTag:
        if self.time_field is not None and self.field is None:
            raise ValueError("time_field needs field: only a JSON payload carries both")
        return self


def short_tag(text: str) -> dict[str, str]:
    """Return ``topic`` or ``topic#field``, e.g. ``plant/FIC101#pv``, as an entry of ``tags``."""
    topic, mark, field = text.partition("#")
    return {"topic": topic, "field": field} if mark else {"topic": topic}


class MqttTarget(Target):
    """Where a loop's alarm is published: its state retained on the topic, events on topic + ``/event``."""

    topic: Topic = "slipjump/{loop}/alarm"
    """``{loop}`` stands for the loop's name."""

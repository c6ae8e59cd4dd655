"""The MQTT part of the configuration file."""

from __future__ import annotations

from collections.abc import Mapping
from string import Formatter
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from connectors.options import Options, Port, Seconds, Target
from connectors.secret import Secret
from connectors.tls import Tls

Topic = Annotated[str, Field(min_length=1, max_length=65_000, pattern=r"^[^+#\x00]+$")]
"""One topic, no wildcards."""
Level = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^[^+#/$\s\x00][^+#/\s\x00]*$")]
"""One level of a topic."""
Word = Annotated[str, Field(min_length=1, max_length=1000, pattern=r"^[^+#\x00]+$")]
"""Part of a topic, with slashes or without."""


def _told_apart(template: str) -> str:
    for _, name, how, conversion in Formatter().parse(template):
        if name is not None and (how or conversion or not name.isidentifier()):
            raise ValueError("a variable is a name in braces, like {site}")
    return template


Template = Annotated[Topic, AfterValidator(_told_apart)]
"""A topic with variables in braces."""
Path = Annotated[str, Field(min_length=1)]
"""Keys of nested JSON objects, or positions in a list, with dots between."""


class Broker(Options):
    """One MQTT broker and how to reach it."""

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
    """Silence after which the broker is pinged, s; after as long again it is gone."""
    timeout: Seconds = 4.0
    """Longest wait for an answer, s."""
    queue: Annotated[int, Field(ge=1)] = 10_000
    """Messages that may wait to be read, or 5 for each topic if that is more; others are dropped, with a
    warning."""

    @model_validator(mode="after")
    def _password_needs_user(self) -> Self:
        if self.password is not None and self.user is None:
            raise ValueError("a password needs its user")
        return self


class MqttOptions(Broker):
    """An MQTT broker, and the topics published there."""

    client: Level | None = None
    """Who this is on the broker: its client identifier, and `{client}` in topics; no two may have the same.
    None: the computer's and the connection's name, and an identifier by chance."""
    topic: Template = "slipjump/{loop}/alarm"
    """Topic of the alarm of a loop, if its target names no other. `{loop}` and the names of `variables`
    stand for their values."""
    variables: Mapping[str, Word] = {}
    """Name -> what stands for `{name}` in topics; those of a loop come first."""
    status: Template | None = "slipjump/{client}/status"
    """Topic of its retained status; its will says offline if the connection breaks. None: no status."""
    orders: bool = False
    """Whether people may acknowledge, shelve and so on by a message to `order_topic`."""
    order_topic: Template = "{topic}/order"
    """Where their messages are taken. `{topic}` stands for the topic of the alarm."""

    def as_guest(self) -> Self:
        """Return the options of somebody who only looks: says no status and takes nobody's name."""
        return self.model_copy(update={"client": None, "status": None, "orders": False})


class MqttTag(Options):
    """Where a value is found: the whole payload of a topic, a field of its JSON object, or of its entries."""

    topic: Topic
    field: Path | None = None
    """Where the value is in a JSON payload, or in an entry. None: the payload is the value."""
    time_field: Path | None = None
    """Where the source time is, beside the value or in the message: s, ms, us or ns since 1970, or ISO 8601
    (without zone: UTC). None: time of arrival."""
    quality_field: Path | None = None
    """Where the quality is, beside the value: a word, true or false, a code of OPC. A value whose quality is
    bad is a gap; one without a quality is good. None: all are good."""
    good: tuple[str | int | float, ...] = ()
    """Qualities that are good, and no others: `[0]` where 0 means good. Empty: recognised."""
    entry: Path | None = None
    """Where the tag's entry, or the list of entries, is in the message; `.`: the message is the list. A
    message without the entry says nothing of the tag."""
    where: Mapping[Path, str | int | float | bool] = {}
    """Path in an entry -> what stands there in those of this tag, as `{id: Plant.FIC101.PV}`."""
    absent: Literal["gap", "unchanged"] = "gap"
    """What a message without `field` means: a missing value, or none new, where only changes are sent."""

    @model_validator(mode="after")
    def _needs_json(self) -> MqttTag:
        if self.field is None:
            for name in ("time_field", "quality_field", "entry", "where"):
                if getattr(self, name):
                    raise ValueError(f"{name} needs field: only a JSON payload carries both")
        if self.good and self.quality_field is None:
            raise ValueError("good needs quality_field, where the quality is")
        return self

    @property
    def in_entries(self) -> bool:
        """Whether the value is in an entry, not in the message as a whole."""
        return self.entry is not None or bool(self.where)


def short_tag(text: str) -> dict[str, str]:
    """Return ``topic`` or ``topic#field``, e.g. ``plant/FIC101#pv``, as an entry of ``tags``."""
    topic, mark, field = text.partition("#")
    return {"topic": topic, "field": field} if mark else {"topic": topic}


class MqttTarget(Target):
    """Where a loop's alarm is published: its state retained on the topic, events on topic + ``/event``."""

    topic: Template | None = None
    """`{loop}` and the names of `variables` stand for their values. None: the connection's `topic`."""

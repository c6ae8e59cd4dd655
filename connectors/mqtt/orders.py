"""Orders of operators as messages, e.g. ``{"action": "acknowledge", "by": "jane"}``; no message breaks it."""

from __future__ import annotations

import logging
from collections import OrderedDict
from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import Field, ValidationError, field_validator, model_validator

from connectors.base import Action, Order
from connectors.mqtt.messages.payload import seconds
from connectors.options import Options

_LOG = logging.getLogger(__name__)
LONGEST = 10_000
"""Bytes; a message beyond is no order."""
REMEMBERED = 1000
"""Ids of orders that are known when they come again."""
Words = Annotated[str, Field(min_length=1, max_length=200, pattern=r"^[^\x00-\x1f\x7f]+$")]


class OrderMessage(Options):
    """The payload of an order."""

    action: Action
    by: Words
    """Who decides."""
    until: float | str | None = None
    """End of shelving, s since 1970 or ISO 8601 (without zone: UTC)."""
    minutes: Annotated[float, Field(gt=0, le=527_040)] | None = None
    """How long it is shelved; instead of `until`."""
    alarm: Words | None = None
    """`id` of the activation that is meant. None: whichever stands."""
    id: Words | None = None
    """Of this order: one that comes again with the same id is not obeyed twice."""

    @field_validator("until")
    @classmethod
    def _time(cls, value: float | str | None) -> float | str | None:
        if value is not None:
            seconds(value)
        return value

    @model_validator(mode="after")
    def _ends(self) -> Self:
        given = [name for name in ("until", "minutes") if getattr(self, name) is not None]
        if self.action == "shelve" and len(given) != 1:
            raise ValueError("shelve needs one of until and minutes")
        if self.action != "shelve" and given:
            raise ValueError(f"{self.action} has no {' and no '.join(given)}")
        return self

    def order(self, subject: str, arrival: float) -> Order:
        """Return the order for a subject if this came at ``arrival``, s UTC."""
        until = None if self.until is None else seconds(self.until)
        if self.minutes is not None:
            until = arrival + 60 * self.minutes
        return Order(subject, self.action, self.by, until, self.alarm)


class OrderReader:
    """Messages become orders; what is none, comes again or was kept by the broker is counted."""

    def __init__(self, topics: Mapping[str, str]) -> None:
        """Make it for ``topics``: topic -> loop."""
        self.topics = topics
        self.malformed = 0
        """Messages that are no order."""
        self.retained = 0
        """Messages that the broker had kept: nobody knows whether they are still meant."""
        self.repeated = 0
        """Orders that came before."""
        self._obeyed: OrderedDict[tuple[str, str], None] = OrderedDict()

    def order(self, topic: str, payload: bytes, arrival: float, *, retained: bool) -> Order | None:
        """Return the order of a message that came at ``arrival``, s UTC; None where it is skipped."""
        if not payload:
            return None  # that only takes a kept message back
        if retained:
            self.retained += 1
            if self.retained == 1:
                _LOG.warning("topic %s: a retained order is not obeyed: it may be of any age", topic)
            return None
        try:
            if len(payload) > LONGEST:
                raise ValueError(f"it is longer than {LONGEST} bytes")  # noqa: TRY301 - reported as all others are
            message = OrderMessage.model_validate_json(payload)
        except ValueError as error:
            self.malformed += 1
            if self.malformed == 1:
                _LOG.warning("topic %s: a message is no order: %s", topic, _first(error))
            return None
        loop = self.topics[topic]
        if self._comes_again(loop, message.id):
            self.repeated += 1
            return None
        return message.order(loop, arrival)

    def _comes_again(self, loop: str, number: str | None) -> bool:
        if number is None:
            return False
        known = (loop, number) in self._obeyed
        self._obeyed[loop, number] = None
        if len(self._obeyed) > REMEMBERED:
            self._obeyed.popitem(last=False)
        return known


def _first(error: ValueError) -> str:
    if not isinstance(error, ValidationError):
        return str(error)
    fault = error.errors(include_url=False, include_input=False)[0]
    place = ".".join(str(part) for part in fault["loc"])
    return f"{place}: {fault['msg']}" if place else fault["msg"]

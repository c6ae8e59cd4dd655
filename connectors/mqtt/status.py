"""Birth and last will: whether this is online, kept by the broker for who comes late."""

from __future__ import annotations

import json
from typing import Literal

from connectors.mqtt.client import Outgoing

SCHEMA = 1
"""Version of the fields below; docs/payload.md explains each."""


def status(
    topic: str, client: str, word: Literal["online", "offline"], session: float, time: float | None
) -> Outgoing:
    """Return the message.

    Args:
        topic: Where it is published.
        client: Who is meant.
        word: How it is.
        session: When the connection began, s UTC. A last will carries that of the birth it belongs to.
        time: When this was said, s UTC; None in a last will, which the broker says some time.
    """
    fields = {"schema": SCHEMA, "client": client, "status": word, "session": session, "time": time}
    return Outgoing(topic, json.dumps(fields).encode(), retain=True, schema=str(SCHEMA))

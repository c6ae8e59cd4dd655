"""Follows the alarms of slipjump on an MQTT broker and prints each once. Needs paho-mqtt 2 only.

    python consumer.py --host 192.168.10.40 --topic 'slipjump/+/alarm'

It shows what a consumer should do:

* subscribe to the state and to its events with QoS 1, under a name of its own and without a clean session, so
  that the broker keeps events for it while it is away;
* acknowledge a message only after it was dealt with, so that a crash loses none;
* drop what it knows by ``message_id``, as the same message may come twice;
* look at ``schema``, and leave aside fields that it does not know;
* distrust a state whose sender is offline.
"""
# ruff: noqa: INP001 - a script beside the docs, no package

from __future__ import annotations

import argparse
import json
import sys
from collections import OrderedDict
from datetime import UTC, datetime
from typing import Any

import paho.mqtt.client as mqtt

SCHEMAS = (1, 2)
REMEMBERED = 10_000


class Consumer:
    """Knows what it has seen. Keep ``seen`` in a file where a restart must not repeat anything either."""

    def __init__(self) -> None:
        self.seen: OrderedDict[str, None] = OrderedDict()

    def take(self, topic: str, payload: bytes, *, retained: bool) -> str | None:
        """Return what to print; None for what is known already.

        What changes comes as an event; a state only says how it is for who comes late.
        """
        try:
            fields = json.loads(payload)
        except ValueError:
            return f"{topic}: no JSON"
        if not isinstance(fields, dict) or fields.get("schema") not in SCHEMAS:
            return f"{topic}: this reads schemas {SCHEMAS} only"
        if "status" in fields:
            return f"{fields['client']} is {fields['status']}"
        wanted = topic.endswith("/event") or retained
        return self._alarm(fields) if wanted and self._is_new(fields["message_id"]) else None

    def _is_new(self, message_id: str) -> bool:
        if message_id in self.seen:
            return False
        self.seen[message_id] = None
        if len(self.seen) > REMEMBERED:
            self.seen.popitem(last=False)
        return True

    @staticmethod
    def _alarm(fields: dict[str, Any]) -> str:
        at = datetime.fromtimestamp(fields["time"], UTC)
        words = [f"{at:%Y-%m-%d %H:%M:%S} {fields['loop']} {fields['state']}"]
        if fields["by"] is not None:
            words.append(f"by {fields['by']}")
        if fields["s"] is not None:
            words.append(f"S {fields['s']:.3g}, J {fields['j']:.3g}")
        if fields["historical"]:
            words.append("told late")
        return ", ".join(words)


def main() -> None:
    """Connect and follow until interrupted."""
    parser = argparse.ArgumentParser(description="Print the alarms of slipjump.")
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=1883)
    parser.add_argument("--topic", default="slipjump/+/alarm", help="of the alarms, + for any level")
    parser.add_argument("--status", default="slipjump/+/status")
    parser.add_argument("--name", default="slipjump-consumer", help="client identifier, no two the same")
    options = parser.parse_args()
    consumer = Consumer()

    def on_connect(client: mqtt.Client, *_: object) -> None:
        # Each time: the broker may have forgotten us.
        topics = (options.topic, f"{options.topic}/event", options.status)
        client.subscribe([(topic, 1) for topic in topics])

    def on_message(client: mqtt.Client, _: object, message: mqtt.MQTTMessage) -> None:
        told = consumer.take(message.topic, message.payload, retained=message.retain)
        if told is not None:
            sys.stdout.write(told + "\n")
            sys.stdout.flush()
        client.ack(message.mid, message.qos)

    client = mqtt.Client(
        mqtt.CallbackAPIVersion.VERSION2, client_id=options.name, clean_session=False, manual_ack=True
    )
    client.on_connect, client.on_message = on_connect, on_message
    client.connect(options.host, options.port)
    client.loop_forever(retry_first_connection=True)


if __name__ == "__main__":
    main()

"""Plants on MQTT: one JSON message a row to a broker, alarms back on the topics of the agent."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Self

from aiomqtt import Client, MqttError

from simulators.plant import Row
from simulators.servers.loop_server import Entry, loop_entry

AT_LEAST_ONCE = 1


class MqttServer:
    """Publishes to a broker that runs already: ``plant/LOOP`` gets ``{"t": 0.0, "pv": 1.0, "op": 2.0, ...}``.

    Messages are retained, so that a reader that comes late starts with the newest row.
    """

    name = "mqtt"
    lead = 100

    def __init__(self, loops: Mapping[str, Sequence[str]], host: str = "127.0.0.1", port: int = 1883) -> None:
        """Prepare to publish ``loops``, each with its roles, to the broker at ``host`` and ``port``."""
        self._roles = loops
        self._host = host
        self.port = port
        self._client: Client

    async def __aenter__(self) -> Self:
        """Connect; raises OSError."""
        self._client = Client(self._host, self.port)
        try:
            await self._client.__aenter__()
        except MqttError as error:
            raise OSError(f"no MQTT broker answers at {self._host}:{self.port}: {error}") from error
        return self

    async def __aexit__(self, *_: object) -> None:
        """Take the newest rows back and disconnect."""
        with contextlib.suppress(MqttError):  # a broker that is gone keeps nothing
            for loop in self._roles:
                await self._client.publish(f"plant/{loop}", b"", qos=AT_LEAST_ONCE, retain=True)
            await self._client.__aexit__(None, None, None)

    async def put(self, loop: str, row: Row) -> None:
        """Publish this row; NaN becomes null."""
        payload: dict[str, float | str | None] = {"t": row.time}
        for role in self._roles[loop]:
            value = row.values[role]
            payload[role] = None if not isinstance(value, str) and math.isnan(value) else value
        await self._client.publish(f"plant/{loop}", json.dumps(payload), qos=AT_LEAST_ONCE, retain=True)

    def connection_settings(self) -> Entry:
        """Return the entry of ``connections``."""
        return {"kind": "mqtt", "host": self._host, "port": self.port}

    def loop_settings(self, loop: str, ts: float) -> Entry:
        """Return the entry of ``loops``."""
        tags = {
            role: {"topic": f"plant/{loop}", "field": role, "time_field": "t"} for role in self._roles[loop]
        }
        return loop_entry(self.name, loop, ts, tags, {"topic": "slipjump/{loop}/alarm"})

    async def watch_alarms(self) -> AsyncIterator[tuple[str, bool]]:
        """Yield (loop, active) from the alarm topics, with a client of its own."""
        loops = {f"slipjump/{loop}/alarm": loop for loop in self._roles}
        async with Client(self._host, self.port) as client:
            await client.subscribe([(topic, AT_LEAST_ONCE) for topic in loops])
            async for message in client.messages:
                if message.topic.value not in loops:
                    continue  # amqtt was seen to send what nobody subscribed to
                yield loops[message.topic.value], bool(json.loads(bytes(message.payload))["active"])

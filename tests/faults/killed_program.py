"""A loop whose alarm comes and goes as fast as it can, told to a peer. To be killed at any moment.

    python -m tests.faults.killed_program STORE PEER work|drain

It waits while another one has the store, as an agent on standby does.

PEER is a file, or the port of an MQTT broker on this machine.

Window k ends at k seconds; odd ones show stiction, so each window is one event. ``drain``: tells what waits.
"""

import asyncio
import json
import os
import sys
from contextlib import asynccontextmanager
from pathlib import Path

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.analysis.routine import Routine
from agent.runtime.link.connection import Connection
from agent.runtime.link.outbox import Outbox
from agent.runtime.loop.due import Judging
from agent.runtime.loop.pipeline import LoopPipeline
from agent.runtime.loop.workers import InlineExecutor
from agent.runtime.store.journal import Journal
from agent.runtime.store.lock import only_agent_of
from agent.runtime.supervisor import keep_alive
from connectors.base import ConnectionLostError
from connectors.mqtt.connector import MqttConnector
from connectors.mqtt.options import MqttOptions, MqttTarget
from connectors.options import LoopTags
from tests.unit.alarms.test_alarm import diagnosis
from tests.unit.runtime.loops import cut_of, loop_settings


class FilePeer:
    """Takes a publication by a line in a file; loses the connection now and then after it took one."""

    name = "peer"

    def __init__(self, path):
        self.file = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
        self.taken = 0

    @asynccontextmanager
    async def session(self):
        yield self

    async def publish(self, publication):
        os.write(self.file, json.dumps([publication.kind, dict(publication.fields)]).encode() + b"\n")
        self.taken += 1
        await asyncio.sleep(0)
        if self.taken % 7 == 0:
            raise ConnectionLostError("reset before the answer came")


def newest_window(alarm):
    """Number of the last window that the alarm knows of."""
    if alarm.id is None:
        return 0
    return int(float(alarm.id.rpartition("/")[2])) + (not alarm.state.active)


def peer_at(place):
    """The file of this path, or the broker at this port."""
    if not place.isdecimal():
        return FilePeer(place)
    options = MqttOptions(port=int(place), timeout=1.0, keepalive=1)
    return MqttConnector("peer", options, {"FIC101": LoopTags({}, [MqttTarget(connection="peer")])})


async def main(store, peer, task):
    journal = Journal(store)
    outbox = Outbox("peer", journal, limit=100_000)  # it is faster than any valve
    pipeline = LoopPipeline(
        loop_settings(quantify="always"),
        InlineExecutor(),
        [outbox],
        journal=journal,
    )
    kept = await journal.open()
    outbox.restore({number: each.publication for number, each in kept.waiting.items()})
    pipeline.resume(kept.alarms.get("FIC101"))
    connection = Connection(peer_at(peer), outbox, None, outbox.interrupt, 60.0)
    telling = asyncio.create_task(keep_alive(connection.attempt, connection.health, uniform=lambda *_: 0.0))
    sys.stdout.write("ready\n")
    sys.stdout.flush()
    while task == "work":
        end = float(newest_window(pipeline.alarm) + 1)
        cut = cut_of(LoopWindow("FIC101", end - 1.0, 1.0, np.zeros(2), np.zeros(2)))
        found = diagnosis("stiction" if end % 2 else "no_stiction")
        pipeline._judging = Judging(cut, 0.0)
        await pipeline._decide(Routine(found, fitted=True))
    while len(outbox) and not telling.done():
        await asyncio.wait({telling}, timeout=0.01)
    telling.cancel()
    await asyncio.wait({telling})
    await journal.close()
    sys.stdout.write(f"{newest_window(pipeline.alarm)}\n")


if __name__ == "__main__":
    with only_agent_of(Path(sys.argv[1]), wait=True):
        asyncio.run(main(Path(sys.argv[1]), sys.argv[2], sys.argv[3]))

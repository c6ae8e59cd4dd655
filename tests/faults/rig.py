"""The agent, a plant on a real bus, a fault proxy between them, and a consumer of the alarms beside it."""

import asyncio
import contextlib
import itertools
import json
import sys
import time
from contextlib import asynccontextmanager
from dataclasses import replace

import numpy as np
from aiomqtt import Client, MqttError

from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AlarmSettings, ConnectionSettings, WindowSettings, settings_of
from agent.settings.load import connectors_of
from connectors.base import LoopRole, Sample
from connectors.checks.proxy import FaultProxy
from connectors.options import Options
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer
from tests.conftest import ROOT
from tests.faults.peer import LOOPS, TS, TURN, truth
from tests.unit.alarms.test_alarm import diagnosis
from tests.unit.runtime.loops import loop_settings

SERVERS = {"modbus": ModbusServer, "opcua": OpcUaServer, "mqtt": MqttServer}
DEADLINE = 40.0
"""s; for a machine that has much else to do. The bench asks for 5."""
WINDOW = {"window": {"seconds": 20 * TS, "hop": 0.25}, "alarm": {"on_delay": 1, "off_delay": 1}}
SWITCH = 0.7
"""Time after which the truth of the valve changes, s: an event of the alarm about as often."""
PERSISTENT = (
    "user root",
    "allow_anonymous true",
    "persistence true",
    "autosave_interval 1",
    "autosave_on_changes true",
    "max_queued_messages 0",
)


async def until(condition, within=DEADLINE):
    """Wait for a condition, or fail."""
    async with asyncio.timeout(within):
        while not condition():  # noqa: ASYNC110 - what is waited for happens elsewhere
            await asyncio.sleep(0.01)


class Peer:
    """The plant in its process; on mqtt mosquitto is before it, and is what gets killed."""

    def __init__(self, bus, mosquitto, folder):
        self.bus = bus
        self.port = 0
        self.offset = 0.0
        self._mosquitto = mosquitto
        self._folder = folder
        self._broker = None
        self._plant = None

    async def start(self):
        """Start what does not run; return when it listens."""
        if self.bus == "mqtt":
            await self._start_broker()
        if self._plant is None:
            self._plant = await asyncio.create_subprocess_exec(
                sys.executable, "-m", "tests.faults.peer", self.bus, str(self.port),
                cwd=ROOT, stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.DEVNULL,
            )  # fmt: skip
            self.port = int(await asyncio.wait_for(self._plant.stdout.readline(), DEADLINE))

    async def kill(self):
        """SIGKILL."""
        process, name = (self._broker, "_broker") if self.bus == "mqtt" else (self._plant, "_plant")
        setattr(self, name, None)
        if process is not None:
            process.kill()
            await process.wait()

    async def order(self, line):
        """Have the plant obey."""
        self._plant.stdin.write(f"{line}\n".encode())
        while (await asyncio.wait_for(self._plant.stdout.readline(), DEADLINE)) not in (b"done\n", b""):
            pass  # it tells its port again after each time that the broker was away
        if line.startswith("clock"):
            self.offset += float(line.split()[1])

    async def stop(self):
        """End all processes."""
        for process in (self._plant, self._broker):
            if process is not None:
                process.kill()
                await process.wait()
                if process.stdin is not None:
                    process.stdin.close()

    async def _start_broker(self):
        if self._broker is not None:
            return
        if self.port == 0:
            server = await asyncio.start_server(lambda *_: None, "127.0.0.1", 0)
            self.port = server.sockets[0].getsockname()[1]
            server.close()
        config = self._folder / "mosquitto.conf"
        lines = [f"listener {self.port} 127.0.0.1", f"persistence_location {self._folder}/", *PERSISTENT, ""]
        config.write_text("\n".join(lines))
        self._broker = await asyncio.create_subprocess_exec(
            self._mosquitto, "-c", str(config),
            stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.DEVNULL,
        )  # fmt: skip
        async with asyncio.timeout(DEADLINE):
            while not await _listens(self.port):  # noqa: ASYNC110
                await asyncio.sleep(0.02)


class Consumer:
    """Reads the events of the alarm from the broker, once each by their message_id."""

    def __init__(self):
        self.events = {}
        """message_id -> fields, in the order of arrival."""
        self.received = 0

    async def run(self, port):
        """Read for ever, over whatever happens to the broker."""
        while True:
            with contextlib.suppress(MqttError):
                async with Client(
                    "127.0.0.1", port, identifier="consumer", clean_session=False, timeout=5.0
                ) as client:
                    await client.subscribe("slipjump/FIC101/alarm/event", qos=1)
                    async for message in client.messages:
                        fields = json.loads(bytes(message.payload))
                        self.received += 1
                        self.events.setdefault(fields["message_id"], fields)
            await asyncio.sleep(0.05)


class Beat:
    """A bus in memory that works all the time: what happens to the other one must not hold it up."""

    name = "beat"
    takes_orders = False

    @asynccontextmanager
    async def session(self):
        yield self

    async def samples(self):
        while True:
            at = time.time()
            for role, value in truth(at).items():
                yield Sample(LoopRole("FIC900", role), at, value)
            await asyncio.sleep(TS)

    async def publish(self, _):
        pass


class Rig:
    """All of it, running; made by ``rig``."""

    def __init__(self, bus, peer, proxy, state, connection, *, source_time):
        self.bus, self.peer, self.proxy = bus, peer, proxy
        self.windows = []
        self.verdicts = []
        self.escaped = []
        self.consumer = Consumer()
        self.agent = self._agent(state, connection, source_time=source_time)

    def _agent(self, state, connection, *, source_time):
        server = SERVERS[self.bus](LOOPS, port=self.proxy.port)
        entry = {**server.loop_settings("FIC101", TS), **WINDOW, "quantify": "always"}
        if not source_time:
            entry["tags"].pop("time", None)
            for tag in entry["tags"].values():
                tag.pop("time_field", None)
            connection = connection | ({"poll": TS} if self.bus == "modbus" else {})
        given = {key: value for key, value in connection.items() if key != "agent"}
        entries = {
            "agent": connection.get("agent", {}),
            "connections": {self.bus: server.connection_settings() | given},
            "loops": [entry],
        }
        settings = settings_of(entries)
        connectors = [*connectors_of(settings), Beat()]
        window = WindowSettings(**WINDOW["window"])
        beat = loop_settings(
            "FIC900", ts=TS, connection="beat", window=window, quantify="always", alarm=AlarmSettings()
        )
        settings = replace(
            settings,
            agent=settings.agent.model_copy(update={"state": state}),
            connections={**settings.connections, "beat": ConnectionSettings("beat", Options())},
            loops=(*settings.loops, beat),
        )
        return Agent(
            settings,
            InlineExecutor(),
            connectors=connectors,
            diagnose=self._diagnose,
            clock=lambda: time.time(),  # noqa: PLW0108 - it may be patched
        )

    def _diagnose(self, window, _seen=None):
        verdict = "stiction" if int(window.time[-1] / SWITCH) % 2 else "no_stiction"
        if window.loop == "FIC101":
            self.windows.append(window)
            self.verdicts.append(verdict)
        return diagnosis(verdict)

    @property
    def expected(self):
        """Whether the alarm was active after each of its events: the truth changed from window to window."""
        told = ["no_stiction", *self.verdicts]
        return [now == "stiction" for before, now in itertools.pairwise(told) if now != before]

    @property
    def beats(self):
        """Samples of the loop that has nothing to do with the fault."""
        return next(status.samples for status in self.agent.status() if status.loop == "FIC900")

    async def flows(self, since, within=DEADLINE):
        """Wait for a window with data measured after ``since`` (s UTC of the plant's clock)."""
        seen = len(self.windows)

        def there():
            return any(
                np.isfinite(w.pv[-1]) and _lag(w.pv[-1], since) > TURN / 2 for w in self.windows[seen:]
            )

        await until(there, within)

    def wrong(self, start=0):
        """What the plant did not say and windows from the ``start``-th on hold: which, where, time, value."""
        longest = 10 * TS + 0.5
        return [
            (k, i, float(at), float(pv))
            for k, window in enumerate(self.windows[start:], start)
            for i, (at, pv) in enumerate(zip(window.time, window.pv, strict=True))
            if np.isfinite(pv) and longest < _lag(pv, at) < TURN - 1.6 * TS
        ]


def _lag(pv, at):
    """How old a value is at a time, s, modulo TURN: a value from later than ``at`` is near TURN."""
    return float(at - pv) % TURN


@asynccontextmanager
async def rig(bus, mosquitto, folder, *, source_time=True, **connection):
    """Start everything and wait until data flow; at the end no task and no exception may be left over."""
    loop, peer = asyncio.get_running_loop(), Peer(bus, mosquitto, folder)
    async with contextlib.AsyncExitStack() as stack:
        stack.push_async_callback(peer.stop)
        await peer.start()
        proxy = await stack.enter_async_context(FaultProxy(peer.port))
        made = Rig(bus, peer, proxy, folder / "state.sqlite", connection, source_time=source_time)
        loop.set_exception_handler(lambda _, context: made.escaped.append(context))
        work = [asyncio.create_task(made.agent.run(), name="agent")]
        if bus == "mqtt":
            work.append(asyncio.create_task(made.consumer.run(peer.port), name="consumer"))

        async def end():
            for task in work:
                task.cancel()
            await asyncio.wait(work)

        stack.push_async_callback(end)
        await made.flows(time.time())
        yield made
        assert not work[0].done()


async def _listens(port):
    try:
        _, writer = await asyncio.open_connection("127.0.0.1", port)
    except OSError:
        return False
    writer.close()
    with contextlib.suppress(OSError):
        await writer.wait_closed()
    return True

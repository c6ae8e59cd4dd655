"""Servers of the buses with loops whose rows are given, and brokers."""

import asyncio
import contextlib
import math
import socket

from connectors.base import LoopRole, Quality
from connectors.checks import Reader
from connectors.checks.session import until
from connectors.kinds import KINDS, LoopTags
from simulators.clock import Clock
from simulators.plant import Row
from simulators.player import play
from simulators.servers.broker import embedded_broker
from simulators.servers.modbus import ModbusServer
from simulators.servers.mqtt import MqttServer
from simulators.servers.opcua import OpcUaServer
from tests.ports import free_port

START = 1_700_000_000.0


class ListSource:
    """A loop whose rows are given."""

    ts = 1.0

    def __init__(self, loop, rows):
        self.loop = loop
        self._rows = rows

    def rows(self):
        return iter(self._rows)


def wave(loop, n, roles=("pv", "op", "sp", "mode"), gap=7):
    """Rows of which every ``gap``-th has no PV; SP and mode stand still, as they mostly do."""
    rows = []
    for i in range(n):
        values = {
            "pv": math.nan if i % gap == gap - 1 else float(i),
            "op": 50.0 + i / 8,
            "sp": 40.0,
            "mode": "AUTO",
        }
        rows.append(Row(START + i, {role: values[role] for role in roles}))
    return ListSource(loop, rows)


@contextlib.asynccontextmanager
async def mosquitto_broker(path, folder, more=("allow_anonymous true",)):
    """Run mosquitto and yield its port and process; ``more`` are lines of its configuration."""
    port = free_port()
    config = folder / "mosquitto.conf"
    config.write_text("\n".join([f"listener {port} 127.0.0.1", *more, ""]))
    process = await asyncio.create_subprocess_exec(
        path, "-c", str(config), stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.DEVNULL
    )
    try:
        await until(lambda: listens(port))
        yield port, process
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
        await process.wait()


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


@contextlib.asynccontextmanager
async def serving(bus, loops):
    """Serve ``loops`` (name -> roles) on a bus."""
    if bus == "mqtt":
        async with embedded_broker() as port, MqttServer(loops, port=port) as server:
            yield server
    else:
        async with {"modbus": ModbusServer, "opcua": OpcUaServer}[bus](loops) as server:
            yield server


def connector_of(connection, entries):
    """Make the connector that slipjump would make of these entries of its configuration file."""
    (kind,) = [kind for kind in KINDS if kind.kind == connection["kind"]]
    options = kind.options.model_validate({key: connection[key] for key in connection if key != "kind"})
    loops = {
        entry["name"]: LoopTags(
            {role: kind.tag.model_validate(tag) for role, tag in entry["tags"].items()},
            [kind.target.model_validate(target) for target in entry["publish"]],
        )
        for entry in entries
    }
    return kind.open("plant", options, loops)


def connector_to(server, loops, **options):
    entries = [server.loop_settings(loop, 1.0) for loop in loops]
    return connector_of({**server.connection_settings(), **options}, entries)


async def played(server, connector, sources):
    """Play all sources flat out to a session of the connector; return what it read."""
    async with connector.session() as session, Reader(session) as reading:
        await play(sources, server, Clock(None), reading.seen)
        total = sum(len(list(source.rows())) * len(next(source.rows()).values) for source in sources)
        await until(lambda: len(reading.samples) >= total)
        return reading


def assert_same(reading, source, *, single=False):
    """Every value of every row, at its time, with its quality; ``single``: to the precision of float32."""
    for role in next(source.rows()).values:
        samples = reading.of(LoopRole(source.loop, role))
        assert len(samples) == len(list(source.rows())), role
        for sample, row in zip(samples, source.rows(), strict=True):
            assert abs(sample.time - row.time) < 1e-5
            value = row.values[role]
            if role == "mode":
                assert sample.value in (value, 1.0)
                assert sample.quality is Quality.GOOD
            elif math.isnan(value):
                assert sample.quality is Quality.BAD
                assert math.isnan(sample.value)
            else:
                assert sample.quality is Quality.GOOD
                assert abs(sample.value - value) <= (1e-6 * abs(value) if single else 0.0)
